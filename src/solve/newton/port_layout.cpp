#include <algorithm>

#include "solve/newton/port_matrix.hpp"
#include "solve/newton/stored.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/count.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// That hold a bit for each part; one where there are none.
std::size_t words_of(std::size_t parts) {
  return parts / 64 + 1;
}

std::vector<PetscInt> offsets_of(MPI_Comm comm, PetscInt local) {
  std::vector<PetscInt> all(static_cast<std::size_t>(core::size_of(comm)) + 1, 0);
  MPI_Allgather(&local, 1, MPIU_INT, all.data() + 1, 1, MPIU_INT, comm);
  for (std::size_t r = 1; r < all.size(); ++r) all[r] += all[r - 1];
  return all;
}

// By diagonals and along each. Most entries come like that already.
template <class Entry>
void sort_by_diagonals(std::vector<Entry>& all) {
  const auto diagonal = [](const Entry& e) { return e.column - e.row; };
  const auto earlier = [](const Entry& a, const Entry& b) { return a.row < b.row; };
  std::vector<PetscInt> diagonals;
  for (const Entry& e : all)
    if (diagonals.empty() || diagonals.back() != diagonal(e)) diagonals.push_back(diagonal(e));
  std::sort(diagonals.begin(), diagonals.end());
  diagonals.erase(std::unique(diagonals.begin(), diagonals.end()), diagonals.end());
  std::vector<std::size_t> begins(diagonals.size() + 1, 0);
  std::size_t at = 0;
  const auto place_of = [&](const Entry& e) {
    if (diagonals[at] != diagonal(e))
      at = static_cast<std::size_t>(std::lower_bound(diagonals.begin(), diagonals.end(), diagonal(e)) -
                                    diagonals.begin());
    return at;
  };
  for (const Entry& e : all) ++begins[place_of(e) + 1];
  for (std::size_t d = 0; d < diagonals.size(); ++d) begins[d + 1] += begins[d];
  std::vector<Entry> sorted(all.size());
  std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
  for (const Entry& e : all) sorted[next[place_of(e)]++] = e;
  for (std::size_t d = 0; d < diagonals.size(); ++d) {
    const auto from = sorted.begin() + static_cast<std::ptrdiff_t>(begins[d]),
               to = sorted.begin() + static_cast<std::ptrdiff_t>(begins[d + 1]);
    if (!std::is_sorted(from, to, earlier)) std::sort(from, to, earlier);
  }
  all = std::move(sorted);
}

}  // namespace

// All entries of this rank's rows: row and column are numbers among the parts (>= 0, the row counted on this rank) or
// in the hub (-1 - number).
struct PortLayout::Scan {
  struct Entry {
    PetscInt row, column, source;
  };
  std::vector<Entry> list;

