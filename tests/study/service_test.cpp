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

bool is_unknown(const io::Service& s, const std::string& what) {
  const io::ServiceFact* unknown = fact(s, "not known at this speed");
  return !fact(s, what) && unknown && unknown->mark.find(what) != std::string::npos;
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
  EXPECT_EQ(fact(s, "stability")->study, "balanced");  // modes were listed on either side, and not computed there
  const auto* margin = fact(s, "margin in speed to the threshold of stability");
  EXPECT_NEAR(margin->value.value, 100 * 1400.0 / 3600, 1e-9);
  EXPECT_NEAR(margin->value.more.at("uncertainty"), 100 * 10.0 / 3600, 1e-9);
  EXPECT_NEAR(fact(s, "smallest log decrement")->value.value, 0.05, 1e-12);
  EXPECT_NE(fact(s, "smallest log decrement")->mark.find("between 3500 and 3700 rpm"), std::string::npos);
  // The damped crossing at 3500 is no critical speed.
  EXPECT_EQ(fact(s, "critical speed below")->value.value, 2500);
  EXPECT_EQ(fact(s, "critical speed above")->value.value, 4700);
  EXPECT_TRUE(is_unknown(s, "thinnest film"));
  // One sentence on all that is not known.
  EXPECT_TRUE(is_unknown(s, "largest vibration"));
  EXPECT_EQ(fact(s, "not known at this speed")->mark,
            "thinnest film (by `static` or `cycle_branch`), highest film temperature (by `thd` or a film with heat), "
            "largest vibration (by `unbalance_response`, `cycle_branch`, `motion` or `run_up`)");
}

io::StudySummary run_up() {
  io::StudySummary s;
  s.name = s.kind = "run_up";
  return s;
}

// Revolutions at 1000, 1100, ... rpm with amplitudes 10, 20, ... um of a journal and twice that of a node.
io::Group run_up_groups(int revolutions) {
  io::Group root;
  io::Group& group = root.child("run_up");
  group.set("acceleration", 25.0);
  std::vector<double> speed, journal, node, start;
  for (int k = 0; k < revolutions; ++k) {
    speed.push_back(1000 + 100 * k);
    journal.push_back(1e-5 * (k + 1));
    node.push_back(2e-5 * (k + 1));
    start.push_back(k < 3 ? 1 : 0);
  }
  io::Group& table = group.child("run_up");
  const auto n = static_cast<std::size_t>(revolutions);
  table.put("speed", speed, "rpm", "");
  table.put("start_transient", start, "1", "");
  table.put("amplitude", {n, 1}, journal, "m", "");
  table.label("amplitude", {{"B1"}});
  table.put("node_amplitude", {n, 1}, node, "m", "");
  table.label("node_amplitude", {{"node 7"}});
  return root;
}

TEST(Service, TakesTheVibrationOfARunUp) {
  const auto at_rpm = [](double speed, int revolutions) {
    return service_of({speed * rpm, "rpm"}, std::vector{run_up()}, run_up_groups(revolutions));
  };
  const auto passed = at_rpm(1550, 10);
  const auto* largest = fact(passed, "largest vibration");
  EXPECT_NEAR(largest->value.value, 2 * 65e-6, 1e-12);
  EXPECT_EQ(largest->place, "node 7");
  EXPECT_EQ(largest->mark, "0-peak, run-up at 25 rad/s^2");
  // The start counts, and says so; a run that ends a revolution below the speed has reached it, no other.
  const auto early = at_rpm(1150, 10), just = at_rpm(1950, 10), beyond = at_rpm(2200, 10);
  EXPECT_NE(fact(early, "largest vibration")->mark.find("free vibration of its start"), std::string::npos);
  EXPECT_NEAR(fact(just, "largest vibration")->value.value, 200e-6, 1e-12);
  EXPECT_TRUE(is_unknown(beyond, "largest vibration"));
}

