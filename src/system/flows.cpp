#include "whirl/system/flows.hpp"

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "whirl/core/petsc.hpp"

namespace whirl::system {

using core::check;

void describe(deck::Description<Lorenz>& d) {
  using O = Lorenz;
  d.add("sigma", &O::sigma, "1", deck::positive, "sigma, the Prandtl number").continuable();
  d.add("rho", &O::rho, "1", deck::any, "rho, the heating over that at which convection begins").continuable();
  d.add("beta", &O::beta, "1", deck::positive, "beta, by the width of the rolls").continuable();
}

void describe(deck::Description<Rossler>& d) {
  using O = Rossler;
  d.add("a", &O::a, "1", deck::any, "a, growth of the second state").continuable();
  d.add("b", &O::b, "1", deck::any, "b, inflow of the third state").continuable();
  d.add("c", &O::c, "1", deck::any, "c, decay of the third state").continuable();
}

void describe(deck::Description<Duffing>& d) {
  using O = Duffing;
  d.add("damping", &O::damping, "1", deck::any, "coefficient of the velocity").continuable();
  d.add("linear", &O::linear, "1", deck::any, "linear stiffness; below zero there are two wells").continuable();
  d.add("cubic", &O::cubic, "1", deck::any, "cubic stiffness").continuable();
  d.add("amplitude", &O::amplitude, "1", deck::any, "of the force, 0-peak").continuable();
  d.add("frequency", &O::frequency, "rad/s", deck::positive, "of the force; the speed of its motions").continuable();
}

namespace {

// What a flow is: its rates f at a state and the phase of the forcing, df/dx, and the rest.
template <class Options>
struct Flow;

template <>
struct Flow<Lorenz> {
  static constexpr int n = 3, first = 0, second = 2;  // states that are shown
  static constexpr const char* text = "states x and z (as y) of Lorenz' equations";
  using State = Eigen::Matrix<double, n, 1>;
  static State rates(const Lorenz& o, const State& x, double /*phase*/, bool /*forced*/) {
    return {o.sigma * (x(1) - x(0)), x(0) * (o.rho - x(2)) - x(1), x(0) * x(1) - o.beta * x(2)};
  }
  static Eigen::Matrix3d slopes(const Lorenz& o, const State& x) {
    Eigen::Matrix3d j;
    j << -o.sigma, o.sigma, 0, o.rho - x(2), -1, -x(0), x(1), x(0), -o.beta;
    return j;
  }
  static State rest(const Lorenz& o) {
    const double side = o.rho > 1 ? std::sqrt(o.beta * (o.rho - 1)) : 0;
    return {side, side, o.rho > 1 ? o.rho - 1 : 0};
  }
  static double speed(const Lorenz& /*o*/) { return 1; }
};

template <>
struct Flow<Rossler> {
  static constexpr int n = 3, first = 0, second = 1;
  static constexpr const char* text = "states x and y of Rossler's equations";
  using State = Eigen::Matrix<double, n, 1>;
  static State rates(const Rossler& o, const State& x, double /*phase*/, bool /*forced*/) {
    return {-x(1) - x(2), x(0) + o.a * x(1), o.b + x(2) * (x(0) - o.c)};
  }
  static Eigen::Matrix3d slopes(const Rossler& o, const State& x) {
    Eigen::Matrix3d j;
    j << 0, -1, -1, 1, o.a, 0, x(2), 0, x(0) - o.c;
    return j;
  }
  // The equilibrium within the spiral.
  static State rest(const Rossler& o) {
    const double root = o.c * o.c - 4 * o.a * o.b;
    const double x = root > 0 ? 0.5 * (o.c - std::sqrt(root)) : 0, z = o.a != 0 ? x / o.a : 0;
    return {x, -z, z};
  }
  static double speed(const Rossler& /*o*/) { return 1; }
};

template <>
struct Flow<Duffing> {
  static constexpr int n = 2, first = 0, second = 1;
  static constexpr const char* text = "displacement (as x) and velocity (as y) of Duffing's oscillator";
  using State = Eigen::Matrix<double, n, 1>;
  static State rates(const Duffing& o, const State& x, double phase, bool forced) {
    const double force = forced ? o.amplitude * std::cos(phase) : 0;
    return {x(1), force - o.damping * x(1) - o.linear * x(0) - o.cubic * x(0) * x(0) * x(0)};
  }
  static Eigen::Matrix2d slopes(const Duffing& o, const State& x) {
    Eigen::Matrix2d j;
    j << 0, 1, -o.linear - 3 * o.cubic * x(0) * x(0), -o.damping;
    return j;
  }
  static State rest(const Duffing& o) { return {o.linear < 0 && o.cubic > 0 ? std::sqrt(-o.linear / o.cubic) : 0, 0}; }
  static double speed(const Duffing& o) { return o.frequency; }
};

template <class Options>
class FlowSystem final : public Plant {
  using F = Flow<Options>;
  using State = typename F::State;

public:
  FlowSystem(MPI_Comm comm, OptionsAlong<Options> along)
      : comm_(comm),
        along_(std::move(along)),
        parameter_(along_.value),
        o_(along_.at(parameter_)),
        by_speed_(follows_speed(parameter_) && follows_speed(parameter_ + 1e-5 * along_.magnitude)),
        local_(core::rank_of(comm) == 0 ? F::n : 0),
        layout_(core::make_vector(comm, local_, F::n)) {}

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return F::n; }
  [[nodiscard]] PetscInt local_size() const override { return local_; }
  [[nodiscard]] double parameter() const override { return parameter_; }
  void set_parameter(double p) override {
    if (p == parameter_) return;
    o_ = along_.at(p);
    parameter_ = p;
  }
  [[nodiscard]] double speed() const override { return F::speed(o_); }
  [[nodiscard]] bool parameter_is_speed() const override { return by_speed_; }
  void set_forcing(bool on) override { forced_ = on; }
  [[nodiscard]] bool forced() const override { return std::is_same_v<Options, Duffing>; }

