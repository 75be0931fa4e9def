#include "state_rows.hpp"

#include <algorithm>

namespace whirl::study {

StateRows::StateRows(system::Plant& plant) : plant_(plant) {
  if (core::size_of(plant.comm()) > 1) x_ = core::make_vector(plant.comm(), plant.local_size(), PETSC_DETERMINE);
}

Vec StateRows::vector(const Eigen::VectorXd& rows) {
  core::require(rows.size() == plant_.local_size(), "of a state each rank has its rows");
  if (!x_) x_ = core::make_vector(plant_.comm(), plant_.local_size(), PETSC_DETERMINE);
  const core::WriteArray a(x_.get());
  std::copy_n(rows.data(), rows.size(), a.data());
  return x_.get();
}

// One rank needs no vector.
std::vector<system::PlaceState> StateRows::shown(const Eigen::VectorXd& rows) {
  return x_ ? plant_.shown_at(vector(rows)) : plant_.shown(rows.data());
}

std::vector<double> StateRows::film_thickness(const Eigen::VectorXd& rows) {
  return x_ ? plant_.observe(vector(rows)).film_thickness : plant_.film_thickness(rows.data());
}

solve::Cycle as_cycle(const system::Plant& plant, Vec x, double parameter, double period) {
  const std::vector<double> whole = plant.gather(x);
  const auto n = static_cast<Eigen::Index>(whole.size());
  return {{0, 1}, Eigen::Map<const Eigen::VectorXd>(whole.data(), n), period, parameter};
}

core::Vector state_in(const system::Plant& plant, const solve::Cycle& equilibrium) {
  core::Vector x = core::make_vector(plant.comm(), plant.local_size(), PETSC_DETERMINE);
  core::fill(x.get(), {equilibrium.x.data(), equilibrium.x.data() + equilibrium.x.rows()});
  return x;
}

std::vector<double> whole_of(MPI_Comm comm, const Eigen::VectorXd& rows) {
  const core::Vector x = core::make_vector(comm, static_cast<PetscInt>(rows.size()), PETSC_DETERMINE);
  {
    const core::WriteArray a(x.get());
    std::copy_n(rows.data(), rows.size(), a.data());
  }
  return core::gather(x.get());
}

Eigen::VectorXd rows_of(Vec x) {
  const core::ReadArray a(x);
  return Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

double sum_over(MPI_Comm comm, double here) {
  MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_SUM, comm);
  return here;
}

}  // namespace whirl::study