TEST(Service, TakesTheTemperatureOfFilmsWithHeat) {
  io::StudySummary s;
  s.name = s.kind = "thd";
  s.set("temperature.maximum", 350, "K", {{"uncertainty", 2}});
  io::Group root;
  io::Group& group = root.child("thd");
  group.set("bearing", "B2");
  group.child("budget").put("parameter", {1000 * rpm, 2000 * rpm, 3000 * rpm}, "rad/s", "");
  group.child("budget").put("maximum_temperature", {320, io::no_value, 350}, "K", "");
  const auto at_rpm = [&](double speed) { return service_of({speed * rpm, "rpm"}, std::vector{s}, root); };
  // With its bar at the last speed, without one between two, nothing beyond.
  const auto last = at_rpm(3000), between = at_rpm(1500), beyond = at_rpm(3100);
  EXPECT_EQ(fact(last, "highest film temperature")->value.more.at("uncertainty"), 2);
  EXPECT_EQ(fact(last, "highest film temperature")->place, "B2");
  EXPECT_NEAR(fact(between, "highest film temperature")->value.value, 327.5, 1e-9);
  EXPECT_NE(fact(between, "highest film temperature")->mark.find("without a bar"), std::string::npos);
  EXPECT_TRUE(is_unknown(beyond, "highest film temperature"));
}

TEST(Service, TellsWhichJournalTheShaftLifts) {
  io::StudySummary s;
  s.name = s.kind = "static";
  s.set("load.A", 1000, "N", {{"uncertainty", 1}});
  s.set("load.B", -20, "N", {{"uncertainty", 1}});
  s.set("load.C", -0.5, "N", {{"uncertainty", 1}});  // within its bar
  io::Group root;
  root.child("static").set("speed", 3000 * rpm);
  const auto here = service_of({3000 * rpm, "rpm"}, std::vector{s}, root);
  EXPECT_EQ(fact(here, "load that points upwards")->place, "B");
  EXPECT_EQ(fact(here, "load that points upwards")->value.value, -20);
  s.set("load.A", 10, "N");  // a load that lifts the whole shaft is meant
  EXPECT_FALSE(fact(service_of({3000 * rpm, "rpm"}, std::vector{s}, root), "load that points upwards"));
}

TEST(Service, TakesFilmsPressuresAndGrowthOfAStatic) {
  io::StudySummary s;
  s.name = s.kind = "static";
  for (const auto& [name, film] : {std::pair{"A", 30e-6}, {"B", 20e-6}}) {
    const std::string head = std::string("bearing.") + name + ".";
    s.set(head + "min_thickness", film, "m", {{"uncertainty", 1e-6}});
    s.set(head + "minimum_film", 25e-6, "m");
    s.set(head + "max_pressure", 1e11 * film, "Pa");
  }
  io::Group root;
  root.child("static").set("speed", 3000 * rpm);
  root.child("static").set("stability", "unstable");
  const auto here = service_of({3000 * rpm, "rpm"}, std::vector{s}, root);
  EXPECT_EQ(fact(here, "stability")->mark, "unstable");
  EXPECT_EQ(fact(here, "thinnest film")->place, "B");
  EXPECT_EQ(fact(here, "thinnest film")->mark, "below minimum_film");
  EXPECT_EQ(fact(here, "highest film pressure")->place, "A");
  const auto elsewhere = service_of({3100 * rpm, "rpm"}, std::vector{s}, root);
  EXPECT_NE(fact(elsewhere, "stability")->mark.find("not known"), std::string::npos);
  EXPECT_TRUE(is_unknown(elsewhere, "thinnest film"));
}

TEST(Service, TakesMotionsAndTheSenseOfCriticalSpeeds) {
  io::StudySummary motion, modes;
  motion.name = motion.kind = "motion";
  motion.set("peak_to_peak.B1.x", 40e-6, "m");
  motion.set("peak_to_peak.B1.y", 50e-6, "m");
  modes.name = modes.kind = "modes";
  modes.set("critical.1.speed", 3500, "rpm");
  modes.set("critical.1.mode", 2, "1");
  modes.set("critical.2.speed", 3800, "rpm");
  modes.set("critical.2.mode", 3, "1");
  for (const auto& [speed, mode, whirl] :
       {std::tuple{3000.0, 2, "forward"}, {3400.0, 2, "backward"}, {3400.0, 3, "forward"}}) {
    modes.modes.emplace_back();
    modes.modes.back().speed = speed;
    modes.modes.back().speed_unit = "rpm";
    modes.modes.back().whirl = whirl;
    modes.modes.back().more["mode"] = mode;
  }
  io::Group root;
  root.child("motion").set("speed", 3600 * rpm);
  root.child("motion").set("motion", std::string("period-2"));
  const auto s = service_of({3600 * rpm, "rpm"}, std::vector{motion, modes}, root);
  EXPECT_NEAR(fact(s, "largest vibration")->value.value, 25e-6, 1e-15);
  EXPECT_NE(fact(s, "largest vibration")->mark.find("period-2"), std::string::npos);
  EXPECT_NE(fact(s, "critical speed below")->mark.find("backward whirl"), std::string::npos);
  EXPECT_EQ(fact(s, "critical speed above")->mark.find("backward whirl"), std::string::npos);
  const auto elsewhere = service_of({3000 * rpm, "rpm"}, std::vector{motion}, root);
  EXPECT_TRUE(is_unknown(elsewhere, "largest vibration"));
}

