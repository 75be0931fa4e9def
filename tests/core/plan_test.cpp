// An option takes another way than the counts, and what was taken can be read.
#include "whirl/core/plan.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "support/petsc_options.hpp"
#include "whirl/core/error.hpp"

using namespace whirl::core;
using whirl::test::WithOptions;

TEST(Plan, OptionsTakeTheOtherWay) {
  EXPECT_EQ(plan::modes(1000), plan::ModesWay::whole);
  EXPECT_EQ(plan::step(10, 130), plan::StepWay::dense);
  EXPECT_EQ(plan::cycle({.dense = 2, .sweeps = 1, .modes = 1}, true, false), plan::CycleWay::sweeps);
  const WithOptions other(
      WithOptions::List{{"-modes_whole_states", "999"}, {"-steps_by", "sparse"}, {"-cycles_by", "dense"}});
  EXPECT_EQ(plan::modes(1000), plan::ModesWay::transfer);
  EXPECT_EQ(plan::step(10, 130), plan::StepWay::sparse);
  EXPECT_EQ(plan::cycle({.dense = 2, .sweeps = 1, .modes = 1}, true, false), plan::CycleWay::dense);
}

TEST(Plan, CyclesTakeOnlyWaysThatServe) {
  constexpr plan::CycleCosts costs{.dense = 3, .sweeps = 2, .modes = 1};
  EXPECT_EQ(plan::cycle(costs, true, true), plan::CycleWay::sweeps);
  EXPECT_EQ(plan::cycle(costs, false, true), plan::CycleWay::modes);
  EXPECT_EQ(plan::cycle(costs, false, false), plan::CycleWay::dense);
  const WithOptions asked(WithOptions::List{{"-cycles_by", "modes"}});
  EXPECT_EQ(plan::cycle({.dense = 1, .sweeps = 2, .modes = 2}, false, true), plan::CycleWay::modes);
  EXPECT_EQ(plan::cycle(costs, false, false), plan::CycleWay::dense);
}

TEST(Plan, AWordThatIsNoWayIsRefused) {
  const WithOptions wrong(WithOptions::List{{"-modes_by", "guess"}});
  EXPECT_THROW((void)plan::modes(10), InputError);
}

TEST(Plan, ARecordKeepsTheFirstOfEachKind) {
  plan::Record outer;
  {
    plan::Record inner;
    plan::note(plan::StepWay::dense);
    plan::note(plan::StepWay::sparse);
    plan::note(plan::CycleWay::sweeps);
    EXPECT_EQ(inner.text(), "cycles by sweeps over the intervals; steps by dense factors");
  }
  EXPECT_EQ(outer.text(), "");
}

TEST(Plan, OptionsStandOnce) {
  std::set<std::string> names;
  for (const plan::SolverOption& o : plan::options()) EXPECT_TRUE(names.insert(o.name).second) << o.name;
  for (const plan::Prefix& p : plan::prefixes()) EXPECT_TRUE(names.insert(p.name).second) << p.name;
}
