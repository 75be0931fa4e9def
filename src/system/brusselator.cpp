#include "whirl/system/brusselator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/core/count.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::system {

using core::check;

void describe(deck::Description<Brusselator>& d) {
  using O = Brusselator;
  d.add("cells", &O::cells, deck::in(2, 1e8), "equal intervals along the tube");
  d.add("length", &O::length, "1", deck::positive, "L, length of the tube").continuable();
  d.add("a", &O::a, "1", deck::positive, "A, inflow of the first substance").continuable();
  d.add("b", &O::b, "1", deck::positive, "B, by which the first substance turns into the second one").continuable();
  d.add("diffusion_u", &O::diffusion_u, "1", deck::positive, "D_u, diffusion of the first substance").continuable();
  d.add("diffusion_v", &O::diffusion_v, "1", deck::positive, "D_v, diffusion of the second one").continuable();
  d.add("amplitude", &O::amplitude, "1", deck::at_least(0),
        "of the force on the first substance, 0-peak; above zero there are forced cycles")
      .continuable();
  d.add("frequency", &O::frequency, "rad/s", deck::positive, "of the force; the speed of its motions").continuable();
}

namespace {

class BrusselatorSystem final : public Plant {
public:
  BrusselatorSystem(MPI_Comm comm, OptionsAlong<Brusselator> along)
      : comm_(comm),
        along_(std::move(along)),
        parameter_(along_.value),
        o_(along_.at(parameter_)),
        by_speed_(follows_speed(parameter_) && follows_speed(parameter_ + 1e-5 * along_.magnitude)) {
    const PetscInt points = o_.cells - 1;
    const int rank = core::rank_of(comm), size = core::size_of(comm);
    n_ = 2 * points;
    begin_ = core::begin_of_share(points, rank, size);
    local_ = 2 * (core::begin_of_share(points, rank + 1, size) - begin_);
    layout_ = core::make_vector(comm, local_, n_);
    check(VecScatterCreateToAll(layout_.get(), scatter_.put(), whole_.put()));
  }

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return n_; }
  [[nodiscard]] PetscInt local_size() const override { return local_; }
  [[nodiscard]] double parameter() const override { return parameter_; }
  void set_parameter(double p) override {
    if (p == parameter_) return;
    o_ = along_.at(p);  // may refuse the value, and then nothing has changed
    parameter_ = p;
  }
  [[nodiscard]] double speed() const override { return o_.frequency; }
  [[nodiscard]] bool parameter_is_speed() const override { return by_speed_; }
  void set_forcing(bool on) override { forced_ = on; }
  [[nodiscard]] bool forced() const override { return o_.forced_at().has_value(); }

