#include "whirl/solve/newton/replay_log.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

// Inner iterations that start from elsewhere (a film's, a subspace's) move what is asked by their tolerance.
constexpr double same_to = 1e-8;

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return x == y || std::abs(x - y) <= same_to * std::max(std::abs(x), std::abs(y));
  });
}

}  // namespace

// An error that nobody expects leaves its question open.
struct ReplayLog::UnderWay {
  UnderWay(ReplayLog& replay_log, std::size_t place) : all(replay_log.under_way_) { all.push_back(place); }
  ~UnderWay() { all.pop_back(); }
  UnderWay(const UnderWay&) = delete;
  UnderWay& operator=(const UnderWay&) = delete;
  std::vector<std::size_t>& all;
};

ReplayLog::Answer ReplayLog::ask(const std::string& kind, const std::vector<double>& question,
                                 const std::function<Answer(const Answer& so_far)>& work) {
  const std::size_t here = next_++;
  if (here < entries_.size() && (entries_[here].kind != kind || !same(entries_[here].question, question)))
    entries_.resize(here);
  if (here == entries_.size()) entries_.push_back({kind, question, {}, State::under_way});
  if (const Entry& known = entries_[here]; known.state != State::under_way) {
    const auto again = [&](auto error) {
      error.mark_agreed();
      throw error;
    };
    if (known.state == State::not_converged) again(core::NotConverged(known.answer.text));
    if (known.state == State::outside) again(core::DomainError(known.answer.text));
    return known.answer;
  }
  const UnderWay scope(*this, here);
  try {
    const Answer so_far = entries_[here].answer;
    close(here, State::answered, work(so_far));
    return entries_[here].answer;
  } catch (const core::NotConverged& error) {
    close(here, State::not_converged, {{}, error.what()});
    throw;
  } catch (const core::DomainError& error) {
    close(here, State::outside, {{}, error.what()});
    throw;
  }
}

void ReplayLog::close(std::size_t place, State state, Answer answer) {
  forget_from(place + 1);
  entries_[place].state = state;
  entries_[place].answer = std::move(answer);
  if (changed) changed();
}

void ReplayLog::note(const std::function<Answer()>& so_far) {
  if (under_way_.empty() || !due || !due()) return;
  entries_[under_way_.back()].answer = so_far();
  if (changed) changed();
}

ReplayLog::Rows ReplayLog::keep(const ReplayLog* replay_log, Vec v) {
  PetscInt begin = 0, size = 0;
  core::check(VecGetOwnershipRange(v, &begin, nullptr));
  core::check(VecGetSize(v, &size));
  const auto total = static_cast<std::size_t>(size);
  if (replay_log && replay_log->by_rows != core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(v))))
    return {true, 0, total, core::gather(v)};
  const core::ReadArray a(v);
  return {false, static_cast<std::size_t>(begin), total, {a.data(), a.data() + a.size()}};
}

void ReplayLog::give(const Rows& rows, Vec v) {
  if (rows.whole)
    core::fill(v, rows.values);
  else
    core::fill(v, rows.begin, rows.values);
}

void ReplayLog::forget_from(std::size_t place) {
  entries_.resize(std::min(place, entries_.size()));
  next_ = std::min(place, next_);
}

void ReplayLog::begin(std::vector<Entry> entries) {
  entries_ = std::move(entries);
  next_ = 0;
}

}  // namespace whirl::solve
