// Forces, equilibria and linear coefficients against an independent computation.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "film/cases.hpp"
#include "source_dir.hpp"
#include "whirl/film/contract/turbulence.hpp"

namespace whirl::film::testing {
namespace {

using Json = nlohmann::json;

Json records() {
  std::ifstream file(std::string(WHIRL_SOURCE_DIR) + "/tests/reference/film_records.json");
  return Json::parse(file).at("records");
}

struct Setup {
  Geometry geometry;
  Reynolds options;
  double speed;
};

Setup setup(const Json& p, std::array<int, 2> cells) {
  Setup s;
  const double R = p.at("R");
  s.geometry.type = p.at("type") == "arc" ? Geometry::Bore::partial_arc : Geometry::Bore::lemon_bore;
  s.geometry.radius = R;
  s.geometry.length = 2.0 * R * p.at("L_over_D").get<double>();
  s.geometry.clearance = 0.002 * R;
  s.geometry.arc = p.at("arc_deg").get<double>() * kDegree;
  s.geometry.preload = p.at("preload");
  s.geometry.offset = p.value("offset_cb", 0.0) * s.geometry.clearance;
  s.options.cells = cells;
  s.options.turbulence = p.at("turbulence").get<bool>() ? Turbulence::constantinescu : Turbulence::laminar;
  s.options.cavitation =
      p.at("cavitation") == "half-Sommerfeld" ? Reynolds::Cavitation::half_sommerfeld : Reynolds::Cavitation::reynolds;
  s.speed = p.at("Omega");
  return s;
}

// Position under a vertical load by Newton's method with the film's own tangents.
JournalMotion equilibrium(Film& model, const Setup& s, double load) {
  JournalMotion m = motion(s.geometry, {0.3, -0.4, 0.0, 0.0}, {}, s.speed);
  for (int k = 0; k < 60; ++k) {
    const Response r = evaluate(model, m);
    const double fx = r.force[0], fy = r.force[1] - load;
    const auto& J = r.d_position;
    const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    const double dx = -(J[1][1] * fx - J[0][1] * fy) / det, dy = -(J[0][0] * fy - J[1][0] * fx) / det;
    const double most = 0.05 * s.geometry.clearance / std::max(std::hypot(dx, dy), 1e-300);
    const double damp = std::min(1.0, most);
    m.position[0] += damp * dx;
    m.position[1] += damp * dy;
    if (std::hypot(dx, dy) < 1e-13 * s.geometry.clearance) return m;
  }
  ADD_FAILURE() << "no equilibrium";
  return m;
}

std::vector<double> compute(const Json& record, std::array<int, 2> cells) {
  const Json& p = record.at("parameters");
  const std::string quantity = record.at("quantity");
  if (p.contains("Re")) {
    const double Re = p.at("Re");
    const auto t = Turbulence::constantinescu;
    return {evaluate(resistance_around(t), Re), evaluate(resistance_along(t), Re)};
  }
  const Setup s = setup(p, cells);
  auto model = make_film(s.geometry, s.options, oil());
  if (quantity.starts_with("force")) {
    const JournalMotion m = motion(s.geometry, {p.at("x_cb"), p.at("y_cb"), 0.0, 0.0},
                                   {p.at("vx_cb_Om"), p.at("vy_cb_Om"), 0.0, 0.0}, s.speed);
    const Response r = evaluate(*model, m, Need::force);
    return {r.force[0], r.force[1]};
  }
  const JournalMotion m = equilibrium(*model, s, p.at("load_N"));
  const Response r = evaluate(*model, m);
  if (quantity.starts_with("equilibrium")) {
    return {m.position[0] / s.geometry.clearance, m.position[1] / s.geometry.clearance};
  }
  const auto& d = quantity.starts_with("stiffness") ? r.d_position : r.d_velocity;
  return {-d[0][0], -d[0][1], -d[1][0], -d[1][1]};
}

class Reference : public ::testing::TestWithParam<int> {};

// The linear coefficients at equilibrium are the most sensitive to the grid: two grids extrapolated at order 2.
TEST_P(Reference, AgreesWithinItsUncertainty) {
  const Json record = records().at(static_cast<std::size_t>(GetParam()));
  SCOPED_TRACE(record.dump());
  const std::vector<double> coarse = compute(record, {120, 24}), fine = compute(record, {240, 48});
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const double value = record.at("value").at(i), uncertainty = record.at("uncertainty").at(i);
    const double extrapolated = fine[i] + (fine[i] - coarse[i]) / 3.0;
    EXPECT_NEAR(extrapolated, value, uncertainty) << "component " << i << ", on the fine grid " << fine[i];
  }
}

INSTANTIATE_TEST_SUITE_P(Records, Reference, ::testing::Range(0, 30));

}  // namespace
}  // namespace whirl::film::testing
