#include "whirl/rotor/modal_coupling.hpp"

#include <fmt/core.h>

#include "planar.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/symmetric.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

GyroscopicCoupling gyroscopic_coupling(const Options& options, const std::vector<int>& nodes, double support) {
  validate(options);
  const Planar planar = assemble_planar(PETSC_COMM_SELF, options);
  Eigen::MatrixXd k = core::dense(planar.stiffness.get());
  for (const int node : nodes) {
    if (node < 1 || node > n_nodes(options))
      throw core::InputError(fmt::format("rotor: node {} is not in 1..{}", node, n_nodes(options)));
    k(2 * (node - 1), 2 * (node - 1)) += support;
  }
  const auto rest = core::symmetric_pairs(std::move(k), core::dense(planar.mass.get()), "the mass of the shaft");
  const Eigen::MatrixXd& v = rest.vectors;
  return {rest.values.cwiseMax(0).cwiseSqrt(), v.transpose() * core::dense(planar.gyroscopic.get()) * v};
}

}  // namespace whirl::rotor
