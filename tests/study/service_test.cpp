// What summaries say together of a machine at its service speed.
#include "study/service.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

constexpr double rpm = std::numbers::pi / 30;

const io::ServiceFact* fact(const io::Service& s, const std::string& what) {
  for (const io::ServiceFact& f : s.facts)
    if (f.what == what) return &f;
  return nullptr;
}

io::StudySummary branch(double threshold, double bar) {
  io::StudySummary s;
  s.name = "balanced";
  s.kind = "equilibrium_branch";
  s.ranges = {{500, threshold, "rpm", "stable"}, {threshold, 8000, "rpm", "unstable"}};
  s.set("threshold", threshold * rpm, "rad/s", {{"uncertainty", bar * rpm}});
  return s;
}

io::StudySummary modes(double speed, double decrement) {
  io::StudySummary s;
  s.name = "modes";
  s.kind = "modes";
  for (const double at : {speed - 100, speed + 100})
    for (const double more : {0.0, 0.2}) {
      io::ModeEntry m;
      m.speed = at;
      m.speed_unit = "rpm";
      m.imag = 100;
      m.log_decrement = decrement + more + (at > speed ? -0.01 : 0.01);
      m.stability = m.log_decrement > 0 ? "stable" : "unstable";
      s.modes.push_back(m);
    }
  s.set("critical.1.speed", 2500, "rpm");
  s.set("critical.1.log_decrement", 0.2, "1");
  s.set("critical.2.speed", 3500, "rpm");
  s.set("critical.2.log_decrement", 2.0, "1");
  s.set("critical.3.speed", 4700, "rpm");
  s.set("critical.3.log_decrement", 0.1, "1");
  return s;
}

io::Group groups() {
  io::Group root;
  root.child("balanced").set("parameter", "speed");
  return root;
}

io::Service at(double speed, const std::vector<io::StudySummary>& studies) {
  return service_of({speed * rpm, "rpm"}, studies, groups());
}

TEST(Service, TakesTheFactsOfTheStudies) {
  const auto s = at(3600, {branch(5000, 10), modes(3600, 0.05)});
  EXPECT_NEAR(s.speed.value, 3600, 1e-9);
  EXPECT_EQ(fact(s, "stability")->mark, "stable");
  EXPECT_EQ(fact(s, "stability")->study, "balanced, modes");
  const auto* margin = fact(s, "margin in speed to the threshold of stability");
  EXPECT_NEAR(margin->value.value, 100 * 1400.0 / 3600, 1e-9);
  EXPECT_NEAR(margin->value.more.at("uncertainty"), 100 * 10.0 / 3600, 1e-9);
  EXPECT_NEAR(fact(s, "smallest log decrement")->value.value, 0.05, 1e-12);
  EXPECT_NE(fact(s, "smallest log decrement")->mark.find("between 3500 and 3700 rpm"), std::string::npos);
  // The damped crossing at 3500 is no critical speed.
  EXPECT_EQ(fact(s, "critical speed below")->value.value, 2500);
  EXPECT_EQ(fact(s, "critical speed above")->value.value, 4700);
  EXPECT_TRUE(fact(s, "thinnest film")->study.empty());
  EXPECT_NE(fact(s, "largest vibration")->mark.find("unbalance_response"), std::string::npos);
}

TEST(Service, StudiesThatDifferDecideNothing) {
  EXPECT_EQ(fact(at(5004, {branch(5000, 10)}), "stability")->mark, "undetermined");
  EXPECT_EQ(fact(at(6000, {branch(5000, 10), modes(6000, -0.1)}), "stability")->mark, "unstable");
  EXPECT_EQ(fact(at(6000, {branch(5000, 10), modes(6000, 0.1)}), "stability")->mark,
            "undetermined: the studies differ");
  EXPECT_NE(fact(at(6000, {}), "stability")->mark.find("not known"), std::string::npos);
}

}  // namespace
}  // namespace whirl::study
