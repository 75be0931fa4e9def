// Reynolds' equation pad by pad: chooses the solver of each pad and adds the pads up.
#include <algorithm>
#include <limits>
#include <numbers>
#include <string>

#include "film/sheet/content_pad.hpp"
#include "film/sheet/hole.hpp"
#include "film/sheet/pad.hpp"
#include "film/sheet/refine.hpp"
#include "film/sheet/report.hpp"
#include "film/sheet/turning_frame.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/film/sheet/thickness.hpp"

namespace whirl::film {
namespace {

void demand(bool condition, const char* what) {
  if (!condition) throw core::InputError(std::string("film: ") + what);
}

// Its columns would have no end, and the films that settle along a cycle are bands.
constexpr const char* kRing =
    "in a whole circle fed by holes alone a film cannot have dynamic states: add a groove or an inlet";
// Drag alone fills no more than what lies behind a hole, and nothing unless the gap narrows there.
constexpr const char* kDry =
    "in a whole circle fed by holes alone a film that conserves its mass needs one under pressure: add 'pressure' to a "
    "hole, a groove or an inlet";

bool fed_by_holes_alone(const Reynolds& o, const Geometry& g) {
  return o.cavitation == Reynolds::Cavitation::mass_conserving && !o.holes.empty() &&
         g.type == Geometry::Bore::cylindrical && o.grooves.empty() && o.inlet.type == Inlet::Type::free;
}
bool is_ring(const Reynolds& o, const Geometry& g) {
  return o.states == Reynolds::States::dynamic && fed_by_holes_alone(o, g);
}
// A machine begins where the journal is centred, and there it is. A branch in the pressure ends where it runs dry.
bool is_dry(const Reynolds& o, const Geometry& g) {
  return fed_by_holes_alone(o, g) &&
         std::all_of(o.holes.begin(), o.holes.end(), [](const Hole& h) { return h.pressure == 0.0; });
}

void check_pads(const Geometry& g, const Reynolds& o, const Lubricant& l) {
  demand(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  const double limit = (g.type == Geometry::Bore::lemon_bore ? 1.0 : 2.0) * std::numbers::pi;
  const bool closed = g.type == Geometry::Bore::cylindrical;
  demand(closed || (g.arc > 0.0 && g.arc <= limit), "the arc must be positive and its pads must not overlap");
  demand(closed || o.grooves.empty(), "only a cylindrical bore has grooves");
  demand(o.inlet.type == Inlet::Type::free || (closed && o.grooves.empty()),
         "only a cylindrical bore without grooves has an inlet");
  demand(o.cavitation != Reynolds::Cavitation::mass_conserving || !closed || !o.grooves.empty() || !o.holes.empty() ||
             o.inlet.type != Inlet::Type::free,
         "a film that conserves its mass must be fed: a cylindrical bore needs 'grooves', 'holes' or an 'inlet'");
  demand(o.edge_fill == 1.0 || !closed || o.inlet.type != Inlet::Type::free,
         "'edge_fill' is of the edges of pads and inlets: a groove is full");
  demand(g.preload < 1.0, "the preload must be below 1");
  demand(g.type == Geometry::Bore::lemon_bore || g.offset == 0.0, "only a lemon bore has an offset");
  demand(o.cells[0] >= 3 && o.cells[1] >= 2, "at least 3 x 2 cells per pad");
  demand(l.viscosity > 0.0, "the viscosity must be positive");
  demand(l.density >= 0.0 && (l.density > 0.0 || o.turbulence == Turbulence::laminar),
         "a turbulent film needs a positive density");
  if (const auto hole = misplaced_hole(o, g))
    throw core::InputError("film: hole " + std::to_string(hole->hole + 1) + ": " + hole->reason);
  demand(!is_ring(o, g), kRing);
  demand(o.holes.empty() || o.inlet.type != Inlet::Type::maximum_gap,
         "holes do not turn with an inlet at the maximum gap");
}

class ReynoldsFilm final : public Film {
public:
  ReynoldsFilm(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant)
      : geometry_(geometry), options_(options), lubricant_(lubricant), pads_(make_pads(geometry, options.inlet)) {
    const bool modal = !options.tilt && options.holes.empty() &&
                       (options.cavitation == Reynolds::Cavitation::half_sommerfeld ||
                        options.cavitation == Reynolds::Cavitation::none);
    for (const Pad& pad : pads_) {
      solvers_.push_back(modal && !pad.closed ? make_modal_pad(pad, options, lubricant)
                                              : make_banded_pad(pad, options, lubricant));
    }
  }

  [[nodiscard]] std::span<const Port> ports() const override {
    return std::span(all_ports).first(options_.tilt ? 4 : 2);
  }
  void evaluate(const JournalMotion& motion, const Share& /*share*/, std::span<const double> /*states*/,
                std::span<const double> /*rates*/, Need need, StateResponse& all) override {
    Response& response = all.without_states();
    response.min_thickness = std::numeric_limits<double>::infinity();
    if (turns()) {
      const TurningFrame frame(motion, pads_.front().clearance);
      solvers_.front()->add(frame.motion(), need, response);
      return frame.turn_back(need, response);
    }
    for (auto& solver : solvers_) solver->add(motion, need, response);
  }

  void start_from(const Film& other) override {
    const auto* film = dynamic_cast<const ReynoldsFilm*>(&other);
    for (std::size_t k = 0; film && k < std::min(solvers_.size(), film->solvers_.size()); ++k)
      solvers_[k]->start_from(*film->solvers_[k]);
  }

  FilmReport summary(const JournalMotion& motion, std::span<const double> /*states*/) override {
    return summarise(pads_, options_, lubricant_, seen(motion), reports(motion));
  }
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> /*states*/) override {
    const double turn = turns() ? TurningFrame(motion, pads_.front().clearance).angle() : 0.0;
    return fields_of(pads_, options_, seen(motion), turn, reports(motion));
  }

  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) override {
    std::array<double, 4> position = motion.position;
    if (!options_.tilt) position[2] = position[3] = 0.0;
    return minimum_thickness(geometry_, position);
  }

private:
  [[nodiscard]] bool turns() const { return options_.inlet.type == Inlet::Type::maximum_gap; }
  // The motion seen by the pads.
  [[nodiscard]] JournalMotion seen(const JournalMotion& motion) const {
    return turns() ? TurningFrame(motion, pads_.front().clearance).motion() : motion;
  }
  std::vector<PadReport> reports(const JournalMotion& given) {
    const JournalMotion motion = seen(given);
    std::vector<PadReport> out;
    for (auto& solver : solvers_)
      out.push_back({solver->pressure(motion), solver->fill(motion), solver->flows(motion)});
    return out;
  }

