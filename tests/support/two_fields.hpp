#pragma once
// A film whose states differ in unit and size, and so do its rows.

#include <cmath>

#include "whirl/film/contract/film.hpp"

namespace whirl::test {

/// n temperatures T, then n thicknesses h, or slab by slab a T and an h: heat (T - 5 K (h/10 um)^2) 20 MW/K = 0 without
/// rates, and h' + 300/s (h - 10 um) = 0.
class TwoFields final : public film::Film {
public:
  explicit TwoFields(int n = 1, bool by_slabs = false) : n_(n), by_slabs_(by_slabs) {}
  static constexpr double thickness = 1e-5, conductance = 2e7;  // m, W/K
  using Film::evaluate;
  void evaluate(const film::JournalMotion& /*motion*/, const film::Share& share, std::span<const double> states,
                std::span<const double> rates, film::Need /*need*/, film::StateResponse& r) override {
    const auto n = static_cast<std::size_t>(n_);
    r.journal = {};
    r.residual.resize(share.seen.size());
    r.d_states.clear();
    r.d_states.resize(2 * n);
    for (int k = 0; k < n_; ++k) {
      const std::size_t t = temperature_at(k), g = thickness_at(k);
      const double h = states[g] / thickness;
      r.residual[t] = conductance * (states[t] - 5 * h * h);
      r.residual[g] = rates[g] + film::typical_frequency * (states[g] - thickness);
      r.d_states[t] = conductance;
      r.d_states[g] = film::typical_frequency;
    }
    for (int k = 0; k < n_; ++k)
      r.d_states.push_back(-conductance * 10 * states[thickness_at(k)] / thickness / thickness);
    r.d_rates.assign(n, 1);
  }
  film::FilmReport summary(const film::JournalMotion&, std::span<const double>) override { return {}; }
  std::vector<film::NodalField> fields(const film::JournalMotion&, std::span<const double>) override { return {}; }
  [[nodiscard]] double least_thickness(const film::JournalMotion&, std::span<const double> states) override {
    return states.back();
  }
  [[nodiscard]] std::size_t states() const override { return 2 * static_cast<std::size_t>(n_); }
  [[nodiscard]] std::vector<film::StateField> state_fields() const override {
    if (by_slabs_)
      return {{"temperature", "K", 50, 0, 1, 50 * conductance, 2, n_}, {"thickness", "m", thickness, 1, 2, 0, 2, n_}};
    return {{"temperature", "K", 50, 0, n_, 50 * conductance}, {"thickness", "m", thickness, n_, 2 * n_}};
  }
  [[nodiscard]] int cut(int near) const override { return by_slabs_ ? near - near % 2 : near; }
  [[nodiscard]] film::Share share(int begin, int end) const override {
    film::Share out{begin, end, {}, {}, {}};
    for (int k = begin; k < end; ++k) out.seen.push_back(k);
    if (begin > 0 || end < 2 * n_) return out;  // evaluated as a whole alone
    out.d_states.add({0, 0, 2 * n_});
    for (int k = 0; k < n_; ++k) {
      const auto t = static_cast<int>(temperature_at(k)), h = static_cast<int>(thickness_at(k));
      out.d_states.add({t, h, 1});
      out.d_rates.add({h, h, 1});
    }
    return out;
  }

private:
  [[nodiscard]] std::size_t temperature_at(int k) const { return static_cast<std::size_t>(by_slabs_ ? 2 * k : k); }
  [[nodiscard]] std::size_t thickness_at(int k) const {
    return static_cast<std::size_t>(by_slabs_ ? 2 * k + 1 : n_ + k);
  }
  int n_;
  bool by_slabs_;
};

}  // namespace whirl::test
