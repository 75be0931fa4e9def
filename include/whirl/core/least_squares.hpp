#pragma once

#include <Eigen/Core>

namespace whirl::core {

/// The x of least |a x - b|, column by column, by QR with exchanged columns; of those that are as good, the shortest
/// (LAPACK's gelsy; Golub and Van Loan 2013, section 5.5.3).
[[nodiscard]] Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::MatrixXcd least_squares(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

}  // namespace whirl::core
