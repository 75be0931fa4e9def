#pragma once
// Start and end of MPI, PETSc and SLEPc.

#include <string>
#include <vector>

namespace whirl::core {

/// Owns the life of MPI, PETSc and SLEPc; make exactly one, first thing in main.
///
/// `petsc_options` are the words for PETSc's option database ("-eq_ksp_monitor", ...). PETSc's printing error handler
/// is replaced by one that keeps the text for LibraryError, so that a failure is reported once and by us.
class Session {
public:
  Session(int argc, char** argv, const std::vector<std::string>& petsc_options = {});
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Options of PETSc that were given and that no solver on this rank has asked for.
  [[nodiscard]] static std::vector<std::string> unused_options();

  /// Text of the PETSc error in flight (innermost first), and forgets it.
  static std::string take_trace();
};

}  // namespace whirl::core
