#pragma once
// What a pad with heat reports, and its states on another mesh; for thd_pad.cpp alone.
#include <algorithm>

#include "film/heat/thd_pad.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

template <int Count, int Most>
HeatBalance ThdPad<Count, Most>::heat() const {
  HeatBalance out;
  const double times = whole_ ? 1.0 : 2.0, rho_c = lubricant_.density * options_.heat_capacity;
  for (const Face& f : faces_) out.dissipation += times * f.step * f.width * f.d.sum();
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& here = nodes_[n];
    const Eigen::Map<const Vector> t(here.value + 1, layers_);
    for (int k = 0; here.edge && k < layers_; ++k) {
      const double flow = left_over(n, k);
      out.carried += times * rho_c * flow * ((flow < 0.0 ? options_.feed : t(k)) - options_.feed);
    }
    const double walls = times * here.area * options_.conductivity / here.h;
    const auto through = [&](const HeatedWall& w, const HeatedWall& other, int k) {
      if (w.type != HeatedWall::Type::isothermal) return 0.0;
      if (layers_ > 1) return walls * 2.0 * layers_ * (t(k) - w.temperature);
      if (other.type != HeatedWall::Type::isothermal) return walls * 3.0 * (t(0) - w.temperature);
      return walls * (6.0 * t(0) - 4.0 * w.temperature - 2.0 * other.temperature);
    };
    out.bush += through(options_.bush, options_.journal, 0);
    out.journal += through(options_.journal, options_.bush, layers_ - 1);
    out.stored += times * rho_c * here.area * here.rate / layers_ * (t.array() - options_.feed).sum();
  }
  return out;
}

template <int Count, int Most>
Flows ThdPad<Count, Most>::flows() const {
  Flows out;
  const double times = whole_ ? 1.0 : 2.0;
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j < rows_; ++j) {
      const std::size_t n = node(i, j);
      double flow = 0.0;
      for (int k = 0; k < layers_; ++k) flow += times * left_over(n, k);
      out.squeezed += times * nodes_[n].area * nodes_[n].rate;
      if (!nodes_[n].edge) continue;
      if (i == 0)
        out.enters -= flow;
      else if (i + 1 == columns_)
        out.leaves += flow;
      else
        out.sides += flow;
    }
  return out;
}

template <int Count, int Most>
double ThdPad<Count, Most>::side_outflow() const {
  double out = 0.0;
  for (int i = 1; i + 1 < columns_; ++i)
    for (int j = 0; j < rows_; ++j) {
      if (!nodes_[node(i, j)].edge) continue;
      double flow = 0.0;
      for (int k = 0; k < layers_; ++k) flow += left_over(node(i, j), k);
      out += (whole_ ? 1.0 : 2.0) * std::max(flow, 0.0);
    }
  return out;
}

template <int Count, int Most>
double ThdPad<Count, Most>::friction() const {
  double out = 0.0;
  Layers<Count, Most> profile(layers_);
  for (std::size_t k = 0; k < static_cast<std::size_t>(around_); ++k) {
    const Face& f = faces_[k];
    const Node &a = nodes_[static_cast<std::size_t>(f.from)], &b = nodes_[static_cast<std::size_t>(f.to)];
    profile.set(0.5 * (a.mu + b.mu), false);
    const double gradient = (b.value[0] - a.value[0]) * f.over_step, more = turbulent_ ? 1.0 + sheared_[k] : 1.0;
    const double stress = more * speed_ * pad_.radius / f.h * profile.pull + gradient * f.h * (1.0 - profile.neutral);
    out += (whole_ ? 1.0 : 2.0) * f.step * f.width * stress * pad_.radius;
  }
  return out;
}

template <int Count, int Most>
Warmth ThdPad<Count, Most>::warmth() const {
  Warmth out;
  for (const Node& n : nodes_) {
    const Eigen::Map<const Vector> t(n.value + 1, layers_);
    const double volume = (whole_ ? 1.0 : 2.0) * n.area * n.h;
    out.volume += volume;
    out.integral += volume * t.mean();
    out.highest = std::max(out.highest, t.maxCoeff());
  }
  return out;
}

template <int Count, int Most>
std::vector<double> ThdPad<Count, Most>::nodal(Nodal what) const {
  std::vector<double> out;
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j <= grid_.n_z; ++j) {
      const double* v = nodes_[node(i, j < rows_ ? j : grid_.n_z - j)].value;
      switch (what) {
        case Nodal::pressure:
          out.push_back(options_.cavitation == Thd::Cavitation::none ? v[0] : std::max(v[0], 0.0));
          break;
        case Nodal::mean:
          out.push_back(Eigen::Map<const Vector>(v + 1, layers_).mean());
          break;
        case Nodal::bush:
          out.push_back(v[1]);
          break;
        case Nodal::journal:
          out.push_back(v[layers_]);
          break;
      }
    }
  return out;
}

template <int Count, int Most>
void ThdPad<Count, Most>::resample(const ThdPad& other, std::span<const double> from, std::span<double> to) const {
  core::require(other.layers_ == layers_ && other.whole_ == whole_, "a film of the same layers");
  const auto place = [](double x, int cells, int last) {
    const int cell = std::clamp(static_cast<int>(x * cells), 0, last - 1);
    return std::pair{cell, std::min(x * cells - cell, 1.0)};
  };
  const auto b = static_cast<std::size_t>(block());
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j < rows_; ++j) {
      const auto [c, s] = place(static_cast<double>(i) / grid_.n_theta, other.grid_.n_theta, other.columns_ - 1);
      const auto [d, t] = place(static_cast<double>(j) / grid_.n_z, other.grid_.n_z, other.rows_ - 1);
      for (std::size_t v = 0; v < b; ++v) {
        const auto value = [&](int x, int y) { return from[other.node(x, y) * b + v]; };
        to[node(i, j) * b + v] = (1.0 - s) * ((1.0 - t) * value(c, d) + t * value(c, d + 1)) +
                                 s * ((1.0 - t) * value(c + 1, d) + t * value(c + 1, d + 1));
      }
    }
}

}  // namespace whirl::film