  Geometry geometry_;
  Reynolds options_;
  Lubricant lubricant_;
  std::vector<Pad> pads_;
  std::vector<std::unique_ptr<PadSolver>> solvers_;
};

// A film with states of its own.
bool dynamic(const Reynolds& o) {
  return o.cavitation == Reynolds::Cavitation::mass_conserving && o.states == Reynolds::States::dynamic;
}

}  // namespace

std::span<const deck::Name<Reynolds::Cavitation>> names(Reynolds::Cavitation) {
  static constexpr deck::Name<Reynolds::Cavitation> table[] = {
      {Reynolds::Cavitation::half_sommerfeld, "half_sommerfeld", "negative pressure is cut off after the solution"},
      {Reynolds::Cavitation::reynolds, "reynolds", "complementarity: pressure and its slope vanish at the rupture"},
      {Reynolds::Cavitation::mass_conserving, "mass_conserving",
       "Jakobsson, Floberg and Olsson: pressure where the gap is full, oil carried along where it is not; it enters at "
       "edges of pads, grooves, holes and inlets. Loads, stiffness and flows are exact; damping is that of a cavity "
       "that neither fills nor empties, unless 'states' are dynamic"},
      {Reynolds::Cavitation::none, "none", "negative pressure stays"}};
  return table;
}

