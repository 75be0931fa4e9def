#pragma once
// The directory of results.

#include <mpi.h>

#include <string>

namespace whirl::app {

/// What to do with results of an earlier run.
enum class Earlier { refuse, resume, replace };

/// Makes `directory` ready for a run and writes `resolved.yaml` into it under a temporary name, then renames it.
/// Collective. Throws core::InputError (agreed) if there are earlier results and `earlier` does not say what to do with
/// them, if they belong to another deck, or if the directory is not one of ours.
void prepare_directory(MPI_Comm comm, const std::string& directory, const std::string& resolved, Earlier earlier);

}  // namespace whirl::app