  void residual(double angle, Vec x, Vec xdot, Vec f) override { residual(o_, angle, x, xdot, f); }
  [[nodiscard]] core::Matrix make_jacobian() override {
    core::Matrix m;
    check(MatCreateAIJ(comm_, local_, local_, n_, n_, 4, nullptr, 2, nullptr, m.put()));
    return m;
  }
  void jacobian(double /*angle*/, Vec x, Vec /*xdot*/, double alpha, double sigma, Mat j) override {
    gather_whole(x);
    const core::ReadArray z(whole_.get());
    const auto set = [&](PetscInt row, PetscInt column, double value) {
      if (column >= 0 && column < n_) check(MatSetValue(j, row, column, value, INSERT_VALUES));
    };
    const double du = exchange(o_, o_.diffusion_u), dv = exchange(o_, o_.diffusion_v);
    for (PetscInt i = begin_; i < begin_ + local_ / 2; ++i) {
      const PetscInt r = 2 * i;
      const double u = z[r], v = z[r + 1];
      set(r, r, sigma - alpha * (-2 * du + 2 * u * v - (o_.b + 1)));
      set(r, r + 1, -alpha * u * u);
      set(r + 1, r, -alpha * (-2 * u * v + o_.b));
      set(r + 1, r + 1, sigma - alpha * (-2 * dv - u * u));
      for (const PetscInt o : {-2, 2}) {
        set(r, r + o, -alpha * du);
        set(r + 1, r + 1 + o, -alpha * dv);
      }
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

  [[nodiscard]] ShownPlaces places() const override {
    return {{"middle"}, {0.0}, "1", "1/s", "concentrations u (as x) and v (as y) in the middle of the tube"};
  }
  [[nodiscard]] std::vector<PlaceState> shown(const double* x) const override {
    const std::array<double, 2> rate = production(o_, x, middle());
    return {{{x[2 * middle()], x[2 * middle() + 1]}, rate}};
  }
  [[nodiscard]] core::Vector guess() override {
    core::Vector x = core::duplicate(layout_.get());
    const core::WriteArray a(x.get());
    for (PetscInt k = 0; k < local_; ++k) a[k] = k % 2 == 0 ? o_.a : o_.b / o_.a;
    return x;
  }
  // Along the first mode of the tube, per concentration.
  void displace(Vec x, const std::array<double, 2>& offset) override {
    const core::WriteArray a(x);
    for (PetscInt k = 0; k < local_; ++k) {
      const auto place = static_cast<double>(begin_ + k / 2 + 1);
      a[k] += offset[static_cast<std::size_t>(k % 2)] * std::sin(std::numbers::pi * place / o_.cells);
    }
  }
  [[nodiscard]] bool constant_rates() const override { return true; }

private:
  [[nodiscard]] bool follows_speed(double p) const { return along_.at(p).frequency == p; }
  // Diffusion between neighbouring points, D/(L dz)^2.
  [[nodiscard]] static double exchange(const Brusselator& o, double diffusion) {
    return diffusion * o.cells * o.cells / (o.length * o.length);
  }
  [[nodiscard]] PetscInt middle() const { return o_.cells / 2 - 1; }

  // (du/dt, dv/dt) at inner point i of a state z held as a whole.
  template <class Array>
  [[nodiscard]] static std::array<double, 2> production(const Brusselator& o, const Array& z, PetscInt i) {
    const PetscInt r = 2 * i;
    const bool first = i == 0, last = i == o.cells - 2;
    const double u = z[r], v = z[r + 1];
    const double u_zz = (first ? o.a : z[r - 2]) - 2 * u + (last ? o.a : z[r + 2]),
                 v_zz = (first ? o.b / o.a : z[r - 1]) - 2 * v + (last ? o.b / o.a : z[r + 3]);
    return {exchange(o, o.diffusion_u) * u_zz + u * u * v - (o.b + 1) * u + o.a,
            exchange(o, o.diffusion_v) * v_zz - u * u * v + o.b * u};
  }

  void residual(const Brusselator& o, double angle, Vec x, Vec xdot, Vec f) {
    gather_whole(x);
    const double force = forced_ ? o.amplitude * std::cos(angle) : 0;
    const core::ReadArray z(whole_.get()), rates(xdot);
    const core::WriteArray out(f);
    for (PetscInt k = 0; k < local_; k += 2) {
      const auto [u, v] = production(o, z, begin_ + k / 2);
      out[k] = rates[k] - u - force;
      out[k + 1] = rates[k + 1] - v;
    }
  }
  void gather_whole(Vec x) {
    check(VecScatterBegin(scatter_.get(), x, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter_.get(), x, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
  }

  MPI_Comm comm_;
  OptionsAlong<Brusselator> along_;
  double parameter_;
  Brusselator o_;
  bool by_speed_;  // the parameter is the frequency of the force
  bool forced_ = true;
  PetscInt n_ = 0, begin_ = 0, local_ = 0;  // states in all; first point and states on this rank
  core::Vector layout_, whole_;
  core::Scatter scatter_;
};

}  // namespace

std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Brusselator> along) {
  return std::make_unique<BrusselatorSystem>(comm, std::move(along));
}

}  // namespace whirl::system
