// What orifices give to a film of gas, and how the film is cut with them.
#include <cmath>
#include <numbers>

#include "film/gas/gas_inverse.hpp"
#include "film/gas/gas_part.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using std::numbers::pi;

// Unknowns in their order: pressures at rims, in pockets, flows out of pockets.
void GasFilm::place_feeds() {
  const GasMesh mesh{lines_, inner_, dx_, dz_, dtheta_, bore_.start(), geometry_.length};
  for (const OrificeRow& r : options_.orifices)
    for (int k = 0; k < r.count; ++k) {
      GasFeed feed(r, k, options_, viscosity_, mesh);
      for (const GasFeed& other : feeds_)
        if (feed.crowds(other, mesh))
          throw core::InputError("film: two orifices lie in one cell: the mesh is too coarse");
      reads_ += feed.parts().size();
      feeds_.push_back(std::move(feed));
    }
  number_.resize(feeds_.size());
  for (std::size_t k = 0; k < feeds_.size(); ++k) number_[k][0] = unknowns_++;
  for (const GasFeed::Kind kind : {GasFeed::Kind::deep, GasFeed::Kind::shallow}) {
    if (kind == GasFeed::Kind::shallow) flows_ = unknowns_;
    for (std::size_t k = 0; k < feeds_.size(); ++k)
      if (feeds_[k].kind() == kind) number_[k][1] = unknowns_++;
  }
}

std::vector<StateField> GasFilm::state_fields() const {
  const int n = static_cast<int>(nodes_), rims = n + static_cast<int>(feeds_.size());
  const int pockets = n + static_cast<int>(flows_), all = static_cast<int>(states());
  std::vector<StateField> out{{"pressure", "Pa", options_.ambient, 0, n}};
  if (feeds_.empty()) return out;
  out.push_back({"orifice_pressure", "Pa", options_.ambient, n, rims, options_.ambient});
  if (pockets > rims) out.push_back({"pocket_pressure", "Pa", options_.ambient, rims, pockets});
  if (all > pockets)
    out.push_back({"pocket_flow", "kg/s", feeds_.front().scale(), pockets, all, options_.ambient * typical_frequency});
  return out;
}

// At whole lines; the rank that holds the last one holds the unknowns of the orifices too.
int GasFilm::cut(int near) const {
  const int line = (near + inner_ / 2) / inner_;
  return line < lines_ ? line * inner_ : static_cast<int>(states());
}

// Lines held and those beside them, then the unknowns of all orifices and the pressures that each of them reads. The
// entries between nodes are a Stencil, with the zeros at the ends of lines; those of orifices follow, in the order in
// which feed() fills them.
Share GasFilm::share(int begin, int end) const {
  Share out{begin, end, {}, {}, {}};
  if (begin == end) return out;
  const int nodes = static_cast<int>(nodes_), held = std::min(end, nodes), n = held - begin;
  core::require(begin % inner_ == 0 && (end == static_cast<int>(states()) || (end < nodes && end % inner_ == 0)),
                "a film that is cut at whole lines");
  for (int k = begin - inner_; k < held + inner_; ++k) out.seen.push_back((k % nodes + nodes) % nodes);
  const int first = n + 2 * inner_;
  for (int k = 0; k < static_cast<int>(unknowns_); ++k) out.seen.push_back(nodes + k);
  for (const GasFeed& f : feeds_)
    for (const GasFeed::Part& part : f.parts()) out.seen.push_back(part.node);
  for (const int offset : {0, -inner_, inner_, -1, 1}) out.d_states.add({0, inner_ + offset, n});
  out.d_rates.add({0, inner_, n});
  int read = first + static_cast<int>(unknowns_);
  for (std::size_t k = 0; k < feeds_.size(); ++k) {
    const GasFeed& f = feeds_[k];
    const std::array<int, 2> own = {static_cast<int>(unknown(k, 0)), static_cast<int>(unknown(k, 1))};
    for (const GasFeed::Part& part : f.parts())
      for (std::size_t u = 0; u < 2; ++u)
        if (f.uses()[u] && part.node >= begin && part.node < held) out.d_states.add(part.node - begin, first + own[u]);
    if (end != held) {
      for (int a = 0; a < static_cast<int>(f.parts().size()); ++a) out.d_states.add(n + own[0], read + a);
      for (int row = 0; row < f.unknowns(); ++row)
        for (int u = 0; u < f.unknowns(); ++u)
          out.d_states.add(n + own[static_cast<std::size_t>(row)], first + own[static_cast<std::size_t>(u)]);
      if (f.unknowns() > 1) out.d_rates.add(n + own[1], first + own[static_cast<std::size_t>(f.pocket_pressure())]);
    }
    read += static_cast<int>(f.parts().size());
  }
  return out;
}

