// An interrupted computation goes on where it was, and finds what it would have found.

#include <gtest/gtest.h>

#include "branch_support.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/newton/replay_log.hpp"

using namespace whirl;
using solve::ReplayLog;
using test::Column;

namespace {

// On all ranks at once.
struct Kill : core::Error {
  Kill() : core::Error("killed") { mark_agreed(); }
};

core::Vector copy(Vec v) {
  core::Vector c = core::duplicate(v);
  core::check(VecCopy(v, c.get()));
  return c;
}

solve::BranchState copy(const solve::BranchState& s) {
  return s.u ? solve::BranchState{copy(s.u.get()), copy(s.tangent.get()), s.point} : solve::BranchState{};
}

solve::BranchMemory copy(const solve::BranchMemory& m) {
  solve::BranchMemory c{copy(m.before), m.earlier, m.visited, m.folds,  m.met, m.held, {},
                        m.warm,         m.born,    m.ranges,  m.between};
  if (m.held) c.held_u = copy(m.held_u.get());
  return c;
}

// A branch with a multiplier outside for 0 < p < 0.1 and a film that is near a kink: what a branch sees of them hangs
// on several points.
struct Branch {
  static constexpr double speed = 2;
  struct Saved {
    std::optional<solve::Restart> restart;
    std::vector<ReplayLog::Entry> replay_log;
    std::size_t points = 0, events = 0;
  };
  struct Found : test::Recorded {
    std::vector<solve::Suspicion> suspected;
  };
  Found found;
  int evaluations = 0, changes = 0;
  Saved saved;

  // Killed when the replay log has changed so many times.
  void run(int kill_at, const Saved* from = nullptr) {
    const auto formula = [this]<class T>(double angle, const Column<T>& x, const Column<T>& xdot, T p) {
      ++evaluations;
      const double c = std::cos(angle / 2), s = std::sin(angle / 2);
      const T a = c * x(0) + s * x(1), b = c * x(1) - s * x(0);
      const T da = (0.0025 - (p - 0.05) * (p - 0.05)) * a - 0.1 * a * a * a + 0.02 * c, db = -b;
      Column<T> f(2);
      f << xdot(0) + 0.5 * speed * x(1) - (c * da - s * db), xdot(1) - 0.5 * speed * x(0) - (s * da + c * db);
      return f;
    };
    test::SmallSystem system(PETSC_COMM_SELF, 2, -1, speed, formula);
    solve::CycleOptions cycle;
    cycle.degree = 4;
    solve::CycleProblem problem(MPI_COMM_WORLD, system, cycle, solve::uniform_mesh(12));
    ReplayLog replay_log;
    if (from) replay_log.begin(from->replay_log);
    replay_log.due = [] { return true; };
    replay_log.changed = [&] {
      saved.replay_log = replay_log.entries();
      if (++changes == kill_at) throw Kill();
    };
    solve::ContinuationOptions options = test::range(-1, 1, 0.3);
    options.newton.replay_log = &replay_log;
    auto callbacks = test::recording(problem, found);
    callbacks.cycles = true;
    callbacks.stability = [&](Vec) { return test::multipliers(problem); };
    callbacks.refine = [&](const solve::LocatedEvent& e, Vec u, Vec t) {
      return solve::refine(problem, e, u, t, options.newton);
    };
    callbacks.on_suspicion = [&](const solve::Suspicion& x) { found.suspected.push_back(x); };
    callbacks.checkpoint = [&](const solve::ResumePoint& at, Vec u, Vec t) {
      replay_log.begin();
      saved = {solve::Restart{copy(u), copy(t), at.next_step, at.point, copy(*at.memory)},
               {},
               found.points.size(),
               found.events.size()};
      return true;
    };
    std::optional<solve::Restart> restart;
    core::Vector u = problem.make_unknown();
    if (from && from->restart) {
      const solve::Restart& r = *from->restart;
      restart = solve::Restart{copy(r.u.get()), copy(r.tangent.get()), r.step, r.point, copy(r.memory)};
      u.reset();
    }
    found.end = solve::follow_branch(problem, std::move(u), options, callbacks, std::move(restart));
  }
};

ReplayLog::Answer number(double x) {
  return {{x}, {}};
}

}  // namespace