void describe(deck::Description<Reynolds>& d) {
  d.add("cavitation", &Reynolds::cavitation,
        "what happens where the pressure would be negative; reynolds unless given. half_sommerfeld is the cheapest, "
        "but lacks "
        "part of the stiffness and of the cross damping, and can put a threshold at half its speed",
        "Lund and Thomsen 1978");
  d.add("edge_fill", &Reynolds::edge_fill, "1", deck::Check{.min = 0, .max = 1, .min_open = true},
        "part of the gap that is full of oil where it enters a pad, of mass_conserving films")
      .continuable();
  d.add("states", &Reynolds::states, "own states of a mass_conserving film; condensed, the cheapest, unless given");
  d.add(
       "bulk_modulus", &Reynolds::bulk_modulus, "Pa", deck::positive,
       "of the oil where the gap is full, of a film with dynamic states: it stores h (1 + p/bulk_modulus). Mineral oil "
       "without air, 1.5 GPa, unless given; equilibria do not depend on it")
      .continuable();
  d.add("turbulence", &Reynolds::turbulence,
        "flow coefficients of the film; laminar unless given, however large the Reynolds number", "004 errata 15");
  d.add("inlet", &Reynolds::inlet, "where the film of a cylindrical bore without grooves starts",
        "Raimondi and Boyd 1958");
  d.add("cells", &Reynolds::cells, deck::in(4, 2000), "intervals around and along each pad");
  d.add("tilt", &Reynolds::tilt, "follow the slope of the journal, and turn it by moments");
  d.add("grooves", &Reynolds::grooves,
        "axial grooves of a cylindrical bore, at pressure zero unless the film conserves its mass");
  d.add(
      "holes", &Reynolds::holes,
      "round supply holes, at pressure zero unless the film conserves its mass; the film is then solved over the whole "
      "length");
  d.check([](const Reynolds& o, const deck::Report& r) {
    if (o.inlet.type != Inlet::Type::free && !o.grooves.empty())
      r.fail("inlet", "a film starts at its 'grooves' or at an 'inlet', not at both");
    const bool conserves = o.cavitation == Reynolds::Cavitation::mass_conserving;
    if (!conserves && o.edge_fill != 1)
      r.fail("edge_fill", "only a film with cavitation mass_conserving knows how full the gap is");
    const bool has_states = o.states == Reynolds::States::dynamic;
    if (!conserves && has_states) r.fail("states", "only a film with cavitation mass_conserving has states of its own");
    if (has_states && o.inlet.type == Inlet::Type::maximum_gap)
      r.fail("inlet",
             "an inlet at the maximum gap turns with the journal: a film with dynamic states cannot follow it");
    if (!has_states && o.bulk_modulus != Reynolds{}.bulk_modulus)
      r.fail("bulk_modulus", "only a film with dynamic states is compressible");
    for (const Groove& g : o.grooves)
      if (!conserves && g.pressure != 0)
        r.fail("grooves", "only grooves of films with cavitation mass_conserving have a pressure");
    for (std::size_t k = 0; k < o.holes.size(); ++k)
      if (!conserves && o.holes[k].pressure != 0)
        r.fail("holes." + std::to_string(k + 1) + ".pressure",
               "only holes of films with cavitation mass_conserving have a pressure");
    if (!o.holes.empty() && o.inlet.type == Inlet::Type::maximum_gap)
      r.fail("inlet", "an inlet at the maximum gap turns with the journal: 'holes' do not");
  });
}

void refine(Reynolds& options, const std::array<double, 2>& factor) {
  for (std::size_t d = 0; d < 2; ++d) options.cells[d] = refined(options.cells[d], factor[d], false);
}

Facts facts_of(const Reynolds& o, const Geometry& geometry) {
  Facts f;
  f.tilts = o.tilt;
  f.cells = o.cells;
  if (!o.grooves.empty())
    f.circle_only = {"grooves", "only a cylindrical bore has grooves"};
  else if (o.inlet.type != Inlet::Type::free)
    f.circle_only = {"inlet", "only a cylindrical bore has an inlet"};
  if (o.cavitation == Reynolds::Cavitation::mass_conserving)
    f.smoothness = {0, "the force has kinks where the edge of the full film passes a node"};
  else if (o.cavitation != Reynolds::Cavitation::none)
    f.smoothness = {1, "the tangents have kinks where the edge of the positive pressure passes a node"};
  f.own_states = dynamic(o);
  f.pads = geometry.type == Geometry::Bore::lemon_bore ? 2 : 1;
  if (f.own_states) f.states = f.pads * o.cells[0] * (o.tilt || !o.holes.empty() ? o.cells[1] : o.cells[1] / 2);
  if (o.holes.empty() || geometry.radius <= 0.0) return f;
  if (const auto hole = misplaced_hole(o, geometry))
    f.misplaced = {"holes." + std::to_string(hole->hole + 1), hole->reason};
  else if (is_ring(o, geometry))
    f.misplaced = {"holes", kRing};
  else if (is_dry(o, geometry))
    f.misplaced = {"holes", kDry};
  return f;
}

std::unique_ptr<Film> make(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant) {
  check_pads(geometry, options, lubricant);
  if (dynamic(options)) return make_content(geometry, options, lubricant);
  return std::make_unique<ReynoldsFilm>(geometry, options, lubricant);
}

}  // namespace whirl::film
