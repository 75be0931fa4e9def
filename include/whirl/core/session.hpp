#pragma once
// Start and end of MPI, PETSc and SLEPc.

#include <string>
#include <vector>

namespace whirl::core {

/// An option that PETSc has been given.
struct OptionInForce {
  std::string name;    ///< with its dash
  std::string value;   ///< empty for a flag
  std::string source;  ///< `command line`, `PETSC_OPTIONS`, `~/.petscrc`; empty if that cannot be told
};

/// Owns the life of MPI, PETSc and SLEPc; make exactly one, first thing in main.
///
/// PETSc's printing error handler is replaced by one that keeps the text for LibraryError, so that a failure is
/// reported once and by us. BLAS gets one thread unless the environment says how many. Of the files that PETSc reads
/// options from only the user's own counts, ~/.petscrc: a deck from elsewhere brings a folder, and an option of a file
/// there could load a library.
class Session {
public:
  Session(int argc, char** argv);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// One BLAS thread from here on, unless the environment says how many (OPENBLAS_NUM_THREADS, OMP_NUM_THREADS, ...).
  /// The constructor does it; nothing happens if the library has no such switch.
  static void one_blas_thread();

  /// Whether a launcher of ranks, such as mpirun, has started this process.
  [[nodiscard]] static bool launched();

  /// Tells Open MPI, before it starts, that ranks that wait give their cores away, and that a process without a
  /// launcher needs no daemon. The environment has the last word (OMPI_MCA_mpi_yield_when_idle,
  /// OMPI_MCA_ess_singleton_isolated). The constructor does it.
  static void prepare_mpi();

  /// Puts words of the command line into PETSc's option database ("-newton_snes_monitor", ...), over what other sources
  /// gave. core::InputError (agreed) for a word that is neither the name of an option nor the value of the one before.
  static void set_options(const std::vector<std::string>& words);
  /// All options that PETSc has been given, in the order of its database.
  [[nodiscard]] static std::vector<OptionInForce> options_in_force();

  /// Options of PETSc that were given and that no solver on this rank has asked for.
  [[nodiscard]] static std::vector<std::string> unused_options();

  /// What the user wants with an option of PETSc that PETSc cannot do (a type that there is not, no number), where an
  /// error with this code and this trace says so and options were given; else empty.
  [[nodiscard]] static std::string impossible_option(int code, const std::string& trace);

  /// Text of the PETSc error in flight (innermost first), and forgets it.
  static std::string take_trace();
};

}  // namespace whirl::core
