#pragma once
// A film with own states among the parts of a machine: which of its rows stand on this rank, what they see of those on
// others, and where its derivatives go.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "whirl/core/entry_stream.hpp"
#include "whirl/film/state_model.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::system {

/// Coordinates of the machine whose sum, with these signs, is a motion that a film sees: journal less pedestal. A
/// machine has those along x and y; all others are zero.
using PortEnds = std::vector<std::pair<PetscInt, double>>;

/// Own states of all films stand film by film behind the machine; this one's begin at `first` among them.
class FilmPart {
public:
  FilmPart(std::unique_ptr<film::StateModel> film, PetscInt first) : film_(std::move(film)), first_(first) {}

  [[nodiscard]] film::StateModel& film() const { return *film_; }
  [[nodiscard]] PetscInt first() const { return first_; }
  [[nodiscard]] PetscInt count() const { return static_cast<PetscInt>(film_->states()); }
  [[nodiscard]] PetscInt end() const { return first_ + count(); }
  /// This rank holds own states [begin, end) of all films; the first of them has the local row `row`. What its films
  /// see is gathered film by film, that of this one from `gathered` on.
  void hold(PetscInt begin, PetscInt end, PetscInt row, std::size_t gathered);
  [[nodiscard]] const film::Share& share() const { return share_; }
  /// First local row, and their number.
  [[nodiscard]] PetscInt row() const { return row_; }
  [[nodiscard]] PetscInt rows() const { return share_.rows(); }
  /// Where what it sees begins in what is gathered.
  [[nodiscard]] std::size_t gathered() const { return gathered_; }

  /// `own` and `rates`: what all films of this rank see.
  void evaluate(const film::Motion& motion, std::span<const double> own, std::span<const double> rates, film::Need need,
                film::StateResponse& response) const;
  /// Its fields on this rank; they bear the name of the part.
  [[nodiscard]] std::vector<problem::Field> fields(const std::string& name) const;
  /// The states of the film from those of a machine of n coordinates held as a whole.
  [[nodiscard]] std::span<const double> of(const double* x, PetscInt n) const {
    return {x + 2 * n + first_, film_->states()};
  }

  /// Room for the entries of its rows, [local rows].
  void count_entries(const std::vector<PortEnds>& ports, std::span<PetscInt> count) const;
  /// j += alpha times the derivatives in states and journal, sigma times those in rates; without a response the places
  /// alone. The rows of own states of all films begin at 2 n.
  void add(core::EntryStream& j, const film::StateResponse* response, PetscInt n, const std::vector<PortEnds>& ports,
           double alpha, double sigma) const;

private:
  std::unique_ptr<film::StateModel> film_;
  PetscInt first_, row_ = 0;
  std::size_t gathered_ = 0;
  film::Share share_;
};

}  // namespace whirl::system