std::unique_ptr<StateInverse> GasFilm::inverse(MPI_Comm comm, const Share& share) const {
  const Lines here = lines_of(share);
  int least = here.count();
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, comm);
  if (least < 2) return nullptr;
  std::vector<int> nodes;
  for (const GasFeed& f : feeds_)
    for (const GasFeed::Part& part : f.parts()) nodes.push_back(part.node);
  return std::make_unique<GasInverse>(comm, lines_, inner_, share, std::move(nodes), static_cast<int>(unknowns_));
}

double GasFilm::thickness(const JournalMotion& motion, const GasFeed& feed) const {
  const double c = std::cos(feed.angle()), s = std::sin(feed.angle());
  return bore_.gap(feed.angle()) - (motion.position[0] + feed.z() * motion.position[2]) * c -
         (motion.position[1] + feed.z() * motion.position[3]) * s;
}

// The flow into nodes, the rows between rims and nodes, and the balances of pockets.
void GasFilm::feed(const Part& part, const Share& share, std::span<const double> rates) const {
  const double warmth = options_.gas_constant * options_.temperature, to_cell = warmth / (dx_ * dz_);
  const std::size_t first = part.states.size() - unknowns_ - reads_;
  const bool owns = static_cast<std::size_t>(share.rows()) > part.rows;
  StateResponse& response = part.response;
  double* entry = part.tangents ? response.d_states.data() + 5 * part.rows : nullptr;
  std::size_t read = first + unknowns_;
  for (std::size_t k = 0; k < feeds_.size(); ++k) {
    const GasFeed& f = feeds_[k];
    const double* pressures = &part.states[read];
    read += f.parts().size();
    const Part::Levers w = Part::levers(std::cos(f.angle()), std::sin(f.angle()), f.z());
    const double h = bore_.gap(f.angle()) + part.turn(w);
    const std::array<double, 2> u = unknowns_of(k, &part.states[first]);
    const GasFlow m = f.into_film(u, h);
    for (const GasFeed::Part& a : f.parts()) {
      const int line = a.node / inner_;
      if (line < part.lines.begin || line >= part.lines.end) continue;
      const std::size_t node = row(part.lines, line, a.node % inner_);
      const double share_of_cell = to_cell * a.weight;
      response.residual[node] -= share_of_cell * m.mass;
      if (!part.tangents) continue;
      const bool free = !bore_.held(line);
      const Part::Levers at = Part::levers(std::cos(angle(line)), std::sin(angle(line)), z(a.node % inner_));
      part.add_position(node, -share_of_cell * m.by_thickness, w);
      for (std::size_t n = 0; n < 2; ++n)
        if (f.uses()[n]) *entry++ = free ? -share_of_cell * m.by[n] / (bore_.mean(line) + mean_ * part.turn(at)) : 0.0;
    }
    if (!owns) continue;
    // Without slip p^2, all over h^3.
    const double cube = h * h * h, over = 0.5 / (f.supply() * cube);
    const double resists = 12.0 * viscosity_ * warmth / pi * f.distance();
    double drop = resists * m.mass, by_h = resists * m.by_thickness;
    std::array<double, 2> by = {resists * m.by[0], resists * m.by[1]};
    for (std::size_t a = 0; a < f.parts().size(); ++a) {
      const GasDrive::Rise rise = drive_.rise(h, pressures[a], u[0]);
      const double weight = f.parts()[a].weight;
      drop += weight * rise.value;
      by_h += weight * rise.by_h;
      by[0] += weight * rise.by_high;
      if (part.tangents) *entry++ = over * weight * rise.by_low;
    }
    const std::size_t own = part.rows + unknown(k, 0);
    response.residual[own] = over * drop;
    if (part.tangents) {
      part.add_position(own, over * (by_h - 3.0 * drop / h), w);
      for (int n = 0; n < f.unknowns(); ++n) *entry++ = over * by[static_cast<std::size_t>(n)];
    }
    if (f.unknowns() < 2) continue;
    const std::size_t balance = part.rows + unknown(k, 1);
    const GasFlow gets = f.into_pocket(u, h);
    response.residual[balance] = rates[first + unknown(k, f.pocket_pressure())] - gets.mass / f.capacity();
    if (!part.tangents) continue;
    part.add_position(balance, -gets.by_thickness / f.capacity(), w);
    for (const double slope : gets.by) *entry++ = -slope / f.capacity();
  }
}

}  // namespace whirl::film
