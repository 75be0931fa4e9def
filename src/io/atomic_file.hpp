#pragma once
// Files that are either the old or the new one, never a part.

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <string>

namespace whirl::io {

/// Lets `write` make the file at a temporary path beside `path`, syncs it to disk and renames it to `path`.
///
/// Makes the folder if it is missing. If anything throws, the temporary file is removed and `path` is untouched.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

/// The same by all ranks of `comm`: rank 0 makes the file by `begin`, then all write into it by `together`, which is
/// collective and whose errors are agreed. Errors are agreed. Collective.
void replace_file(const std::filesystem::path& path, MPI_Comm comm,
                  const std::function<void(const std::filesystem::path&)>& begin,
                  const std::function<void(const std::filesystem::path&)>& together);

/// The same on one rank with given content.
void replace_file(const std::filesystem::path& path, const std::string& content);

}  // namespace whirl::io