TEST(ReplayLog, ARepetitionIsToldWhatWasFound) {
  ReplayLog first;
  (void)first.ask("sum", {1}, [](const auto&) { return number(2); });
  (void)first.ask("sum", {2}, [](const auto&) { return number(4); });
  ReplayLog second;
  second.begin(first.entries());
  const auto never = [](const auto&) -> ReplayLog::Answer { throw Kill(); };
  EXPECT_EQ(second.ask("sum", {1 + 1e-12}, never).numbers.front(), 2) << "another number of ranks rounds otherwise";
  // Another question: what stood there is no answer to it, nor is the rest.
  EXPECT_EQ(second.ask("sum", {3}, [](const auto&) { return number(6); }).numbers.front(), 6);
  EXPECT_EQ(second.entries().size(), 2U);
  second.begin(first.entries());
  EXPECT_THROW((void)second.ask("product", {1}, never), Kill);
  EXPECT_EQ(second.entries().size(), 1U);
}

TEST(ReplayLog, AQuestionUnderWayGoesOnFromItsParts) {
  ReplayLog first;
  first.due = [] { return true; };
  const auto whole = [](ReplayLog& replay_log, bool killed, int& works) {
    return replay_log.ask("whole", {}, [&](const auto&) {
      const double part = replay_log.ask("part", {}, [&](const auto&) { return number(++works); }).numbers[0];
      return replay_log.ask("other part", {}, [&](const ReplayLog::Answer& so_far) {
        if (!so_far.numbers.empty()) return number(part + so_far.numbers[0]);
        replay_log.note([] { return number(10); });
        if (killed) throw Kill();
        return number(-1);
      });
    });
  };
  int works = 0;
  EXPECT_THROW((void)whole(first, true, works), Kill);
  ReplayLog second;
  second.begin(first.entries());
  EXPECT_EQ(whole(second, false, works).numbers[0], 11);
  EXPECT_EQ(works, 1);
  EXPECT_EQ(second.entries().size(), 1U) << "parts of what is answered are of no use";
}

TEST(ReplayLog, AnErrorIsAnAnswer) {
  ReplayLog replay_log;
  int works = 0;
  const auto ask = [&] {
    (void)replay_log.ask("fails", {}, [&](const auto&) -> ReplayLog::Answer {
      ++works;
      throw core::DomainError("the film is too thin");
    });
  };
  EXPECT_THROW(ask(), core::DomainError);
  replay_log.begin(replay_log.entries());
  try {
    ask();
    FAIL();
  } catch (const core::DomainError& error) {
    EXPECT_STREQ(error.what(), "the film is too thin");
    EXPECT_TRUE(error.agreed());
  }
  EXPECT_EQ(works, 1);
}

// Newton's iterates, looks, refinements: killed after each of them, the branch is the same, and hardly more is
// computed.
TEST(ReplayLog, ABranchGoesOnWhereItWasKilled) {
  Branch whole;
  whole.run(-1);
  ASSERT_EQ(whole.found.events.size(), 2U);
  for (int k = 1; k <= whole.changes; k += 3) {
    Branch first, second;
    EXPECT_THROW(first.run(k), Kill);
    second.run(-1, &first.saved);
    ASSERT_EQ(first.saved.points + second.found.points.size(), whole.found.points.size()) << k;
    ASSERT_EQ(first.saved.events + second.found.events.size(), whole.found.events.size()) << k;
    for (std::size_t i = 0; i < second.found.points.size(); ++i) {
      const auto &a = second.found.points[i], &b = whole.found.points[first.saved.points + i];
      EXPECT_EQ(a.newton_iterations, b.newton_iterations);
      EXPECT_EQ(a.parameter, b.parameter);
      EXPECT_EQ(a.step, b.step);
    }
    for (std::size_t i = 0; i < second.found.events.size(); ++i) {
      const auto &a = second.found.events[i], &b = whole.found.events[first.saved.events + i];
      EXPECT_EQ(a.parameter, b.parameter);
      EXPECT_EQ(a.bracket, b.bracket);
      EXPECT_EQ(a.sensitivity, b.sensitivity);
      EXPECT_TRUE(a.refined);
    }
    EXPECT_LT(first.evaluations + second.evaluations - whole.evaluations, whole.evaluations / 20) << k;
  }
}
