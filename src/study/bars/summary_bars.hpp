#pragma once
// Error bars of all named values of a study at once.

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/bars/error_bar.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/layout.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Collects the values of a summary on other meshes, and puts bars beside those that change with the mesh.
class SummaryBars {
public:
  /// Of the values that `summary` has now; it outlives this. Exact values get no bar: numbers of nodes, limits that the
  /// deck gives and nondimensional groups depend on no mesh, also where another mesh gave nothing.
  SummaryBars(io::StudySummary& summary, MeshLaw law);
  /// Values of the same names on another mesh; those that are missing there are unknown there.
  void add(Axis axis, double spacing, const io::StudySummary& there) { add(axis, spacing, row(there)); }
  /// The same with what `compute` puts there; nothing if that mesh has no answer.
  void add(Axis axis, double spacing, const std::function<void(io::StudySummary& there)>& compute);
  /// The same on several meshes, shared between the ranks: `compute` is collective on layout.space. Collective.
  void add(const Layout& layout, Pieces& pieces, const std::vector<FilmMesh>& meshes,
           const std::function<void(const FilmMesh& mesh, io::StudySummary& there)>& compute);
  /// What `there` has of these values, in their order, not numbers where it has none; and the same as a row of them.
  [[nodiscard]] std::vector<double> row(const io::StudySummary& there) const;
  void add(Axis axis, double spacing, const std::vector<double>& row);
  /// Writes the bars. Components of one vector or matrix (names that differ in a last x, y, xx, ...) err together: each
  /// bar is at least a quarter of the largest of its kin, so that a difference that vanishes by chance hides nothing.
  /// `location` is what an iteration leaves of the value with this name.
  using Location = std::function<double(const std::string& name, double value)>;
  void write(const Location& location);
  /// The same part of every value.
  void write(double relative_location = 0) {
    write([=](const std::string&, double value) { return relative_location * std::abs(value); });
  }

private:
  io::StudySummary& summary_;
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<bool> moved_;
  Bars bars_;
  bool with_time_ = false, any_ = false;
};

/// Runs `compute`; false if a mesh that serves an estimate only has no answer: no convergence, a film that leaves its
/// validity, grooves that leave nothing of a coarser mesh. `reason` takes what was said, if it is wanted.
[[nodiscard]] bool has_answer(const std::function<void()>& compute, std::string* reason = nullptr);
/// What `compute` returns, or an empty one of its kind where there is no answer.
template <class F>
[[nodiscard]] auto answer_of(const F& compute) {
  decltype(compute()) out{};
  if (!has_answer([&] { out = compute(); })) out = {};
  return out;
}

/// An answer, or the reason why there is none.
template <class T>
struct Answered {
  std::optional<T> found = {};
  std::string reason = {};
  void members(auto& archive) { archive(found, reason); }
};
/// What `compute` returns.
template <class F>
[[nodiscard]] auto answered(const F& compute) {
  Answered<decltype(compute())> out;
  if (!has_answer([&] { out.found = compute(); }, &out.reason)) out.found.reset();
  return out;
}

/// "bearing.B1.K." for "bearing.B1.K.xy": what components of one vector or matrix share.
[[nodiscard]] std::string stem_of(const std::string& name);

}  // namespace whirl::study
