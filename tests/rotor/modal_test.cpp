// Modal bases: exact where they must be, and the errors of the trial rotor.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "rotor/shafts.hpp"
#include "source_dir.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/rotor.hpp"

using namespace whirl;
using Type = rotor::Reduction::Type;

namespace {

constexpr double spring = 1e7;  // N/m

rotor::Options disc_rotor() {
  rotor::Options o = test::uniform_shaft(0.3, 0.015, 20, 2.05e11, 7860);
  rotor::Disc d;
  d.node = 7;
  d.mass = 0.5;
  d.diametral_inertia = 7.81e-5;
  d.polar_inertia = 1.56e-4;
  o.discs = {d};
  return o;
}

rotor::Options reduced(Type type, int modes, double support) {
  rotor::Options o = disc_rotor();
  o.reduction = {type, {1, 21}, modes, support};
  return o;
}

std::vector<double> frequencies(const rotor::Options& o, double speed, std::size_t count) {
  std::vector<double> out;
  for (const test::Whirl& w : test::whirl_modes(o, {{1, spring}, {21, spring}}, speed))
    if (out.size() < count) out.push_back(std::abs(w.frequency));
  return out;
}

}  // namespace

TEST(ModalReduction, ErrorsOfTheTrialRotorAreThoseComputedIndependently) {
  std::ifstream file(std::string(WHIRL_SOURCE_DIR) + "/tests/reference/rotor/reduction_trial_rotor.json");
  const nlohmann::json reference = nlohmann::json::parse(file);
  const auto exact = reference.at("frequency").get<std::vector<double>>();
  const std::vector<double> full = frequencies(disc_rotor(), 10000, exact.size());
  for (std::size_t k = 0; k < exact.size(); ++k) EXPECT_NEAR(full[k], exact[k], 1e-7 * exact[k]);
  for (const auto& [count, methods] : reference.at("error").items()) {
    const int planar = std::stoi(count) / 2;
    const std::map<std::string, rotor::Options> own = {{"modal_supported", reduced(Type::modal, planar, spring)},
                                                       {"modal_free", reduced(Type::modal, planar, 0)},
                                                       {"cb_real", reduced(Type::craig_bampton, planar - 2, 0)}};
    for (const auto& [name, options] : own) {
      const auto expected = methods.at(name).get<std::vector<double>>();
      const std::vector<double> found = frequencies(options, 10000, exact.size());
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_NEAR(std::abs(found[k] / full[k] - 1), expected[k], 2e-3 * expected[k] + 1e-8)
            << name << ' ' << count << ' ' << k;
    }
  }
}

// Masters are coordinates, modes at rest exact, and so is the shape under the weight between masters that are held.
TEST(ModalReduction, HoldsItsMastersAndItsModes) {
  for (const double support : {0.0, spring}) {
    const rotor::Rotor r(MPI_COMM_WORLD, reduced(Type::modal, 6, support));
    EXPECT_EQ(r.size(), 12);
    const Eigen::MatrixXd t = test::dense(r.matrices().basis.get());
    for (const int node : {1, 21}) {
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(12);
      unit(r.coordinate(node, rotor::Freedom::x)) = 1;
      EXPECT_EQ((t.row(rotor::full_coordinate(node, rotor::Freedom::x)).transpose() - unit).norm(), 0);
    }
    EXPECT_GT(r.quality().neglected, r.quality().retained);
  }
  rotor::Options at_rest = disc_rotor();
  const std::vector<double> full = frequencies(at_rest, 0, 12),
                            own = frequencies(reduced(Type::modal, 6, spring), 0, 12);
  for (std::size_t k = 0; k < full.size(); ++k) EXPECT_NEAR(own[k], full[k], 1e-7 * full[k]) << k;
}

// A turning rotor that nothing holds: rigid motions of zero frequency, and the precession of the shaft without a disc
// at I_p/I_d times its speed, 37.4298 rad/s.
TEST(ModalReduction, KeepsTheRigidMotionsOfTheFreeRotor) {
  rotor::Options whole = disc_rotor(), own = reduced(Type::modal, 8, 0), held = reduced(Type::craig_bampton, 6, 0);
  whole.discs = own.discs = held.discs = {};
  for (const rotor::Options& o : {whole, own, held}) {
    const auto modes = test::whirl_modes(o, {}, 10000);
    // Zeros of multiplicity beyond their vectors, which rounding spreads as its root.
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(modes[k].frequency), 0.5);
    const auto it = std::find_if(modes.begin(), modes.end(), [](const auto& w) { return std::abs(w.frequency) > 1; });
    EXPECT_NEAR(it->frequency, 37.42981908920773, 1e-3);
  }
}

TEST(ModalReduction, RefusesFewerModesThanMasters) {
  EXPECT_THROW(rotor::Rotor(MPI_COMM_WORLD, reduced(Type::modal, 1, 0)), core::InputError);
}
