#pragma once
// Short and long films of a full cylindrical bore with an elastic liner: the film thickness around the bearing is the
// state.

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "film/sheet/groove.hpp"
#include "film/wall/compliant.hpp"

namespace whirl::film {

// Arrays around the bearing hold the last two nodes again in front of node 0, and node 0 behind the last one.
inline constexpr std::size_t kFront = 2, kBehind = 1;

inline const double* around(const std::vector<double>& values) {
  return values.data() + kFront;
}
inline double* around(std::vector<double>& values) {
  return values.data() + kFront;
}
inline void close(std::vector<double>& values) {
  const std::size_t n = values.size() - kFront - kBehind;
  std::copy_n(values.data() + n, kFront, values.data());
  std::copy_n(values.data() + kFront, kBehind, values.data() + kFront + n);
}

// Nodes k = 0 .. N - 1 at theta = 90 deg + k d. With thickness h, eccentricity e in clearances and P = p (c/R)^2/(6 mu)
// in 1/s the liner gives P of its deflection u = h - 1 + e_x cos + e_y sin. Nodes in grooves have P = u = 0 and are no
// states; a long film has a groove at the top if none is given. Steps in time spend their time here: loops run over
// arrays of all nodes, or of those between grooves, without asking where a node lies or what its liner is made of.
class CompliantFilm final : public CompliantModel {
public:
  CompliantFilm(const Geometry& geometry, const Compliant& options, bool is_long, const Lubricant& lubricant)
      : CompliantModel(geometry, options, 0, lubricant), long_(is_long), n_(ring_.nodes()), step_(ring_.step()) {
    const double ld = 0.5 * g_.length / g_.radius;
    side_ = 1.5 / (ld * ld);
    const bool top = long_ && options.grooves.empty();
    place(grooved(n_, top ? std::vector{Groove{0.5 * std::numbers::pi, 0.0}} : options.grooves));
    for (auto* values : {&u_, &moved_, &full_[0], &full_[1], &left_[0], &left_[1], &slope_[0], &slope_[1]})
      values->resize(at(n_));
    for (auto* values : {&h_, &cos_, &sin_}) values->resize(at(n_) + kFront + kBehind);
    for (int k = 0; k < n_; ++k) {
      around(cos_)[k] = ring_.cosine(k);
      around(sin_)[k] = ring_.sine(k);
      for (std::size_t i = 0; i < 2; ++i) {
        full_[i][at(k)] = ring_.node(k)[i];
        left_[i][at(k)] = ring_.full(k).left[i];
      }
    }
    close(cos_);
    close(sin_);
    carried_.resize(h_.size());
    for (auto* values : {&conductance_, &by_face_, &flux_}) values->resize(at(n_ + 1));
    by_h_.resize(at(4 * n_));
    by_p_.resize(at(3 * n_));
  }

  [[nodiscard]] std::size_t states() const override { return at(states_); }
  // It is not cut: its loops run once around.
  [[nodiscard]] int cut(int near) const override { return 2 * near < states_ ? 0 : states_; }
  [[nodiscard]] Share share(int begin, int end) const override;
  void unloaded(const JournalMotion& motion, std::span<double> states) const override {
    for (int k = 0; k < n_; ++k)
      if (!fixed(k)) states[index(k)] = rigid(motion, k) * g_.clearance;
  }
  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override;
  void resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                std::span<double> to) const override;
  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override;
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override;

private:
  // Neighbouring nodes that are neighbouring states.
  struct Run {
    int node, state, count;
  };
  // A node in a groove, `place` - 2 nodes away from the row of a state.
  struct Bank {
    int state, row, place, node;
  };
  [[nodiscard]] static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] int wrap(int k) const { return (k + n_) % n_; }
  [[nodiscard]] bool fixed(int k) const { return state_[at(k)] < 0; }
  [[nodiscard]] std::size_t index(int k) const { return at(state_[at(k)]); }
  void place(const std::vector<bool>& fixed);
  void set(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates);
  void slopes();
  void integrate(Need need, StateResponse& response);
  void faces();
  void residual(double speed, std::span<const double> rates, std::span<double> g) const;
  void tangents(double speed, StateResponse& response);
  void by_journal(StateResponse& response) const;

  bool long_;
  int n_, states_ = 0;
  double step_, side_ = 0.0;  // -; 1.5/(L/D)^2
  // Where things are.
  std::vector<int> state_;  // of every node, or -1
  std::vector<Run> runs_;
  std::vector<int> fixed_;  // nodes in grooves
  std::vector<Bank> banks_;
  Places d_states_, d_rates_;
  std::vector<double> constant_rates_;          // what of dg/ds' does not come from the liner
  std::vector<std::size_t> by_h_at_, by_p_at_;  // of the entries in by_h_ and by_p_
  // At all nodes.
  std::vector<double> h_, cos_, sin_;                 // around; h in clearances
  std::vector<double> u_, moved_;                     // deflection and its rate, in clearances
  Carried carried_;                                   // around
  std::array<std::vector<double>, 2> full_, left_;    // weights of a node and of its side of the cell behind, all P > 0
  std::array<std::vector<double>, 2> slope_;          // d force*/dP
  std::vector<double> conductance_, by_face_, flux_;  // of the faces before nodes 0 .. n: of dP, by h there, and itself
  std::vector<double> by_h_, by_p_;                   // dg/c by h at k - 2 .. k + 1 in all, and by P at k - 1 .. k + 1
  double least_ = 0.0;                                // of h
};

}  // namespace whirl::film
