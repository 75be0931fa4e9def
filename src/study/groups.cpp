#include "groups.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "pieces.hpp"
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

namespace {

using Answers = std::vector<std::vector<double>>;
using Work = std::function<std::vector<double>(std::size_t)>;

// Of n items, the first that a group has.
std::size_t first_of(const Groups& groups, std::size_t n, std::size_t group) {
  return n * group / static_cast<std::size_t>(groups.count);
}

// The items from `begin` on of each group's run of `wanted`, `most` of them, into `all` on every rank.
void round(const Groups& groups, const std::vector<std::size_t>& wanted, std::size_t begin, std::size_t most,
           const Work& work, Answers& all) {
  const auto run = [&](std::size_t group, const std::function<void(std::size_t)>& visit) {
    const std::size_t from = first_of(groups, wanted.size(), group) + begin,
                      to = std::min(from + most, first_of(groups, wanted.size(), group + 1));
    for (std::size_t i = from; i < to; ++i) visit(wanted[i]);
  };
  const auto own = [&] {
    run(static_cast<std::size_t>(groups.index), [&](std::size_t item) { all[item] = work(item); });
  };
  if (groups.count == 1) return own();
  core::agree(groups.world, own);
  for (int group = 0; group < groups.count; ++group)
    run(static_cast<std::size_t>(group), [&](std::size_t item) {
      auto length = static_cast<unsigned long>(all[item].size());
      MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, group, groups.world);
      all[item].resize(length);
      MPI_Bcast(all[item].data(), static_cast<int>(length), MPI_DOUBLE, group, groups.world);
    });
}

}  // namespace

Answers distribute(const Groups& groups, std::size_t n, const Work& work) {
  Answers all(n);
  std::vector<std::size_t> wanted(n);
  std::iota(wanted.begin(), wanted.end(), 0);
  round(groups, wanted, 0, n, work, all);
  return all;
}

Answers distribute(const Groups& groups, std::size_t n, const Work& answer, Pieces& kept, const std::string& name,
                   const Trail& trail) {
  // The trail stands before the answer, behind its own length.
  const Work work = [&](std::size_t item) {
    const std::vector<double> own = answer(item);
    std::vector<double> both = trail.leave();
    both.insert(both.begin(), static_cast<double>(both.size()));
    both.insert(both.end(), own.begin(), own.end());
    return both;
  };
  const auto split = [](const std::vector<double>& both) {
    return both.begin() + 1 + static_cast<std::ptrdiff_t>(both.front());
  };
  const auto piece = [&](std::size_t item) { return fmt::format("{} {}", name, item + 1); };
  const auto known = [] { return std::vector<double>(); };
  Answers all(n);
  std::vector<std::size_t> wanted;
  for (std::size_t item = 0; item < n; ++item)
    if (kept.known(piece(item))) {
      all[item] = kept.numbers(piece(item), known);
      trail.take({all[item].cbegin() + 1, split(all[item])});
    } else
      wanted.push_back(item);
  const std::size_t longest =
      (wanted.size() + static_cast<std::size_t>(groups.count) - 1) / static_cast<std::size_t>(groups.count);
  unsigned long most = 1;
  for (std::size_t begin = 0, size = 1; begin < longest; begin += size) {
    size = most;
    const auto started = std::chrono::steady_clock::now();
    round(groups, wanted, begin, size, work, all);
    for (std::size_t group = 0; group < static_cast<std::size_t>(groups.count); ++group) {
      const std::size_t from = first_of(groups, wanted.size(), group) + begin,
                        to = std::min(from + size, first_of(groups, wanted.size(), group + 1));
      for (std::size_t i = from; i < to; ++i) kept.keep(piece(wanted[i]), all[wanted[i]]);
    }
    kept.save_if_due();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    most = std::clamp<unsigned long>(
        static_cast<unsigned long>(0.25 * static_cast<double>(size) / std::max(seconds, 1e-6)), 1, 2 * size);
    MPI_Bcast(&most, 1, MPI_UNSIGNED_LONG, 0, groups.world);
  }
  for (auto& both : all) both.erase(both.cbegin(), split(both));
  return all;
}

}  // namespace whirl::study
