#pragma once
// The ranks that hold each film of a machine.

#include <cstddef>
#include <vector>

#include "film_part.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// The ranks that hold each film, with a communicator for them; null on others, and for films without states.
class RotorSystem::FilmComms {
public:
  /// Collective.
  FilmComms(MPI_Comm comm, const std::vector<Bearing>& bearings) {
    for (const Bearing& b : bearings) {
      MPI_Comm& made = comms_.emplace_back(MPI_COMM_NULL);
      if (b.part->count() > 0) MPI_Comm_split(comm, b.part->rows() > 0 ? 0 : MPI_UNDEFINED, core::rank_of(comm), &made);
    }
  }
  FilmComms(const FilmComms&) = delete;
  FilmComms& operator=(const FilmComms&) = delete;
  ~FilmComms() {
    for (MPI_Comm& comm : comms_)
      if (comm != MPI_COMM_NULL) MPI_Comm_free(&comm);
  }
  [[nodiscard]] MPI_Comm of(std::size_t bearing) const { return comms_[bearing]; }
  /// The films here for which wanted(part), those of this rank alone first: it works on these while others do the same,
  /// and waits for others only then.
  template <class F>
  [[nodiscard]] static std::vector<std::size_t> in_order(const FilmComms& comms, const std::vector<Bearing>& bearings,
                                                         F&& wanted) {
    std::vector<std::size_t> out;
    for (const bool alone : {true, false})
      for (std::size_t b = 0; b < bearings.size(); ++b)
        if (comms.of(b) != MPI_COMM_NULL && wanted(*bearings[b].part) && (core::size_of(comms.of(b)) == 1) == alone)
          out.push_back(b);
    return out;
  }

private:
  std::vector<MPI_Comm> comms_;
};

}  // namespace whirl::system
