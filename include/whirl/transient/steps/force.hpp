#pragma once
// External forces on a motion: F(angle, x, dx/dt) - B f(t) = 0.

#include <memory>
#include <span>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/transient/steps/signal.hpp"

namespace whirl::transient {

/// Forces f_k(t), each with its column of B.
///
/// The equations of a system know no time (problem::System); these rows are what an Integrator adds to them. A motion
/// under them depends on its time, so a checkpoint of it needs that. Every rank holds all entries and uses those of its
/// rows.
class Forces {
public:
  struct Entry {
    PetscInt row;  ///< of F, in natural order
    double weight;
  };
  void add(std::unique_ptr<Signal> signal, std::vector<Entry> column);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  [[nodiscard]] std::size_t count() const { return parts_.size(); }

  /// The first break of any force later than t; infinite if there is none.
  [[nodiscard]] double next_break(double t) const;
  /// No force changes between these times.
  [[nodiscard]] bool constant(double begin, double end) const;
  /// The next values asked for are those of a step between these times, which no break parts.
  void enter(double begin, double end);
  /// f_k(t) within the step entered [N].
  [[nodiscard]] double value(std::size_t k, double t) const;
  /// rows -= factor B f(t) within the step entered; `rows` are those of F from `begin` on, each multiplied by its
  /// `factor`.
  void subtract(double t, PetscInt begin, std::span<const double> factor, std::span<double> rows) const;

private:
  struct Part {
    std::unique_ptr<Signal> signal;
    std::vector<Entry> column;
  };
  std::vector<Part> parts_;
  double inside_ = 0;
};

}  // namespace whirl::transient
