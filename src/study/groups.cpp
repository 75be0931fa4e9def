#include "groups.hpp"

#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::study {

Groups Groups::split(MPI_Comm world, const system::Machine& machine) {
  constexpr std::size_t freedoms_per_rank = 20000;
  Groups g;
  g.world = world;
  if (4 * (machine.rotor.segments.size() + 1) < freedoms_per_rank) {
    g.space = MPI_COMM_SELF;
    g.count = core::size_of(world);
    g.index = core::rank_of(world);
  } else {
    g.space = world;
  }
  return g;
}

MPI_Comm sharing_time(MPI_Comm comm, std::size_t intervals) {
  return intervals < static_cast<std::size_t>(core::size_of(comm)) ? MPI_COMM_SELF : comm;
}

std::vector<std::vector<double>> distribute(const Groups& groups, std::size_t n,
                                            const std::function<std::vector<double>(std::size_t)>& work) {
  std::vector<std::vector<double>> all(n);
  if (groups.count == 1) {
    for (std::size_t i = 0; i < n; ++i) all[i] = work(i);
    return all;
  }
  const auto count = static_cast<std::size_t>(groups.count), index = static_cast<std::size_t>(groups.index);
  const auto first = [&](std::size_t group) { return n * group / count; };
  core::agree(groups.world, [&] {
    for (std::size_t i = first(index); i < first(index + 1); ++i) all[i] = work(i);
  });
  for (std::size_t group = 0; group < count; ++group)
    for (std::size_t i = first(group); i < first(group + 1); ++i) {
      auto length = static_cast<unsigned long>(all[i].size());
      MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, static_cast<int>(group), groups.world);
      all[i].resize(length);
      MPI_Bcast(all[i].data(), static_cast<int>(length), MPI_DOUBLE, static_cast<int>(group), groups.world);
    }
  return all;
}

}  // namespace whirl::study