TEST(Service, TakesCyclesAndResponses) {
  io::StudySummary cycles, response;
  cycles.name = "balanced";  // its group says that the parameter is the speed
  cycles.kind = "cycle_branch";
  cycles.set("at.3600.peak_to_peak.B1.x", 40e-6, "m", {{"uncertainty", 2e-6}});
  cycles.set("at.3600.peak_to_peak.B1.y", 60e-6, "m");
  cycles.set("at.3500.peak_to_peak.B1.y", 90e-6, "m");
  cycles.set("at.3600.min_thickness.B1", 20e-6, "m");
  cycles.set("at.3600.min_thickness.B2", 12e-6, "m", {{"uncertainty", 1e-6}});
  cycles.set("at.3500.min_thickness.B1", 8e-6, "m");
  cycles.set("at.3600.multiplier.modulus", 1.01, "1");
  response.name = response.kind = "unbalance_response";
  response.set("operating_speed", 3600, "rpm");
  response.set("operating_speed.unstable_count", 1, "1");
  response.set("operating.node.4.semi_major", 25e-6, "m");
  io::PeakEntry near, damped;
  near.place = damped.place = "node 4";
  near.speed = {3400, "rpm"};
  damped.speed = {3590, "rpm"};
  damped.verdict = "damped, not critical";
  response.peaks = {near, damped};
  io::Group root = groups();
  root.child("balanced").set("parameter_unit", "rpm");
  const auto both = service_of({3600 * rpm, "rpm"}, std::vector{cycles, response}, root);
  EXPECT_NEAR(fact(both, "largest vibration")->value.value, 30e-6, 1e-12);
  EXPECT_NE(fact(both, "largest vibration")->mark.find("which is unstable"), std::string::npos);
  EXPECT_EQ(fact(both, "thinnest film")->place, "B2");
  EXPECT_EQ(fact(both, "thinnest film")->value.value, 12e-6);
  EXPECT_NE(fact(both, "thinnest film")->mark.find("over a cycle, which is unstable"), std::string::npos);
  EXPECT_EQ(fact(both, "peak below")->value.value, 3400);
  EXPECT_EQ(fact(both, "stability")->mark, "unstable");
  response.set("operating.node.4.semi_major", 35e-6, "m");
  const auto larger = service_of({3600 * rpm, "rpm"}, std::vector{cycles, response}, root);
  EXPECT_EQ(fact(larger, "largest vibration")->place, "node 4");
  // A linear motion that a film has no room for is no answer where there is another.
  response.set("operating_speed.answer", 0, "1");
  const auto beyond = service_of({3600 * rpm, "rpm"}, std::vector{cycles, response}, root);
  EXPECT_EQ(fact(beyond, "largest vibration")->place, "B1");
  const auto alone = service_of({3600 * rpm, "rpm"}, std::vector{response}, root);
  EXPECT_NE(fact(alone, "largest vibration")->mark.find("no answer"), std::string::npos);
}

// Modes at 1000, 1100, ... rpm, one of each word, with a decrement where they vibrate.
io::StudySummary modes_with(const std::vector<std::string>& words) {
  io::StudySummary s;
  s.name = s.kind = "modes";
  for (std::size_t k = 0; k < words.size(); ++k)
    for (const bool other : {false, true}) {
      io::ModeEntry m;
      m.speed = 1000 + 100 * static_cast<double>(k);
      m.speed_unit = "rpm";
      m.stability = other ? "stable" : words[k];
      m.imag = m.stability == "diverges" ? 0 : 100;
      if (m.imag > 0) m.log_decrement = m.stability == "undamped" ? 0 : m.stability == "unstable" ? -0.1 : 0.2;
      s.modes.push_back(m);
    }
  return s;
}

