#pragma once
// A matrix of a hub and parts on its ports in blocks.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// Where the entries of a matrix belong among the blocks of hub and parts, which see the hub but not each
/// other,
///
///     [ A_pp  G   ]   rows of the parts, this rank's one after the other
///     [ F     A_h ]   rows of the hub
///
/// A part sees few unknowns of the hub, its ports, and few rows of the hub see it. Ports that no part sees both of
/// share a column of G, and rows that do not see the same part a column of F^T: their numbers do not grow with that of
/// the parts. F^T is spread like the states of the parts; an assembled matrix has the rows of F, as long as a part, on
/// the rank of the hub, a list of entries (`problem::Entries`) has them where they belong.
class PortLayout {
public:
  /// `fields`: the hub first, in local rows of `a`; local rows in none of them belong to the hub. Collective.
  PortLayout(Mat a, const std::vector<problem::Field>& fields);
  /// Of a matrix with `local` rows here that is told by such a list. Collective.
  PortLayout(MPI_Comm comm, PetscInt local, const std::vector<problem::Field>& fields,
             std::span<const problem::Entries::Place> places);

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] PetscInt local() const { return local_; }
  /// Rows of the parts / of the hub on this rank, and of the hub on all.
  [[nodiscard]] PetscInt parts() const { return part_ends_.empty() ? 0 : part_ends_.back(); }
  [[nodiscard]] PetscInt hub() const { return local_ - parts(); }
  [[nodiscard]] PetscInt whole_hub() const { return hub_offsets_.back(); }
  [[nodiscard]] PetscInt first_of_hub() const;
  /// First row of the hub on each rank, and the number of all [ranks + 1].
  [[nodiscard]] const std::vector<PetscInt>& hub_offsets() const { return hub_offsets_; }
  [[nodiscard]] const core::IndexSet& part_rows() const { return part_rows_; }

  [[nodiscard]] std::size_t n_parts() const { return part_ends_.size(); }
  /// Rows of a part: the first of those here among the rows of all parts here, how many stand here, on lower ranks, and
  /// on all ranks; whether one rank has all of them.
  struct PartRows {
    PetscInt first, count, before, states;
    bool alone;
  };
  [[nodiscard]] PartRows part(std::size_t p) const;
  /// The entries of A_pp in the rows of part p here: row and column among the part's states on all ranks, and where
  /// PortMatrix::of_parts() has the value.
  struct PartEntry {
    PetscInt row, column;
    std::size_t value;
  };
  [[nodiscard]] std::vector<PartEntry> entries_of(std::size_t p) const;

  /// Entries of a vector of the matrix to those of parts and hub on this rank, and back.
  template <class T>
  void take(const T* whole, T* parts, T* hub) const {
    for (const Run& r : runs_) std::copy_n(whole + r.whole, r.count, (r.part ? parts : hub) + r.at);
  }
  template <class T>
  void give(const T* parts, const T* hub, T* whole) const {
    for (const Run& r : runs_) std::copy_n((r.part ? parts : hub) + r.at, r.count, whole + r.whole);
  }
  /// The hub's entries of all ranks to all [whole_hub], and the sum over the ranks of what `all` holds behind them.
  /// Collective.
  void share(const double* hub, Eigen::VectorXd& all) const;
  /// Numbers in the hub, in colours of a map: those that share a part differ.
  struct Coloured {
    std::vector<PetscInt> numbers;     ///< rising
    std::vector<int> colour;           ///< of any number in the hub, -1 for none
    std::vector<std::vector<int>> at;  ///< [part][colour]: place among the numbers, -1 for none
    int colours = 0;

    Coloured() = default;
    /// `seen`: for each number in the hub the parts, a bit each in whole words.
    Coloured(std::span<const std::uint64_t> seen, std::size_t parts);
  };
  /// Hub unknowns that parts see, and hub rows that see parts.
  [[nodiscard]] const Coloured& ports() const { return ports_; }
  [[nodiscard]] const Coloured& coupled() const { return coupled_; }
  /// sums[k] += column of k-th number . v over the parts here; `columns` [parts x colours], v [parts], sums [numbers].
  void add_products(const Coloured& of, const Eigen::MatrixXd& columns, const double* v, double* sums) const;
  /// v += sign sum_k hub[number k] column of k; `hub` [whole hub].
  void add_columns(const Coloured& of, const Eigen::MatrixXd& columns, double sign, const double* hub, double* v) const;
  /// sums [coupled x ports] += from^T to, part by part; `from`, `to` [parts x colours].
  void add_products(const Eigen::MatrixXd& from, const Eigen::MatrixXd& to, Eigen::MatrixXd& sums) const;

