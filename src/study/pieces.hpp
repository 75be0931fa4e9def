#pragma once
// What a study has computed so far, piece by piece, in its checkpoint.

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "findings.hpp"
#include "study/packed.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

/// Pieces of work that a killed run does not do again: a location's error estimate, the modes at one speed.
///
/// A study asks for each by a name that the same deck gives again in a resumed run, and gets what was kept or what it
/// computes now. What a piece that is under way has found, and what is found between pieces, is in the replay log. The
/// checkpoint is the state() of the study with pieces and replay log since then. It is saved after each of them if half
/// a second has passed since it was saved last (more if saving takes long), so that a kill costs less than a second and
/// the work under way. Every rank holds the same, but for its rows of shared datasets; all members are collective.
class Pieces {
public:
  /// With `resume`, takes over the checkpoint of an earlier run if there is one. Without `save` no file is written.
  /// `layout` tells orders of unknowns apart: a replay log in another order is left.
  Pieces(Findings& findings, bool resume, bool save = true, int layout = 1);
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

  /// What else the checkpoint holds, with the rows of shared datasets that fell to this rank; empty until set.
  [[nodiscard]] const io::Group& state() const { return state_; }

  /// Whether the state was saved with unknowns in the order of this run.
  [[nodiscard]] bool same_layout() const { return same_layout_; }
  /// What was found since the state; null if no file is written.
  [[nodiscard]] solve::ReplayLog* replay_log() { return saves_ ? &replay_log_ : nullptr; }

  /// The piece of that name, made by `work` unless it is known.
  const io::Group& get(const std::string& name, const std::function<void(io::Group&)>& work);
  /// The same for numbers.
  std::vector<double> numbers(const std::string& name, const std::function<std::vector<double>()>& work);
  double number(const std::string& name, const std::function<double()>& work);
  /// The same for what pack() takes.
  template <class Work>
  auto value(const std::string& name, const Work& work) {
    return unpack<decltype(work())>(numbers(name, [&] { return pack(work()); }));
  }
  /// The same for all that is known of a bifurcation: `work` adds to it.
  void complete(const std::string& name, io::Bifurcation& b, const std::function<void()>& work);
  [[nodiscard]] bool known(const std::string& name) const { return pieces_.has_group(name); }

  /// Keeps the numbers of a piece, without saving.
  void keep(const std::string& name, const std::vector<double>& values);

  /// True if it is time to save: rank 0's clock decides for all. A state may be saved earlier, which takes the place of
  /// what was saved since the last one, but none while an interrupted run is repeated.
  [[nodiscard]] bool due() const;
  [[nodiscard]] bool state_due() const;
  /// Saves the pieces with the last state, if it is time.
  void save_if_due();
  /// Saves a new state, from which the pieces so far are of no use any more.
  void save(io::Group state);

private:
  void write();
  // One of the last files may have had to wait for other work on the machine.
  [[nodiscard]] double between() const;  // [s] between two files
  [[nodiscard]] double cost() const { return std::min(costs_[0], costs_[1]); }

  Findings& findings_;
  bool saves_;
  int layout_;
  bool same_layout_ = true;
  io::Group state_, pieces_;
  solve::ReplayLog replay_log_;
  double last_saved_ = -1e9, last_state_ = -1e9;  // at once for the first time
  std::array<double, 2> costs_{};                 // of the last files [s]
};

}  // namespace whirl::study
