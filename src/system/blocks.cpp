#include "blocks.hpp"

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::system {
namespace {

using core::check;

// Adds the entries of m [N x N] at (2 i, 2 j + rate).
void scatter(Mat m, PetscInt rate, Eigen::MatrixXd& out) {
  PetscInt rows = 0;
  check(MatGetSize(m, &rows, nullptr));
  for (PetscInt i = 0; i < rows; ++i) {
    PetscInt k = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &k, &columns, &values));
    for (PetscInt e = 0; e < k; ++e) out(2 * i, 2 * columns[e] + rate) += values[e];
    check(MatRestoreRow(m, i, &k, &columns, &values));
  }
}

}  // namespace

RotorSystem::Blocks::Blocks(RotorSystem& system) : system_(system) {
  const Eigen::Index n = system.size(), bearings = system.n_bearings();
  l1_ = l0_at_rest_ = gyroscopic_ = Eigen::MatrixXd::Zero(n, n);
  scatter(system.mass_.get(), 1, l1_);
  scatter(system.stiffness_.get(), 0, l0_at_rest_);
  scatter(system.damping_.get(), 1, l0_at_rest_);
  scatter(system.gyroscopic_.get(), 1, gyroscopic_);
  for (Eigen::Index i = 0; i < n / 2; ++i) {
    l1_(2 * i + 1, 2 * i) = 1;
    l0_at_rest_(2 * i + 1, 2 * i + 1) = -1;
  }
  b_ = Eigen::MatrixXd::Zero(n, 2 * bearings);
  c_ = Eigen::MatrixXd::Zero(4 * bearings, n);
  for (int i = 0; i < bearings; ++i)
    for (int d = 0; d < 2; ++d) {
      const PetscInt j = system.journal(i, d), p = system.pedestal(i, d);
      b_(2 * j, 2 * i + d) = 1;
      c_(4 * i + d, 2 * j) = 1;
      c_(4 * i + 2 + d, 2 * j + 1) = 1;
      if (p < 0) continue;
      b_(2 * p, 2 * i + d) = -1;
      c_(4 * i + d, 2 * p) = -1;
      c_(4 * i + 2 + d, 2 * p + 1) = -1;
    }
}

const Eigen::MatrixXd& RotorSystem::Blocks::l0() {
  if (l0_speed_ != system_.speed_) {
    l0_speed_ = system_.speed_;
    l0_ = l0_at_rest_ + l0_speed_ * gyroscopic_;
  }
  return l0_;
}

const Eigen::MatrixXd& RotorSystem::Blocks::dl0() {
  core::require(system_.parameter_is_speed(), "structured derivatives are those in the speed");
  return gyroscopic_;
}

void RotorSystem::Blocks::load(double angle, Eigen::VectorXd& load, Eigen::VectorXd* d_load) {
  const double omega = system_.forcing_ ? system_.speed_ : 0.0, c = std::cos(angle), s = std::sin(angle);
  load.setZero(size());
  if (d_load) d_load->setZero(size());
  for (Eigen::Index i = 0; i < size() / 2; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double u = c * system_.unbalance_c_[k] + s * system_.unbalance_s_[k];
    load(2 * i) = system_.load_[k] + omega * omega * u;
    if (d_load) (*d_load)(2 * i) = 2 * omega * u;
  }
}

void RotorSystem::Blocks::forces(const Eigen::VectorXd& inputs, Eigen::VectorXd& f, Eigen::MatrixXd* d_inputs,
                                 Eigen::VectorXd* d_parameter) {
  const int bearings = system_.n_bearings();
  f.resize(2 * bearings);
  if (d_inputs) d_inputs->setZero(2 * bearings, 4 * bearings);
  if (d_parameter) d_parameter->resize(2 * bearings);
  const bool tangents = d_inputs || d_parameter;
  film::Motion motion;
  film::Response response;
  motion.speed = system_.speed_;
  for (int i = 0; i < bearings; ++i) {
    for (int d = 0; d < 2; ++d) {
      motion.position[static_cast<std::size_t>(d)] = inputs(4 * i + d);
      motion.velocity[static_cast<std::size_t>(d)] = inputs(4 * i + 2 + d);
    }
    motion.position[1] -= system_.train_.supports[static_cast<std::size_t>(i)].elevation;
    try {
      system_.bearings_[static_cast<std::size_t>(i)].film->evaluate(
          motion, tangents ? film::Need::tangents : film::Need::force, response);
    } catch (const core::DomainError& e) {
      throw core::DomainError("bearing " + std::to_string(i + 1) + ": " + e.what());
    }
    for (int d = 0; d < 2; ++d) {
      const auto k = static_cast<std::size_t>(d);
      f(2 * i + d) = response.force[k];
      for (int e = 0; e < 2 && d_inputs; ++e) {
        (*d_inputs)(2 * i + d, 4 * i + e) = response.d_position[k][static_cast<std::size_t>(e)];
        (*d_inputs)(2 * i + d, 4 * i + 2 + e) = response.d_velocity[k][static_cast<std::size_t>(e)];
      }
      if (d_parameter) (*d_parameter)(2 * i + d) = response.d_speed[k];
    }
  }
}

}  // namespace whirl::system