  // Entries beside each other often have a row or a column in common, which is then looked up once.
  template <class NumberOf>
  void read(std::span<const problem::Entries::Place> places, const NumberOf& number_of) {
    list.reserve(places.size());
    for (const problem::Entries::Place& p : places)
      list.push_back({number_of(p.row, true), number_of(p.column, false), static_cast<PetscInt>(list.size())});
  }
  template <class NumberOf>
  void read(Mat m, PetscInt first_source, const std::vector<PetscInt>& rows, const NumberOf& number_of) {
    PetscInt n = 0;
    const PetscInt *begin = nullptr, *columns = nullptr;
    PetscBool done = PETSC_FALSE;
    check(MatGetRowIJ(m, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
    for (PetscInt i = 0; i < n; ++i)
      for (PetscInt k = begin[i]; k < begin[i + 1]; ++k)
        list.push_back({rows[static_cast<std::size_t>(i)], number_of(columns[k]), first_source + k});
    check(MatRestoreRowIJ(m, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  }
};

PetscInt PortLayout::first_of_hub() const {
  return hub_offsets_[static_cast<std::size_t>(core::rank_of(comm_))];
}

void PortLayout::number_rows(const std::vector<problem::Field>& fields) {
  const std::vector<problem::Field> parts = problem::parts_of(fields);
  std::vector<bool> taken(static_cast<std::size_t>(local_), false);
  PetscInt at = 0;
  for (std::size_t f = 1; f < parts.size(); ++f) {
    const PetscInt count = parts[f].end - parts[f].begin;
    std::fill(taken.begin() + parts[f].begin, taken.begin() + parts[f].end, true);
    if (!runs_.empty() && runs_.back().whole + runs_.back().count == parts[f].begin)
      runs_.back().count += count;
    else if (count > 0)
      runs_.push_back({parts[f].begin, at, count, true});
    part_ends_.push_back(at += count);
  }
  PetscInt hub = 0;
  for (PetscInt i = 0; i < local_; ++i) {
    if (taken[static_cast<std::size_t>(i)]) continue;
    if (!runs_.empty() && !runs_.back().part && runs_.back().whole + runs_.back().count == i)
      ++runs_.back().count;
    else
      runs_.push_back({i, hub, 1, false});
    ++hub;
  }
  part_offsets_ = offsets_of(comm_, at);
  all_part_ends_.resize(part_ends_.size() * static_cast<std::size_t>(core::size_of(comm_)));
  MPI_Allgather(part_ends_.data(), static_cast<int>(part_ends_.size()), MPIU_INT, all_part_ends_.data(),
                static_cast<int>(part_ends_.size()), MPIU_INT, comm_);
  hub_offsets_ = offsets_of(comm_, hub);
}

PortLayout::PortLayout(Mat a, const std::vector<problem::Field>& fields)
    : comm_(PetscObjectComm(reinterpret_cast<PetscObject>(a))) {
  check(MatGetLocalSize(a, &local_, nullptr));
  number_rows(fields);
  const Numbers all = numbers();
  const Stored stored(a);
  Scan scan;
  scan.read(stored.own, 0, all.rows, [&](PetscInt c) { return all.columns[static_cast<std::size_t>(c)]; });
  if (stored.others) {
    PetscInt count = 0;
    check(MatGetSize(stored.others, nullptr, &count));
    const std::vector<PetscInt> seen = all.seen({stored.columns, stored.columns + count});
    scan.read(stored.others, stored.entries(), all.rows, [&](PetscInt c) { return seen[static_cast<std::size_t>(c)]; });
  }
  place(scan);
}

PortLayout::PortLayout(MPI_Comm comm, PetscInt local, const std::vector<problem::Field>& fields,
                       std::span<const problem::Entries::Place> places)
    : comm_(comm), local_(local) {
  number_rows(fields);
  const Numbers all = numbers();
  PetscInt first = 0;
  check(VecGetOwnershipRange(all.all.get(), &first, nullptr));
  const auto here = [&](PetscInt k) { return k >= first && k < first + local_; };
  std::vector<PetscInt> others;
  for (const problem::Entries::Place& p : places)
    for (const PetscInt k : {p.row, p.column})
      if (!here(k) && (others.empty() || others.back() != k)) others.push_back(k);
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  const std::vector<PetscInt> seen = all.seen(others);
  std::size_t last = 0;
  Scan scan;
  scan.read(places, [&](PetscInt k, bool row) {
    if (here(k)) return (row ? all.rows : all.columns)[static_cast<std::size_t>(k - first)];
    if (last >= others.size() || others[last] != k)
      last = static_cast<std::size_t>(std::lower_bound(others.begin(), others.end(), k) - others.begin());
    core::require(!row || seen[last] < 0, "rows of parts on this rank");
    return seen[last];
  });
  place(scan);
}

PortLayout::Numbers PortLayout::numbers() const {
  const auto rank = static_cast<std::size_t>(core::rank_of(comm_));
  Numbers out;
  out.rows.resize(static_cast<std::size_t>(local_));
  out.columns.resize(out.rows.size());
  out.all = core::make_vector(comm_, local_, PETSC_DETERMINE);
  const core::WriteArray values(out.all.get());
  for (const Run& run : runs_)
    for (PetscInt i = 0; i < run.count; ++i) {
      const auto k = static_cast<std::size_t>(run.whole + i);
      out.rows[k] = run.part ? run.at + i : -1 - (hub_offsets_[rank] + run.at + i);
      out.columns[k] = run.part ? part_offsets_[rank] + run.at + i : out.rows[k];
      values[run.whole + i] = static_cast<double>(out.columns[k]);
    }
  return out;
}

std::vector<PetscInt> PortLayout::Numbers::seen(const std::vector<PetscInt>& in_matrix) const {
  const auto count = static_cast<PetscInt>(in_matrix.size());
  core::IndexSet from;
  check(ISCreateGeneral(PETSC_COMM_SELF, count, in_matrix.data(), PETSC_COPY_VALUES, from.put()));
  core::Vector other = core::make_vector(PETSC_COMM_SELF, count, PETSC_DETERMINE);
  core::Scatter scatter;
  check(VecScatterCreate(all.get(), from.get(), other.get(), nullptr, scatter.put()));
  check(VecScatterBegin(scatter.get(), all.get(), other.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(scatter.get(), all.get(), other.get(), INSERT_VALUES, SCATTER_FORWARD));
  const core::ReadArray number(other.get());
  std::vector<PetscInt> out;
  for (PetscInt k = 0; k < count; ++k) out.push_back(static_cast<PetscInt>(number[k]));
  return out;
}

void PortLayout::place(const Scan& scan) {
  PetscInt first = 0;
  MPI_Exscan(&local_, &first, 1, MPIU_INT, MPI_SUM, comm_);
  if (core::rank_of(comm_) == 0) first = 0;
  std::vector<PetscInt> part_rows;
  for (const Run& run : runs_)
    for (PetscInt i = 0; run.part && i < run.count; ++i) part_rows.push_back(first + run.whole + i);
  check(ISCreateGeneral(comm_, static_cast<PetscInt>(part_rows.size()), part_rows.data(), PETSC_COPY_VALUES,
                        part_rows_.put()));
  find_ports(scan);
  place_parts(scan);
  place_couplings(scan);
  x_.resize(parts());
  y_.resize(parts());
  hub_x_.resize(hub());
  hub_y_.resize(hub());
  shared_.setZero(whole_hub() + static_cast<Index>(coupled_.numbers.size()));
}

PortLayout::Coloured::Coloured(std::span<const std::uint64_t> seen, std::size_t parts) {
  const std::size_t words = words_of(parts);
  std::vector<std::vector<std::uint64_t>> used;  // by the numbers of a colour
  colour.assign(seen.size() / words, -1);
  for (std::size_t c = 0; c < colour.size(); ++c) {
    const auto bits = seen.subspan(c * words, words);
    if (std::ranges::all_of(bits, [](std::uint64_t word) { return word == 0; })) continue;
    const auto free = std::ranges::find_if(used, [&](const auto& u) {
      for (std::size_t k = 0; k < words; ++k)
        if ((u[k] & bits[k]) != 0) return false;
      return true;
    });
    const auto at_colour = static_cast<std::size_t>(free - used.begin());
    colour[c] = static_cast<int>(at_colour);
    if (free == used.end()) used.emplace_back(words, 0);
    for (std::size_t k = 0; k < words; ++k) used[at_colour][k] |= bits[k];
    numbers.push_back(static_cast<PetscInt>(c));
  }
  colours = static_cast<int>(used.size());
  at.assign(parts, std::vector<int>(used.size(), -1));
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto c = static_cast<std::size_t>(numbers[k]);
    for (std::size_t p = 0; p < parts; ++p)
      if (seen[c * words + p / 64] >> p % 64 & 1) at[p][static_cast<std::size_t>(colour[c])] = static_cast<int>(k);
  }
}

void PortLayout::find_ports(const Scan& scan) {
  const auto n = static_cast<std::size_t>(whole_hub());
  const std::size_t words = words_of(part_ends_.size());
  // Parts that see an unknown of the hub, then those that a row of it sees.
  std::vector<std::uint64_t> seen(2 * n * words, 0);
  const auto mark = [&](std::size_t number, std::size_t part) {
    seen[number * words + part / 64] |= std::uint64_t{1} << part % 64;
  };
  for (const Scan::Entry& e : scan.list) {
    if (e.row >= 0 && e.column < 0)
      mark(static_cast<std::size_t>(-1 - e.column),
           static_cast<std::size_t>(std::ranges::upper_bound(part_ends_, e.row) - part_ends_.begin()));
    if (e.row < 0 && e.column >= 0) mark(n + static_cast<std::size_t>(-1 - e.row), owner_of(e.column).part);
  }
  MPI_Allreduce(MPI_IN_PLACE, seen.data(), static_cast<int>(seen.size()), MPI_UINT64_T, MPI_BOR, comm_);
  const std::span<const std::uint64_t> all = seen;
  ports_ = Coloured(all.first(n * words), part_ends_.size());
  coupled_ = Coloured(all.subspan(n * words), part_ends_.size());
}

// A_pp by pieces of diagonals, so that products are loops over arrays. Short gaps are filled with zeros.
void PortLayout::place_parts(const Scan& scan) {
  constexpr PetscInt gap = 4;
  const auto rank = static_cast<std::size_t>(core::rank_of(comm_));
  const PetscInt first = part_offsets_[rank], end = part_offsets_[rank + 1];
  std::vector<Scan::Entry> own, other;
  std::vector<PetscInt> ghosts;
  for (const Scan::Entry& e : scan.list) {
    if (e.row < 0 || e.column < 0) continue;
    if (e.column >= first && e.column < end) {
      own.push_back({e.row, e.column - first, e.source});
    } else {
      other.push_back(e);
      ghosts.push_back(e.column);
    }
  }
  std::sort(ghosts.begin(), ghosts.end());
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  for (Scan::Entry& e : other)
    e.column = static_cast<PetscInt>(std::lower_bound(ghosts.begin(), ghosts.end(), e.column) - ghosts.begin());
  const auto cut = [&](std::vector<Scan::Entry>& all, std::vector<Piece>& pieces) {
    sort_by_diagonals(all);
    for (const Scan::Entry& e : all) {
      Piece* last = pieces.empty() ? nullptr : &pieces.back();
      if (!last || last->column - last->row != e.column - e.row || e.row > last->row + last->count + gap) {
        pieces.push_back({e.row, e.column, 0});
        last = &pieces.back();
      }
      if (e.row < last->row + last->count) {
        added_.emplace_back(sources_.size() - 1, e.source);
        continue;
      }
      for (; last->row + last->count < e.row; ++last->count) sources_.push_back(-1);
      ++last->count;
      sources_.push_back(e.source);
    }
  };
  cut(own, pieces_);
  cut(other, ghost_pieces_);
  ghost_columns_ = ghosts;
  part_vector_ = core::make_vector(comm_, parts(), PETSC_DETERMINE);
  ghosts_ = core::make_vector(PETSC_COMM_SELF, static_cast<PetscInt>(ghosts.size()), PETSC_DETERMINE);
  core::IndexSet from;
  check(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(ghosts.size()), ghosts.data(), PETSC_COPY_VALUES,
                        from.put()));
  check(VecScatterCreate(part_vector_.get(), from.get(), ghosts_.get(), nullptr, to_ghosts_.put()));
}

void PortLayout::place_couplings(const Scan& scan) {
  // Where entries of F belong: the rank, and the place among its columns F^T. A number among those of all ranks would
  // overflow long before the states do.
  std::vector<PetscSFNode> to;
  const PetscInt width = coupled_.colours;
  core::agree(comm_, [&] {
    for (const PetscInt columns : {width, static_cast<PetscInt>(ports_.colours)})
      (void)core::count_of(static_cast<std::int64_t>(columns) * parts(),
                           "ports times film states on one rank (more ranks hold fewer each)");
  });
  const PetscInt hub_begin = first_of_hub(), hub_end = hub_begin + hub();
  for (const Scan::Entry& e : scan.list) {
    if (e.row < 0 && e.column < 0) {
      core::require(-1 - e.row >= hub_begin && -1 - e.row < hub_end, "rows of the hub by themselves on this rank");
      hub_entries_.push_back({-1 - e.row, -1 - e.column, e.source});
    } else if (e.column < 0) {
      g_sources_.push_back(e.source);
      g_places_.push_back(ports_.colour[static_cast<std::size_t>(-1 - e.column)] * parts() + e.row);
    } else if (e.row < 0) {
      const Owner owner = owner_of(e.column);
      const PetscInt colour = coupled_.colour[static_cast<std::size_t>(-1 - e.row)];
      f_sources_.push_back(e.source);
      to.push_back({owner.rank, colour * owner.count + e.column - owner.first});
    }
  }
  const auto count = static_cast<PetscInt>(to.size());
  check(PetscSFCreate(comm_, to_f_.put()));
  check(PetscSFSetGraph(to_f_.get(), parts() * width, count, nullptr, PETSC_COPY_VALUES, to.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(to_f_.get()));
}

}  // namespace whirl::solve
