#pragma once
// How a film with own states is cut over ranks: what a rank holds of it, what that sees, where its matrices have
// entries.

#include <span>
#include <vector>

namespace whirl::film {

/// Entries (row + i, column + i), i < count, of a sparse matrix: a piece of a diagonal.
struct Diagonal {
  int row, column, count;
};

/// Where a sparse matrix has entries: piece by piece, its values in this order. Entries of one place add up, and any
/// may be zero. Places that come diagonal by diagonal make few pieces, so that loops over them are loops over arrays.
class Places {
public:
  /// One more entry; lengthens the last piece where it goes on.
  void add(int row, int column) { add(Diagonal{row, column, 1}); }
  void add(Diagonal piece);
  [[nodiscard]] const std::vector<Diagonal>& pieces() const { return pieces_; }
  /// Number of entries.
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  std::vector<Diagonal> pieces_;
  std::size_t size_ = 0;
};

/// What a rank holds of a film: rows and states [begin, end), numbered in the film, and the states that it has to see
/// to evaluate its rows.
struct Share {
  int begin = 0, end = 0;
  /// States that an evaluation takes, in its order: those held and those that its rows depend on beside them. A state
  /// may come twice. The whole of a film that sees each state once sees them in their order.
  std::vector<int> seen;
  Places d_states, d_rates;  ///< of dg/ds, dg/ds': rows counted from `begin`, columns in `seen`
  [[nodiscard]] int rows() const { return end - begin; }
};

/// Calls f(row counted from share.begin, state numbered in the film, value) for all entries at `places` of a share;
/// without values for their zeros.
template <class F>
void for_entries(const Share& share, const Places& places, std::span<const double> values, F&& f) {
  std::size_t k = 0;
  for (const Diagonal& d : places.pieces())
    for (int i = 0; i < d.count; ++i, ++k)
      f(d.row + i, share.seen[static_cast<std::size_t>(d.column + i)], values.empty() ? 0.0 : values[k]);
}

/// The values of a share's `seen` states from those of all states of the film.
[[nodiscard]] std::vector<double> seen_of(const Share& share, std::span<const double> states);

}  // namespace whirl::film
