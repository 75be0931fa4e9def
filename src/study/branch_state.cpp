#include "branch_state.hpp"

#include "study/cycle/cycle_record.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {

using core::check;

void fill(Vec v, const std::vector<double>& all) {
  PetscInt begin = 0, size = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  check(VecGetSize(v, &size));
  if (static_cast<std::size_t>(size) != all.size())
    throw core::Error("the checkpoint is of a problem of another size: compute the study again");
  const core::WriteArray a(v);
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = all[static_cast<std::size_t>(begin + i)];
}

void write_restart(io::Group& group, const solve::BranchPoint& point, Vec u, Vec tangent, double next_step) {
  write_point(group.child("point"), point);
  group.put("u", core::gather(u), "1", "unknowns, scaled");
  group.put("tangent", core::gather(tangent), "1", "unit tangent");
  group.set("next_step", next_step);
}

solve::Restart read_restart(const io::Group& group, Vec like) {
  solve::Restart r{core::duplicate(like), core::duplicate(like), group.real("next_step"),
                   read_point(group.group("point"))};
  fill(r.u.get(), group.reals("u"));
  fill(r.tangent.get(), group.reals("tangent"));
  return r;
}

}  // namespace whirl::study