private:
  friend class PortMatrix;
  /// Calls f(part, its first row here, its rows).
  template <class F>
  void for_parts(F&& f) const {
    PetscInt begin = 0;
    for (std::size_t p = 0; p < part_ends_.size(); begin = part_ends_[p++]) f(p, begin, part_ends_[p] - begin);
  }
  struct Run {  // rows that stand side by side
    PetscInt whole, at, count;
    bool part;
  };
  struct Piece {  // of a diagonal of A_pp: entries (row + i, column + i)
    PetscInt row, column, count;
  };
  /// A place in a block, and the entry that belongs there: that of the list, or of this rank's rows, diagonal block
  /// first, as PETSc stores them; -1 is a zero.
  struct HubEntry {
    PetscInt row, column, source;
  };
  /// A part's column on some rank: the rank, its first column, its columns, and the part.
  struct Owner {
    PetscMPIInt rank;
    PetscInt first, count;
    std::size_t part;
  };
  struct Scan;
  /// What every local row is, as a row and as a column; and all these columns, of which others' are seen.
  struct Numbers {
    std::vector<PetscInt> rows, columns;
    core::Vector all;
    /// The columns with these numbers in the matrix. Collective.
    [[nodiscard]] std::vector<PetscInt> seen(const std::vector<PetscInt>& in_matrix) const;
  };
  [[nodiscard]] Numbers numbers() const;
  void place(const Scan& scan);
  [[nodiscard]] Owner owner_of(PetscInt column) const;
  /// Rows of part p on a rank.
  [[nodiscard]] PetscInt count_of(std::size_t rank, std::size_t p) const;
  void number_rows(const std::vector<problem::Field>& fields);
  void find_ports(const Scan& scan);
  void place_parts(const Scan& scan);
  void place_couplings(const Scan& scan);
  /// States of parts on other ranks that rows here see, of x [parts]. Collective.
  [[nodiscard]] core::ReadArray to_ghosts(const double* x) const;

  MPI_Comm comm_;
  PetscInt local_ = 0;
  std::vector<Run> runs_;
  std::vector<PetscInt> part_ends_;                   // local rows of the parts, part by part
  std::vector<PetscInt> all_part_ends_;               // those of all ranks, one after the other
  std::vector<PetscInt> hub_offsets_, part_offsets_;  // first of each rank's among all, and their number
  core::IndexSet part_rows_;
  Coloured ports_, coupled_;
  std::vector<Piece> pieces_, ghost_pieces_;             // of A_pp: columns of this rank's parts, and of others'
  std::vector<PetscInt> sources_;                        // of the values of both
  std::vector<std::pair<std::size_t, PetscInt>> added_;  // further entries of a place: which value, and the source
  std::vector<HubEntry> hub_entries_;
  std::vector<PetscInt> g_sources_, g_places_;  // into G, column by column
  std::vector<PetscInt> f_sources_;             // entries of F on this rank
  core::StarForest to_f_;                       // from these to the columns F^T, wherever they stand
  core::Scatter to_ghosts_;
  std::vector<PetscInt> ghost_columns_;                           // among the parts' rows of all ranks
  core::Vector part_vector_, ghosts_;                             // work space of the ghosts
  mutable Eigen::VectorXd x_, y_, hub_x_, hub_y_, shared_, few_;  // and of products
};

/// A matrix in these blocks.
class PortMatrix {
public:
  explicit PortMatrix(std::shared_ptr<const PortLayout> layout);
  /// The values of `a`, which has the pattern of the layout. Collective.
  void take(Mat a);
  /// The values of the list of entries that the layout was made of. Collective.
  void take(std::span<const double> values);
  /// Row i times rows[i], column k times columns[k]. Collective.
  void scale(Vec rows, Vec columns);
  /// y = A x, of this rank's rows. Collective.
  void multiply(const double* x, double* y) const;
  /// y = A_pp x, of this rank's rows of the parts. Collective.
  void multiply_parts(const double* x, double* y) const;
  [[nodiscard]] const std::shared_ptr<const PortLayout>& layout() const { return layout_; }
  /// G [parts x colours], F^T [parts x coupled colours].
  [[nodiscard]] const Eigen::MatrixXd& to_parts() const { return g_; }
  [[nodiscard]] std::shared_ptr<const Eigen::MatrixXd> from_parts() const { return f_; }
  /// A_pp's entries (PortLayout::entries_of()).
  [[nodiscard]] const std::vector<double>& of_parts() const { return values_; }
  /// Calls f(row, column, value) for the entries of A_h in this rank's rows; numbers in the hub.
  template <class F>
  void for_hub(F&& f) const {
    for (std::size_t k = 0; k < hub_.size(); ++k)
      f(layout_->hub_entries_[k].row, layout_->hub_entries_[k].column, hub_[k]);
  }

private:
  /// The values of the sources, value(source).
  template <class Value>
  void place(const Value& value);
  std::shared_ptr<const PortLayout> layout_;
  std::vector<double> values_, hub_, f_values_;  // of A_pp, of A_h, of the entries of F on this rank
  Eigen::MatrixXd g_;
  std::shared_ptr<Eigen::MatrixXd> f_;  // which eliminations keep
};

}  // namespace whirl::solve
