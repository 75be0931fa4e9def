#pragma once
// A film among the parts of a machine: which of its rows stand on this rank, what they see of those on others, and
// where its derivatives go. A film without states of its own has no rows; all else is the same.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "part.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/system/train.hpp"

namespace whirl::system {

/// Coordinates of the machine whose sum, with these signs, is a motion that a film sees: journal less pedestal. A
/// machine has those along x and y, and the slopes of a journal whose film tilts.
using PortEnds = std::vector<std::pair<PetscInt, double>>;

/// Own states of all films stand film by film behind the machine; this one's begin at `first` among them.
class FilmPart final : public Part {
public:
  /// Makes the film of a bearing; throws core::InputError on values outside their range.
  FilmPart(const Support& support, PetscInt first);
  FilmPart(std::unique_ptr<film::Film> film, PetscInt first);
  /// The film of the same bearing with other numbers on the same mesh, held as this one is; what it searches starts
  /// from where this one ended. Throws as the constructor does.
  [[nodiscard]] std::unique_ptr<FilmPart> with(const Support& support) const;

  [[nodiscard]] film::Film& film() const { return *film_; }
  [[nodiscard]] PetscInt first() const { return first_; }
  [[nodiscard]] PetscInt count() const { return count_; }
  [[nodiscard]] PetscInt end() const { return first_ + count_; }
  /// A state near `wanted` of all own states, which is one of this film's, before which it may be cut.
  [[nodiscard]] PetscInt cut(PetscInt wanted) const;
  /// This rank holds own states [begin, end) of all films; the first of them has the local row `row`. What its films
  /// see is gathered film by film, that of this one from `gathered` on. A film without states is one rank's.
  void hold(PetscInt begin, PetscInt end, PetscInt row, std::size_t gathered, bool without_states);
  [[nodiscard]] const film::Share& share() const { return share_; }
  /// The motions that it sees, by their coordinates of the machine, of which there are `coordinates`: own states of all
  /// films stand behind these and their rates.
  void join(std::vector<PortEnds> ports, PetscInt coordinates);
  [[nodiscard]] const std::vector<PortEnds>& ports() const { return ports_; }
  /// This rank evaluates it, or a share of it.
  [[nodiscard]] bool here() const { return here_; }

  /// This rank's share; `own` and `rates`: what all films of this rank see. A film with states that is where it was
  /// keeps its answer: residual, derivatives, inverse and d/dp of one linearisation are one evaluation.
  void evaluate(const film::JournalMotion& motion, std::span<const double> own, std::span<const double> rates,
                film::Need need);
  /// The whole film into `response`; `own` and `rates`: those of all films, null if there are none.
  void evaluate(const film::JournalMotion& motion, const double* own, const double* rates, film::Need need,
                film::StateResponse& response) const;
  /// What it answered last: of the journal, what this rank adds.
  [[nodiscard]] const film::StateResponse& response() const { return response_; }
  /// All of that of the journal, once the ranks have taken their sum; on a single rank it is the same.
  [[nodiscard]] const film::Response& journal() const { return sum_ ? *sum_ : response_.journal; }
  void take(const film::Response& sum) { sum_ = sum; }

  [[nodiscard]] PetscInt row() const override { return row_; }
  [[nodiscard]] PetscInt rows() const override { return share_.rows(); }
  [[nodiscard]] std::vector<problem::Field> fields(const std::string& name) const override;
  void scales(double* states, double* rows) const override;
  void residual(const Instant& at, double* f) const override;
  void speed_derivative(const Instant& at, double* f) const override;
  /// j += alpha times the derivatives of its rows in states and journal, and of its forces in its states; sigma times
  /// those in rates. Without `values` their places alone.
  template <class Entries>  // core::EntryStream or problem::Entries
  void add(Entries& j, bool values, double alpha, double sigma) const;

  /// The states of the film from those of a machine held as a whole.
  [[nodiscard]] std::span<const double> of(const double* x) const {
    return {x + begin_, static_cast<std::size_t>(count_)};
  }
  [[nodiscard]] bool constant_rates() const { return film_->constant_rates(); }
  /// It finds its states by whole steps of Newton's method while the machine stays where it is.
  [[nodiscard]] bool settles() const { return film_->whole_steps(); }
  /// The states at which it rests with the journal where it is.
  [[nodiscard]] std::vector<double> relaxed(const film::JournalMotion& motion) const;
  /// Those of a film that carries nothing.
  [[nodiscard]] std::vector<double> unloaded(const film::JournalMotion& motion) const;

private:
  /// Its states of one kind on this rank.
  [[nodiscard]] problem::Field field(const film::StateField& f) const;

  std::unique_ptr<film::Film> film_;
  PetscInt first_, count_, begin_ = 0, row_ = 0;  // begin_: of its states in a machine held as a whole
  std::size_t gathered_ = 0;
  bool here_ = false;
  film::Share share_;
  std::vector<PortEnds> ports_;
  film::StateResponse response_;
  std::optional<film::Response> sum_;
  struct Asked {  // what response_ answers
    film::JournalMotion motion;
    std::vector<double> own, rates;
    film::Need need;
  };
  std::optional<Asked> asked_;  // of a share with states
};

}  // namespace whirl::system