  void residual(double angle, Vec x, Vec xdot, Vec f) override { residual(o_, angle, x, xdot, f); }
  [[nodiscard]] core::Matrix make_jacobian() override {
    core::Matrix m;
    check(MatCreateAIJ(comm_, local_, local_, F::n, F::n, F::n, nullptr, 0, nullptr, m.put()));
    return m;
  }
  void jacobian(double /*angle*/, Vec x, Vec /*xdot*/, double alpha, double sigma, Mat j) override {
    if (local_ > 0) {
      const core::ReadArray z(x);
      const auto slopes = F::slopes(o_, state(z));
      for (int r = 0; r < F::n; ++r)
        for (int c = 0; c < F::n; ++c)
          check(MatSetValue(j, r, c, (r == c ? sigma : 0) - alpha * slopes(r, c), INSERT_VALUES));
    }
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  }
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) override {
    const double step = 1e-5 * along_.magnitude;
    const core::Vector minus = core::duplicate(f);
    residual(along_.at(parameter_ + step), angle, x, xdot, f);
    residual(along_.at(parameter_ - step), angle, x, xdot, minus.get());
    check(VecAXPBY(f, -1 / (2 * step), 1 / (2 * step), minus.get()));
  }
  void scales(Vec state, Vec residual) override {
    check(VecSet(state, 1));
    check(VecSet(residual, 1));
  }

  [[nodiscard]] ShownPlaces places() const override { return {{"flow"}, {0.0}, "1", "1/s", F::text}; }
  [[nodiscard]] std::vector<PlaceState> shown(const double* x) const override {
    const State s = Eigen::Map<const State>(x), rate = F::rates(o_, s, 0, false);
    return {{{s(F::first), s(F::second)}, {rate(F::first), rate(F::second)}}};
  }
  [[nodiscard]] core::Vector guess() override {
    core::Vector x = core::duplicate(layout_.get());
    const core::WriteArray a(x.get());
    const State rest = F::rest(o_);
    for (PetscInt k = 0; k < local_; ++k) a[k] = rest(k);
    return x;
  }
  void displace(Vec x, const std::array<double, 2>& offset) override {
    const core::WriteArray a(x);
    if (local_ == 0) return;
    a[F::first] += offset[0];
    a[F::second] += offset[1];
  }
  [[nodiscard]] bool constant_rates() const override { return true; }

private:
  [[nodiscard]] bool follows_speed(double p) const { return F::speed(along_.at(p)) == p; }
  template <class Array>
  [[nodiscard]] static State state(const Array& z) {
    State s;
    for (int k = 0; k < F::n; ++k) s(k) = z[k];
    return s;
  }
  void residual(const Options& o, double angle, Vec x, Vec xdot, Vec f) {
    const core::ReadArray z(x), rates(xdot);
    const core::WriteArray out(f);
    if (local_ == 0) return;
    const State wanted = F::rates(o, state(z), angle, forced_);
    for (int k = 0; k < F::n; ++k) out[k] = rates[k] - wanted(k);
  }

  MPI_Comm comm_;
  OptionsAlong<Options> along_;
  double parameter_;
  Options o_;
  bool by_speed_;  // the parameter is the frequency of the force
  PetscInt local_;
  core::Vector layout_;
  bool forced_ = true;
};

}  // namespace

std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Lorenz> along) {
  return std::make_unique<FlowSystem<Lorenz>>(comm, std::move(along));
}
std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Rossler> along) {
  return std::make_unique<FlowSystem<Rossler>>(comm, std::move(along));
}
std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Duffing> along) {
  return std::make_unique<FlowSystem<Duffing>>(comm, std::move(along));
}

}  // namespace whirl::system
