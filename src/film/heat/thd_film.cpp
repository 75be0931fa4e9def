// A film with heat on all pads of a bore, and what its deck says.
#include <algorithm>
#include <limits>
#include <numbers>
#include <string>

#include "film/heat/one_layer_pad.hpp"
#include "film/heat/thd_pad.hpp"
#include "film/sheet/refine.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/film/sheet/thickness.hpp"
#include "whirl/thermal/describe.hpp"

namespace whirl::film {
namespace {

void check_that(bool condition, const char* what) {
  if (!condition) throw core::InputError(std::string("film: ") + what);
}

void check(const Geometry& g, const Thd& o, const Lubricant& l) {
  check_that(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  check_that(g.type != Geometry::Bore::cylindrical, "a film with heat stands on pads: a partial arc or a lemon bore");
  const double limit = (g.type == Geometry::Bore::lemon_bore ? 1.0 : 2.0) * std::numbers::pi;
  check_that(g.arc > 0.0 && g.arc <= limit, "the arc must be positive and its pads must not overlap");
  check_that(g.preload < 1.0, "the preload must be below 1");
  check_that(g.type == Geometry::Bore::lemon_bore || g.offset == 0.0, "only a lemon bore has an offset");
  check_that(o.cells[0] >= 4 && o.cells[1] >= 2, "at least 4 x 2 cells per pad");
  check_that(o.layers >= 1, "at least one layer");
  check_that(l.viscosity > 0.0 && l.density > 0.0, "viscosity and density must be positive");
  check_that(o.heat_capacity > 0.0 && o.conductivity >= 0.0, "heat capacity and conductivity must be positive");
}

template <class HeatedPad>
class ThdFilm final : public Film {
public:
  ThdFilm(const Geometry& geometry, const Thd& options, const Lubricant& lubricant)
      : geometry_(geometry), options_(options), lubricant_(lubricant) {
    for (const Pad& pad : make_pads(geometry)) {
      first_.push_back(states_);
      pads_.push_back(std::make_unique<HeatedPad>(pad, options, lubricant));
      states_ += static_cast<std::size_t>(pads_.back()->states());
    }
  }

  [[nodiscard]] std::span<const Port> ports() const override {
    return std::span(all_ports).first(options_.tilt ? 4 : 2);
  }
  [[nodiscard]] std::size_t states() const override { return states_; }
  // Pressures are algebraic: their rows are the growth of the gap, in m/s.
  [[nodiscard]] std::vector<StateField> state_fields() const override {
    constexpr double warm = 10.0;  // K
    const int block = pads_.front()->block(), nodes = static_cast<int>(states_) / block;
    const double slender = geometry_.radius / geometry_.clearance;
    const double pressure = lubricant_.viscosity * typical_frequency * slender * slender;
    return {{"pressure", "Pa", pressure, 0, 1, geometry_.clearance * typical_frequency, block, nodes},
            {"temperature", "K", warm, 1, block, 0, block, nodes}};
  }
  [[nodiscard]] int cut(int near) const override {
    return 2 * static_cast<std::size_t>(near) > states_ ? static_cast<int>(states_) : 0;
  }
  [[nodiscard]] Share share(int begin, int end) const override {
    Share out{begin, end, {}, {}, {}};
    if (begin == end) return out;
    core::require(begin == 0 && end == static_cast<int>(states_), "a film with heat is held by one rank");
    for (int k = 0; k < end; ++k) out.seen.push_back(k);
    for (std::size_t n = 0; n < pads_.size(); ++n)
      pads_[n]->add_places(static_cast<int>(first_[n]), out.d_states, out.d_rates);
    return out;
  }
  void unloaded(const JournalMotion& /*motion*/, std::span<double> states) const override {
    const auto block = static_cast<std::size_t>(pads_.front()->block());
    for (std::size_t k = 0; k < states.size(); ++k) states[k] = k % block == 0 ? 0.0 : options_.feed;
  }

  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override {
    core::require(states.size() == share.seen.size() && rates.size() == states.size(), "what a share of a film sees");
    const bool tangents = need == Need::tangents;
    const auto rows = static_cast<std::size_t>(share.rows());
    response.journal = {};
    response.journal.min_thickness = std::numeric_limits<double>::infinity();
    response.residual.resize(rows);
    response.d_states.resize(tangents ? share.d_states.size() : 0);
    response.d_rates.resize(tangents ? share.d_rates.size() : 0);
    response.d_speed.resize(tangents ? rows : 0);
    response.resize(tangents, std::ssize(ports()), share.rows());
    response.forces.setZero();  // pads write all of the others, and add to these
    if (rows == 0) return;
    std::size_t at = 0, at_rates = 0;
    for (std::size_t n = 0; n < pads_.size(); ++n)
      pads_[n]->evaluate(motion, of(n, states), of(n, rates), need, first_[n], at, at_rates, response);
  }

  void resample(const JournalMotion& /*motion*/, const Film& other, std::span<const double> from,
                std::span<double> to) const override {
    const auto* mesh = dynamic_cast<const ThdFilm*>(&other);
    core::require(mesh != nullptr && from.size() == mesh->states_ && mesh->pads_.size() == pads_.size(),
                  "states of another film with heat");
    for (std::size_t n = 0; n < pads_.size(); ++n)
      pads_[n]->resample(*mesh->pads_[n], mesh->of(n, from),
                         to.subspan(first_[n], static_cast<std::size_t>(pads_[n]->states())));
  }

  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) override {
    std::array<double, 4> position = motion.position;
    if (!options_.tilt) position[2] = position[3] = 0.0;
    return minimum_thickness(geometry_, position);
  }

  [[nodiscard]] bool thickness_of_states() const override { return false; }

  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override {
    at(motion, states);
    FilmReport out;
    out.min_thickness = least_thickness(motion, states);
    out.inlet_flow = out.outlet_flow = 0.0;
    double volume = 0.0, warmth = 0.0;
    out.imbalance = 0.0;
    out.max_temperature = 0.0;
    for (const auto& pad : pads_) {
      for (const double p : pad->nodal(Nodal::pressure)) out.max_pressure = std::max(out.max_pressure, p);
      const Flows flows = pad->flows();
      out.inlet_flow += flows.enters;
      out.outlet_flow += flows.leaves;
      out.side_flow += pad->side_outflow();
      out.imbalance += flows.enters - flows.leaves - flows.sides - flows.squeezed;
      out.power_loss += pad->friction() * motion.speed;
      const Warmth warm = pad->warmth();
      volume += warm.volume;
      warmth += warm.integral;
      out.max_temperature = std::max(out.max_temperature, warm.highest);
    }
    out.mean_temperature = warmth / volume;
    return out;
  }

  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override {
    at(motion, states);
    std::vector<NodalField> all;
    for (std::size_t n = 0; n < pads_.size(); ++n) {
      const HeatedPad& pad = *pads_[n];
      const Grid& grid = pad.grid();
      const Pad arc = make_pads(geometry_)[n];
      const auto rows = static_cast<std::size_t>(grid.n_theta + 1), columns = static_cast<std::size_t>(grid.n_z + 1);
      const int index = static_cast<int>(n);
      NodalField theta{index, "theta", "rad", {rows}, {}}, z{index, "z", "m", {columns}, {}};
      NodalField h{index, "thickness", "m", {rows, columns}, {}};
      for (int i = 0; i <= grid.n_theta; ++i) {
        theta.values.push_back(arc.start + i * grid.dtheta);
        for (int j = 0; j <= grid.n_z; ++j) h.values.push_back(pad.thickness(i, j));
      }
      for (int j = 0; j <= grid.n_z; ++j) z.values.push_back(j * grid.dz - 0.5 * arc.length);
      all.insert(all.end(), {std::move(theta), std::move(z)});
      all.push_back({index, "pressure", "Pa", {rows, columns}, pad.nodal(Nodal::pressure)});
      all.push_back(std::move(h));
      all.push_back({index, "temperature", "K", {rows, columns}, pad.nodal(Nodal::mean)});
      if (options_.layers == 1) continue;
      all.push_back({index, "temperature_bush", "K", {rows, columns}, pad.nodal(Nodal::bush)});
      all.push_back({index, "temperature_journal", "K", {rows, columns}, pad.nodal(Nodal::journal)});
    }
    return all;
  }

private:
  [[nodiscard]] std::span<const double> of(std::size_t pad, std::span<const double> all) const {
    return all.subspan(first_[pad], static_cast<std::size_t>(pads_[pad]->states()));
  }
  // At rest in its states: what reports are of.
  void at(const JournalMotion& motion, std::span<const double> states) {
    const std::vector<double> rates(states.size(), 0.0);
    std::size_t at = 0, at_rates = 0;
    report_.residual.resize(states.size());
    for (std::size_t n = 0; n < pads_.size(); ++n)
      static_cast<typename HeatedPad::Base&>(*pads_[n]).evaluate(motion, of(n, states), of(n, rates), Need::force,
                                                                 first_[n], at, at_rates, report_);
  }

  Geometry geometry_;
  Thd options_;
  Lubricant lubricant_;
  std::vector<std::unique_ptr<HeatedPad>> pads_;
  std::vector<std::size_t> first_;  // state of each pad
  std::size_t states_ = 0;
  StateResponse report_;
};

}  // namespace

std::span<const deck::Name<HeatedWall::Type>> names(HeatedWall::Type) {
  static constexpr deck::Name<HeatedWall::Type> table[] = {
      {HeatedWall::Type::isothermal, "isothermal", "of given temperature"},
      {HeatedWall::Type::adiabatic, "adiabatic", "takes no heat"}};
  return table;
}

std::span<const deck::Name<Thd::Cavitation>> names(Thd::Cavitation) {
  static constexpr deck::Name<Thd::Cavitation> table[] = {
      {Thd::Cavitation::half_sommerfeld, "half_sommerfeld",
       "negative pressure does not act on the journal; the flow keeps it"},
      {Thd::Cavitation::none, "none", "negative pressure acts on the journal too"}};
  return table;
}

void describe(deck::Description<HeatedWall>& d) {
  d.add("type", &HeatedWall::type, "what the wall does with heat");
  d.add("temperature", &HeatedWall::temperature, "K", deck::positive, "temperature of the wall")
      .continuable()
      .only(&HeatedWall::type, {HeatedWall::Type::isothermal});
}

void describe(deck::Description<Thd>& d) {
  d.add("cavitation", &Thd::cavitation, "what happens where the pressure would be negative");
  d.add("states", &Thd::states,
        "condensed: at every moment the temperatures are those of the journal's motion at that moment; dynamic: they "
        "follow it in time");
  d.add("turbulence", &Thd::turbulence,
        "flow coefficients of the film; laminar unless given. Heat passes to the walls as in laminar flow",
        "004 errata 15");
  d.add("cells", &Thd::cells, deck::in(4, 2000), "intervals around and along each pad");
  d.add("layers", &Thd::layers, deck::in(1, 64),
        "layers of the energy equation across the film; 1: the mean temperature, with a parabola across the film");
  d.add("tilt", &Thd::tilt, "follow the slope of the journal, and turn it by moments");
  d.add("feed_temperature", &Thd::feed, "K", deck::positive, "temperature of the oil that enters a pad").continuable();
  // All numbers of a law: here, because the law of the study of one bearing is none of a branch.
  d.add("viscosity", &Thd::viscosity,
        "dynamic viscosity over the temperature; constant, that of the lubricant, if not given")
      .continuable();
  d.add("heat_capacity", &Thd::heat_capacity, "J/(kg K)", deck::positive, "specific heat of the oil").continuable();
  d.add("conductivity", &Thd::conductivity, "W/(m K)", deck::non_negative, "conductivity of the oil").continuable();
  d.add("bush", &Thd::bush, "the wall at the bush");
  d.add("journal", &Thd::journal, "the wall at the journal");
}

void refine(Thd& options, const std::array<double, 2>& factor) {
  for (std::size_t d = 0; d < 2; ++d) options.cells[d] = refined(options.cells[d], factor[d], false);
}

Facts facts_of(const Thd& o, const Geometry& geometry) {
  Facts f;
  f.tilts = o.tilt;
  f.cells = o.cells;
  f.mesh_order = 1;
  f.smoothness = {0, "the force has kinks where the flow between two volumes of the film changes its direction"};
  f.own_states = o.states == States::dynamic;
  f.pads = geometry.type == Geometry::Bore::lemon_bore ? 2 : 1;
  if (f.own_states)
    f.states = f.pads * (o.cells[0] + 1) * (o.tilt ? o.cells[1] + 1 : o.cells[1] / 2 + 1) * (1 + o.layers);
  if (geometry.type == Geometry::Bore::cylindrical && geometry.radius > 0.0)
    f.misplaced = {"type", "a film with heat stands on pads: a partial arc or a lemon bore"};
  return f;
}

std::unique_ptr<Film> make(const Geometry& geometry, const Thd& options, const Lubricant& lubricant) {
  check(geometry, options, lubricant);
  constexpr int few = 8, any = Eigen::Dynamic;
  std::unique_ptr<Film> film;
  if (options.layers == 1)
    film = std::make_unique<ThdFilm<OneLayerPad>>(geometry, options, lubricant);
  else if (options.layers <= few)
    film = std::make_unique<ThdFilm<ThdPad<any, few>>>(geometry, options, lubricant);
  else
    film = std::make_unique<ThdFilm<ThdPad<any, any>>>(geometry, options, lubricant);
  if (options.states == States::dynamic) return film;
  return condense(std::move(film));
}

}  // namespace whirl::film