std::string verdict_at(double speed, const std::vector<io::StudySummary>& studies) {
  return fact(at(speed, studies), "stability")->mark;
}

TEST(Service, TheVerdictOfModesIsThatOfTheirWords) {
  EXPECT_EQ(verdict_at(1050, {modes_with({"diverges", "diverges"})}), "unstable");
  EXPECT_EQ(verdict_at(1050, {modes_with({"stable", "diverges"})}), "undetermined");
  EXPECT_EQ(verdict_at(1050, {modes_with({"stable", "undetermined"})}), "undetermined");
  EXPECT_EQ(verdict_at(1100, {modes_with({"unstable", "stable"})}), "stable");
  EXPECT_EQ(verdict_at(1100, {modes_with({"stable", "undetermined"})}), "undetermined");
  EXPECT_EQ(verdict_at(1100, {modes_with({"stable", "undamped"})}), "undamped");
  EXPECT_NE(verdict_at(1200, {modes_with({"stable", "stable"})}).find("not known"), std::string::npos);
  // A vibration of the elements has no say, and its decrement is none of the machine.
  io::StudySummary elements = modes_with({"stable"});
  elements.modes.push_back(elements.modes.back());
  elements.modes.back().stability = "not resolved";
  elements.modes.back().log_decrement = -1.5e-9;
  EXPECT_EQ(verdict_at(1000, {elements}), "stable");
  EXPECT_NEAR(fact(at(1000, {elements}), "smallest log decrement")->value.value, 0.2, 1e-12);
  // Nothing that vibrates has a decrement.
  io::StudySummary both = modes_with({"diverges"});
  both.modes.pop_back();
  EXPECT_EQ(verdict_at(1000, {both}), "unstable");
  // A decrement within its bar.
  io::StudySummary little = modes_with({"stable"});
  for (io::ModeEntry& m : little.modes) m.more["log_decrement_uncertainty"] = 0.3;
  EXPECT_EQ(verdict_at(1000, {little}), "undetermined");
}

TEST(Service, LimitsOfModesDecideBetweenTheirSpeeds) {
  io::StudySummary s = modes_with({"stable", "unstable", "stable"});
  s.ranges = {{1000, 1080, "rpm", "stable"}, {1080, 1150, "rpm", "unstable"}, {1150, 1200, "rpm", "stable"}};
  s.set("threshold", 1080, "rpm", {{"uncertainty", 2}});
  s.set("unstable.1.to", 1150, "rpm", {{"uncertainty", 4}});
  EXPECT_EQ(verdict_at(1050, {s}), "stable");
  EXPECT_EQ(verdict_at(1081, {s}), "undetermined");
  EXPECT_EQ(verdict_at(1120, {s}), "unstable");
  EXPECT_EQ(verdict_at(1153, {s}), "undetermined");
  EXPECT_EQ(verdict_at(1160, {s}), "stable");
  const auto margin = [&](double speed) {
    return fact(at(speed, {s}), "margin in speed to the threshold of stability")->value;
  };
  EXPECT_NEAR(margin(1050).value, 100 * 30.0 / 1050, 1e-9);
  EXPECT_NEAR(margin(1050).more.at("uncertainty"), 100 * 2.0 / 1050, 1e-9);
  EXPECT_NEAR(margin(1120).value, -100 * 30.0 / 1120, 1e-9);
  EXPECT_NEAR(margin(1160).value, 100 * 10.0 / 1160, 1e-9);
}

TEST(Service, OfOneLimitTheSmallerBarCounts) {
  io::StudySummary s = modes_with({"stable", "unstable"});
  s.ranges = {{3500, 4990, "rpm", "stable"}, {4990, 5200, "rpm", "unstable"}};
  s.set("threshold", 4990, "rpm", {{"uncertainty", 90}});
  for (const auto& studies : {std::vector{branch(5000, 10), s}, std::vector{s, branch(5000, 10)}}) {
    const auto* margin = fact(at(3600, studies), "margin in speed to the threshold of stability");
    EXPECT_EQ(margin->study, "balanced");
    EXPECT_NEAR(margin->value.value, 100 * 1400.0 / 3600, 1e-9);
  }
}

