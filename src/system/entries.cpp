// The Jacobian entry by entry: what hub and films add to it.

#include "film_part.hpp"
#include "rotor_part.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;

template <class Entries>
void RotorSystem::list_films(Entries& out, bool values, double alpha, double sigma) const {
  static const film::Response none;
  for (const Bearing& b : bearings_) {
    const film::Response& r = values ? b.part->journal() : none;
    const std::vector<PortEnds>& ports = b.part->ports();
    for (std::size_t d = 0; d < ports.size(); ++d)
      for (const auto& [row, to] : ports[d]) {
        if (!hub_->owns(row)) continue;
        for (std::size_t e = 0; e < ports.size(); ++e)
          for (const auto& [column, side] : ports[e]) {
            out.add(2 * row, 2 * column, -alpha * to * side * r.d_position[d][e]);
            out.add(2 * row, 2 * column + 1, -alpha * to * side * r.d_velocity[d][e]);
          }
      }
    b.part->add(out, values, alpha, sigma);
  }
}

void RotorSystem::add_films(Mat j, bool values, double alpha, double sigma) {
  film_entries_.begin(j);
  list_films(film_entries_, values, alpha, sigma);
  film_entries_.end();
}

// All states of the hub come before those of films, so that its matrices by themselves number them as the system does.
void RotorSystem::list_hub() {
  std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(hub_->rows(), 1)), 0);
  hub_->count_entries(count);
  for (PetscInt& c : count) c = std::min(c, 2 * n_);
  core::Matrix m[3];
  for (int k = 0; k < 3; ++k) {
    m[k] = core::make_matrix(comm_, hub_->rows(), count);
    hub_->add(m[k].get(), k == 0 ? 1 : 0, k == 1 ? 1 : 0, k == 2 ? 1 : 0);
    check(MatAssemblyBegin(m[k].get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m[k].get(), MAT_FINAL_ASSEMBLY));
  }
  for (PetscInt i = 2 * hub_->begin(); i < 2 * hub_->end(); ++i) {
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values[3];
    for (int k = 0; k < 3; ++k) check(MatGetRow(m[k].get(), i, &n, &columns, &values[k]));
    for (PetscInt e = 0; e < n; ++e) hub_entries_.push_back({i, columns[e], values[0][e], values[1][e], values[2][e]});
    for (int k = 0; k < 3; ++k) check(MatRestoreRow(m[k].get(), i, &n, &columns, &values[k]));
  }
}

bool RotorSystem::entries(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma, problem::Entries& out) {
  if (n_own_ == 0) return false;
  prepare();
  evaluate_films(x, xdot, film::Need::tangents);
  int listed = hub_->rows() == 0 || !hub_entries_.empty();
  MPI_Allreduce(MPI_IN_PLACE, &listed, 1, MPI_INT, MPI_LAND, comm_);
  if (!listed) list_hub();
  out.begin();
  for (const HubEntry& e : hub_entries_)
    out.add(e.row, e.column, alpha * (e.at_rest + speed_ * e.gyroscopic) + sigma * e.rates);
  list_films(out, true, alpha, sigma);
  return true;
}

}  // namespace whirl::system
