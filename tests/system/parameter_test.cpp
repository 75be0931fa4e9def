// A machine at another value of a parameter is the one that is made there: for every option that studies may vary.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/train_system.hpp"
#include "support/varied_machines.hpp"
#include "system/start.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using test::reduced_machine;
using test::rigid_machine;
using test::whole_machine;

namespace {

constexpr double speed = 300;

// Paths of all values in the deck of a machine.
void collect(const deck::Node& node, const std::string& path, std::vector<std::string>& out) {
  if (node.kind == deck::Node::Kind::scalar) out.push_back(path);
  int item = 0;
  for (const deck::Node& n : node.items) {
    const std::string step = node.kind == deck::Node::Kind::map ? n.key : std::to_string(++item);
    collect(n, path.empty() ? step : path + "." + step, out);
  }
}

// Those that studies may vary, unless zero or at the end of their range.
std::vector<std::string> continuable_paths(system::Machine machine) {
  std::vector<std::string> all, out;
  collect(deck::write(machine), "", all);
  for (const std::string& path : all) {
    try {
      const deck::Access a = deck::find_option(machine, path);
      if (a.continuable && *a.value != 0 && a.check.holds(1.03 * *a.value)) out.push_back(path);
    } catch (const core::InputError&) {  // no number
    }
  }
  return out;
}

// Every option that is marked, below `s`, by its key and that of the struct it stands in.
void collect(const deck::Structure& s, const std::string& in, std::set<std::string>& out) {
  for (const deck::Option& o : s.options) {
    if (!o.selector.empty() && o.selector == "system" && o.selected != std::vector<std::string>{"rotor"}) continue;
    if (o.continuable) out.insert(in + "." + o.key);
    if (const deck::Structure* inner = o.codec->structure()) collect(*inner, o.key, out);
  }
}

std::vector<std::string> unbalances(const system::Machine& machine) {
  std::vector<std::string> names = system::unbalance_names(machine);
  if (system::discs_force(machine)) names.emplace_back(system::unbalance_of_discs);
  return names;
}

double value_of(system::Machine machine, const std::string& path) {
  return *deck::find_option(machine, path).value;
}

system::Varying along(const system::Machine& machine, const std::string& path, double value) {
  return {[machine, path](double p) {
            system::Machine at = machine;
            const deck::Access a = deck::find_option(at, path);
            if (!a.check.holds(p)) throw core::DomainError("out of range");
            *a.value = p;
            return system::train_of(at, unbalances(at));
          },
          value, std::abs(value_of(machine, path))};
}

// Near rest, moving; the same on any number of ranks.
core::Vector state(system::RotorSystem& s) {
  core::Vector x = system::static_guess(s), scale = core::duplicate(x.get()), rows = core::duplicate(x.get());
  s.scales(scale.get(), rows.get());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  const core::WriteArray a(x.get());
  const core::ReadArray unit(scale.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] += 0.02 * unit[i] * std::sin(3.7 * static_cast<double>(begin + i));
  return x;
}

core::Vector rates(const core::Vector& x, double size) {
  core::Vector rate = core::duplicate(x.get());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(rate.get(), &begin, nullptr));
  const core::WriteArray a(rate.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = size * std::cos(1.3 * static_cast<double>(begin + i));
  return rate;
}

// F, J times a direction, dF/dp.
std::vector<core::Vector> answers(system::RotorSystem& s, Mat j, Vec x, Vec rate) {
  std::vector<core::Vector> out;
  for (int k = 0; k < 3; ++k) out.push_back(core::duplicate(x));
  s.residual(0.7, x, rate, out[0].get());
  s.jacobian(0.7, x, rate, 0.8, 30, j);
  core::check(MatMult(j, x, out[1].get()));
  s.parameter_derivative(0.7, x, rate, out[2].get());
  return out;
}

double relative(const core::Vector& a, const core::Vector& b) {
  core::Vector less = core::duplicate(a.get());
  core::check(VecWAXPY(less.get(), -1, a.get(), b.get()));
  const double size = core::norm(b.get());
  return core::norm(less.get()) / (size > 0 ? size : 1);
}

class Parameter : public testing::TestWithParam<system::Machine (*)()> {};

std::string name(const testing::TestParamInfo<system::Machine (*)()>& i) {
  return std::array{"Reduced", "Whole", "Rigid"}[i.index];
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Machines, Parameter, testing::Values(reduced_machine, whole_machine, rigid_machine), name);

TEST(Parameters, EveryOptionThatMayVaryIsTested) {
  std::set<std::string> marked, tested;
  collect(deck::structure_of<system::Machine>(), "machine", marked);
  for (const auto make : {reduced_machine, whole_machine, rigid_machine})
    for (const std::string& path : continuable_paths(make())) {
      std::vector<std::string> steps{"machine"};
      for (std::size_t at = 0, dot = 0; dot != std::string::npos; at = dot + 1) {
        dot = path.find('.', at);
        steps.push_back(path.substr(at, dot - at));
      }
      // Names and numbers of items are no keys.
      std::set<std::string> found;
      for (std::size_t k = 0; k < steps.size(); ++k)
        for (std::size_t l = k + 1; l < steps.size(); ++l)
          if (marked.contains(steps[k] + "." + steps[l])) found.insert(steps[k] + "." + steps[l]);
      tested.insert(found.begin(), found.end());
    }
  EXPECT_GE(marked.size(), 20u);
  EXPECT_EQ(tested, marked);
}

// Of five bearings one film, of the machine nothing: a rotor is made anew only where its own numbers change.
TEST(Parameters, OnlyWhatDependsOnThemIsMade) {
  struct Case {
    const char* what;
    void (*set)(system::Train&, double);
    double value;
    long rotors, films;
  };
  const Case cases[] = {
      {"clearance", [](system::Train& t, double p) { t.supports[2].geometry.clearance = p; }, 4e-4, 0, 1},
      {"viscosity of two",
       [](system::Train& t, double p) { t.supports[0].lubricant.viscosity = t.supports[4].lubricant.viscosity = p; },
       0.02, 0, 2},
      {"elevation", [](system::Train& t, double p) { t.supports[2].elevation = p; }, 1e-4, 0, 0},
      {"pedestal",
       [](system::Train& t, double p) {
         t.supports[1].stiffness = {p, 2 * p};
       },
       1e9, 0, 0},
      {"gravity", [](system::Train& t, double p) { t.gravity = p; }, 9.81, 0, 0},
      {"unbalance", [](system::Train& t, double p) { t.unbalance[0].amount = p; }, 1e-2, 0, 0},
      {"damping", [](system::Train& t, double p) { t.rotor.stiffness_damping = p; }, 1e-5, 0, 0},
      {"density", [](system::Train& t, double p) { t.rotor.material.density = p; }, 7850, 1, 0},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const auto train = [set = c.set](double p) {
      auto t = test::train({16, 6}, true);
      test::add_gen_pair(t, 6.3);
      set(t, p);
      return t;
    };
    system::RotorSystem s(MPI_COMM_SELF, system::Varying{train, c.value, c.value}, speed);
    const system::RotorSystem::Made first = s.made();
    EXPECT_EQ(first.rotors, 1);
    EXPECT_EQ(first.films, 5);
    s.set_parameter(1.01 * c.value);
    EXPECT_EQ(s.made().rotors, first.rotors + c.rotors);
    EXPECT_EQ(s.made().films, first.films + c.films);
    // On both sides for dF/dp, once for all states.
    const core::Vector x = state(s), rate = rates(x, 1e-3), f = core::duplicate(x.get());
    for (int k = 0; k < 2; ++k) s.parameter_derivative(0.7, x.get(), rate.get(), f.get());
    EXPECT_EQ(s.made().rotors, first.rotors + 3 * c.rotors);
    EXPECT_EQ(s.made().films, first.films + 3 * c.films);
    EXPECT_GT(core::norm(f.get()), 0);
  }
}

// F is linear in these: dF/dp is exact, and so is the way from one value to another one.
TEST(Parameters, LinearOnesHaveExactDerivatives) {
  system::Machine machine = reduced_machine();
  machine.bearings[0].slope = {{0.0, 1e-4}};  // in line with the shaft its axis would turn with gravity
  for (const char* path :
       {"gravity.1", "gravity.2", "loads.1.force.1", "loads.1.moment.2", "bearings.B1.pedestal.stiffness.2",
        "bearings.B1.pedestal.damping.1", "unbalance.two.planes.1.amount", "rotor.stiffness_damping"}) {
    SCOPED_TRACE(path);
    const double value = value_of(machine, path);
    system::RotorSystem s(MPI_COMM_WORLD, along(machine, path, value), speed);
    const core::Vector x = state(s), rate = rates(x, 1e-3), by = core::duplicate(x.get()),
                       from = core::duplicate(x.get()), to = core::duplicate(x.get());
    s.parameter_derivative(0.7, x.get(), rate.get(), by.get());
    s.residual(0.7, x.get(), rate.get(), from.get());
    s.set_parameter(100 * value);
    s.residual(0.7, x.get(), rate.get(), to.get());
    core::check(VecAXPY(to.get(), -1, from.get()));
    core::check(VecScale(to.get(), 1 / (99 * value)));
    EXPECT_LE(relative(by, to), 1e-11) << "rounding of forces that do not vary";
  }
}

// Solvers know the derivatives of a film from its start: its liner may not become damped on the way, and a value that a
// film refuses leaves everything as it was.
TEST(Parameters, AValueThatAFilmRefusesChangesNothing) {
  system::Machine machine = whole_machine();
  film::as<film::CompliantFinite>(machine.bearings[1].film).liner_damping = 0;
  system::Varying varying = along(machine, "bearings.B2.film.liner_damping", 0);
  varying.magnitude = 1e-4;
  system::RotorSystem s(MPI_COMM_WORLD, varying, speed);
  const core::Vector x = state(s), rate = rates(x, 1e-3), before = core::duplicate(x.get()),
                     after = core::duplicate(x.get());
  s.residual(0.7, x.get(), rate.get(), before.get());
  EXPECT_THROW(s.set_parameter(1e-4), core::DomainError);
  EXPECT_EQ(s.parameter(), 0);
  s.residual(0.7, x.get(), rate.get(), after.get());
  EXPECT_EQ(relative(after, before), 0);
  EXPECT_THROW(s.parameter_derivative(0.7, x.get(), rate.get(), after.get()), core::DomainError);
}

// A damping of zero may grow and not fall.
TEST(Parameters, AtTheEndOfItsRangeTheDifferenceIsOneSided) {
  system::Machine machine = reduced_machine();
  machine.bearings[0].pedestal->damping[1] = 0;
  system::Varying varying = along(machine, "bearings.B1.pedestal.damping.2", 0);
  varying.magnitude = 1e4;
  system::RotorSystem s(MPI_COMM_WORLD, varying, speed);
  const core::Vector x = state(s), rate = rates(x, 1e-3), by = core::duplicate(x.get());
  s.parameter_derivative(0.7, x.get(), rate.get(), by.get());
  const auto whole = s.gather(x.get()), slope = s.gather(by.get());
  const auto row = static_cast<std::size_t>(2 * s.pedestal(0, 1));
  for (std::size_t k = 0; k < slope.size(); ++k) EXPECT_EQ(slope[k], k == row ? whole[row + 1] : 0.0) << k;
}

// Blocks that were made at one value give F and dF/dp at another.
TEST_P(Parameter, BlocksFollow) {
  const system::Machine machine = GetParam()();
  for (const std::string& path : continuable_paths(machine)) {
    SCOPED_TRACE(path);
    const double value = value_of(machine, path);
    system::RotorSystem s(MPI_COMM_SELF, along(machine, path, 0.97 * value), speed);
    (void)s.structure()->l0();
    s.set_parameter(1.03 * value);
    const core::Vector x = state(s), rate = rates(x, 1e-3), f = core::duplicate(x.get()), df = core::duplicate(x.get());
    s.residual(0.7, x.get(), rate.get(), f.get());
    s.parameter_derivative(0.7, x.get(), rate.get(), df.get());
    const auto vector = [&s](const core::Vector& v) {
      const std::vector<double> all = s.gather(v.get());
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(all.data(), s.size()));
    };
    problem::BlockStructure& blocks = *s.structure();
    const Eigen::VectorXd at = vector(x), moving = vector(rate), wanted = vector(df);
    problem::Films films;
    blocks.films(blocks.c() * at.head(blocks.size()), at.data() + blocks.size(), moving.data() + blocks.size(), true,
                 films);
    Eigen::VectorXd found;
    blocks.parameter_derivative(0.7, at, moving, films, found);
    EXPECT_LE((found - wanted).norm(), 1e-14 * wanted.norm());
    const Eigen::Index n = blocks.size();
    Eigen::VectorXd load, sum(at.size());
    blocks.load(0.7, load);
    sum << blocks.l1() * moving.head(n) + blocks.l0() * at.head(n) - load - blocks.b() * films.forces, films.residual;
    EXPECT_LE((sum - vector(f)).norm(), 1e-12 * vector(f).norm());
  }
}

