#include "findings.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "whirl/core/petsc.hpp"
#include "whirl/io/checkpoint.hpp"
#include "whirl/study/stop.hpp"

namespace whirl::study {

Findings::Findings(MPI_Comm comm, const std::string& name, const std::string& kind, std::filesystem::path checkpoint,
                   Say say)
    : comm_(comm),
      rank_(core::rank_of(comm)),
      checkpoint_(std::move(checkpoint)),
      say_(rank_ == 0 ? std::move(say) : nullptr),
      started_(std::chrono::steady_clock::now()) {
  result_.summary.name = name;
  result_.summary.kind = kind;
  result_.group.set("kind", kind);
  result_.group.set("title", name);
}

Findings::~Findings() {
  for (auto& [count, g] : rank_groups_)
    for (MPI_Comm* c : {&g.space, &g.time}) MPI_Comm_free(c);
}

Findings::RankGroups Findings::rank_groups(int count) {
  const auto [at, missing] = rank_groups_.try_emplace(count);
  if (missing) {
    const int each = core::size_of(comm_) / count;
    MPI_Comm_split(comm_, rank_ / each, rank_, &at->second.space);
    MPI_Comm_split(comm_, rank_ % each, rank_, &at->second.time);
  }
  return at->second;
}

StudyResult Findings::finish(const std::string& status, bool delivered) {
  result_.delivered = delivered;
  result_.summary.status = status;
  result_.summary.wall_seconds = seconds();
  // Nobody knows what lies behind the end of a branch that did not reach its own.
  constexpr std::string_view whole = " throughout";
  std::string& stability = result_.summary.stability;
  if (status != "completed" && stability.ends_with(whole))
    stability.replace(stability.size() - whole.size(), whole.size(), " as far as followed");
  result_.group.set("status", status);
  result_.group.set("delivered", delivered ? 1 : 0);
  return std::move(result_);
}

void Findings::progress(const std::string& line) {
  if (!say_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_line_ < std::chrono::milliseconds(100)) return;
  last_line_ = now;
  say_(line, true);
}

std::string Findings::left(double done) {
  constexpr double window = 30, known_after = 3;
  if (!say_) return "";
  const double now = seconds();
  if (pace_.empty() || now - pace_.back()[0] > 0.1) pace_.push_back({now, done});
  while (pace_.size() > 2 && now - pace_.front()[0] > window) pace_.pop_front();
  const double took = now - pace_.front()[0], went = done - pace_.front()[1];
  return took < known_after || !(went > 0) ? "" : ", " + duration_in_words((1 - done) * took / went) + " left";
}

std::string Findings::left_over(double at, double from, double to, const std::string& unit) {
  const double done = to == from ? 1 : (at - from) / (to - from);
  return fmt::format(", {:.0f} % of {:.6g} to {:.6g} {}{}", 100 * std::clamp(done, 0.0, 1.0), from, to, unit,
                     left(done));
}

std::string duration_in_words(double seconds) {
  constexpr double minute = 60, hour = 3600, day = 86400, twice = 2;
  if (seconds < twice * minute) return fmt::format("{:.0f} s", seconds);
  if (seconds < twice * hour) return fmt::format("{:.0f} min", seconds / minute);
  if (seconds < twice * day) return fmt::format("{:.0f} h", seconds / hour);
  return fmt::format("{:.0f} days", seconds / day);
}

bool Findings::agreed(bool word) const {
  int yes = word;
  MPI_Bcast(&yes, 1, MPI_INT, 0, comm_);
  return yes != 0;
}

void Findings::save_checkpoint(const io::Group& state) const {
  io::Checkpoint(checkpoint_).save(state, comm_);
  checkpoint_written();
}

void Findings::save_each_second(const std::function<io::Group()>& state) {
  if (!agreed(saves_at_once() || seconds() - last_saved_ >= 1)) return;
  io::Group all = state();
  all.set("seconds", seconds());
  save_checkpoint(all);
  last_saved_ = seconds();
}

bool Findings::has_checkpoint() const {
  int there = rank_ == 0 && io::Checkpoint(checkpoint_).exists();
  MPI_Bcast(&there, 1, MPI_INT, 0, comm_);
  return there != 0;
}

io::Group Findings::load_checkpoint() const {
  return io::Checkpoint(checkpoint_).load(comm_).state;
}

}  // namespace whirl::study
