#pragma once
// Factors of dg/ds of a film by itself, whose order serves whoever needs the next ones.

#include <memory>

#include "whirl/core/sparse_lu.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// An LU for matrices of the pattern of the film's dg/ds. To order and to analyse a pattern takes half as long as to
/// factorise: the film keeps the LU of the last user for the next one. The film must outlive it.
class LentLu {
public:
  explicit LentLu(Film& film)
      : film_(film), lu_(film.spare_lu_ ? std::move(film.spare_lu_) : std::make_unique<core::SparseLu>()) {}
  LentLu(const LentLu&) = delete;
  LentLu& operator=(const LentLu&) = delete;
  ~LentLu() {
    if (film_.states() <= most_kept) film_.spare_lu_ = std::move(lu_);
  }
  core::SparseLu* operator->() const { return lu_.get(); }

private:
  static constexpr std::size_t most_kept = 50'000;  // states; factors of more would be some 100 MB that nobody uses
  Film& film_;
  std::unique_ptr<core::SparseLu> lu_;
};

}  // namespace whirl::film