TEST_P(Parameter, MovedIsAsMadeThere) {
  const system::Machine machine = GetParam()();
  std::vector<std::string> idle;
  system::RotorSystem start(MPI_COMM_WORLD, system::train_of(machine), speed);
  const core::Vector x = state(start), rate = rates(x, 1e-3);
  for (const std::string& path : continuable_paths(machine)) {
    SCOPED_TRACE(path);
    const double value = value_of(machine, path);
    system::RotorSystem moved(MPI_COMM_WORLD, along(machine, path, 0.97 * value), speed);
    const core::Matrix j = moved.make_jacobian();
    const auto before = answers(moved, j.get(), x.get(), rate.get());
    moved.set_parameter(1.03 * value);
    system::RotorSystem made(MPI_COMM_WORLD, along(machine, path, 1.03 * value), speed);
    const core::Matrix other = made.make_jacobian();
    const auto there = answers(moved, j.get(), x.get(), rate.get()),
               wanted = answers(made, other.get(), x.get(), rate.get());
    // Films whose temperatures or pressures of gas are iterated have them within rounding, which dF/dp divides by its
    // step of 1e-5.
    const bool iterated =
        GetParam() == rigid_machine ||
        (GetParam() == reduced_machine && (path.starts_with("bearings.B4.") || path.starts_with("lubricants.")));
    double change = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      EXPECT_LE(relative(there[k], wanted[k]), iterated && k == 2 ? 1e-8 : 1e-13) << k;
      change = std::max(change, relative(before[k], wanted[k]));
    }
    if (change <= 1e-12) idle.push_back(path);
  }
  // Laminar films do not know how heavy their oil is, and without states none is compressible.
  std::vector<std::string> expected{"lubricants.oil.density"};
  if (GetParam() != reduced_machine) expected.push_back("bearings.B2.lubricant.density");
  if (GetParam() == reduced_machine)  // nor do bearings feel gravity along the shaft
    expected = {"gravity.3", "bearings.B1.film.bulk_modulus", "bearings.B2.film.bulk_modulus"};
  EXPECT_EQ(idle, expected);
}

TEST_P(Parameter, DerivativePassesTheTaylorTest) {
  const system::Machine machine = GetParam()();
  for (const std::string& path : continuable_paths(machine)) {
    SCOPED_TRACE(path);
    system::RotorSystem s(MPI_COMM_SELF, along(machine, path, value_of(machine, path)), speed);
    const core::Vector x = state(s), rate = rates(x, 1e-3);
    const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GE(r.parameter_order, 1.9);
  }
}