// A subcritical threshold at 5000 rpm: whirl goes down to a fold at 4680 +- 20 rpm and is stable from there upwards.
TEST(Service, TellsFromWhichSpeedWhirlIsPossible) {
  io::StudySummary s;
  s.name = "whirl";
  s.kind = "cycle_branch";
  s.ranges = {{5000, 4680, "rpm", "unstable"}, {4680, 6000, "rpm", "stable"}};
  s.bifurcations.resize(1);
  s.bifurcations[0].value = 4680;
  s.bifurcations[0].unit = "rpm";
  s.bifurcations[0].uncertainty = 20;
  io::Group root;
  root.child("whirl").set("parameter", "speed");
  root.child("whirl").set("parameter_unit", "rpm");
  root.child("whirl").set("unbalance", "");
  const char* what = "stable whirl, which a disturbance can start, from";
  const auto below = service_of({4000 * rpm, "rpm"}, std::vector{s}, root);
  ASSERT_NE(fact(below, what), nullptr);
  EXPECT_EQ(fact(below, what)->value.value, 4680);
  EXPECT_NEAR(fact(below, what)->value.bar(), 20, 1e-9);
  EXPECT_EQ(fact(below, what)->mark, "17.0 % above the service speed");
  const auto within = service_of({4800 * rpm, "rpm"}, std::vector{s}, root);
  EXPECT_EQ(fact(within, what)->mark, "the service speed is within its range");
  EXPECT_EQ(fact(service_of({6500 * rpm, "rpm"}, std::vector{s}, root), what), nullptr);
  root.child("whirl").set("unbalance", "impeller");  // forced vibration
  EXPECT_EQ(fact(service_of({4000 * rpm, "rpm"}, std::vector{s}, root), what), nullptr);
}

// Whirl of a branch ends at 4470 +- 50 rpm; the branch may run downwards.
TEST(Service, EveryLimitOfABranchHasItsBar) {
  io::StudySummary up = branch(1500, 1), down = up;
  up.ranges = {{500, 1500, "rpm", "stable"}, {1500, 4470, "rpm", "unstable"}, {4470, 8000, "rpm", "stable"}};
  down.ranges = {{8000, 4470, "rpm", "stable"}, {4470, 1500, "rpm", "unstable"}, {1500, 500, "rpm", "stable"}};
  io::Bifurcation ends;
  ends.value = 4470;
  ends.unit = "rpm";
  ends.uncertainty = 50;
  for (io::StudySummary* s : {&up, &down}) {
    s->bifurcations = {ends};
    EXPECT_EQ(verdict_at(4480, {*s}), "undetermined");
    EXPECT_EQ(verdict_at(4600, {*s}), "stable");
    EXPECT_EQ(verdict_at(3000, {*s}), "unstable");
    EXPECT_NEAR(fact(at(4600, {*s}), "margin in speed to the threshold of stability")->value.value, 100 * 130.0 / 4600,
                1e-9);
  }
}

// What listed speeds on either side say counts where nothing else does.
TEST(Service, ListedSpeedsDoNotKnowWhatLiesBetween) {
  const auto alone = at(6000, {modes(6000, 0.1)}), both = at(6000, {branch(5000, 10), modes(6000, 0.1)});
  EXPECT_EQ(fact(alone, "stability")->mark, "stable");
  EXPECT_EQ(fact(alone, "stability")->study, "modes at the speeds beside it");
  EXPECT_EQ(fact(both, "stability")->mark, "unstable");
}

TEST(Service, StudiesThatDifferDecideNothing) {
  EXPECT_EQ(fact(at(5004, {branch(5000, 10)}), "stability")->mark, "undetermined");
  EXPECT_EQ(verdict_at(1000, {branch(800, 10), modes_with({"unstable"})}), "unstable");
  EXPECT_EQ(verdict_at(1000, {branch(800, 10), modes_with({"stable"})}), "undetermined: the studies differ");
  EXPECT_NE(fact(at(6000, {}), "stability")->mark.find("not known"), std::string::npos);
}

}  // namespace
}  // namespace whirl::study
