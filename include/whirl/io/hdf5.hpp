#pragma once
// A tree of records as an HDF5 file and back. Serial where no communicator is given: call on one rank.

#include <mpi.h>

#include <filesystem>

#include "whirl/io/record.hpp"

namespace whirl::io {

/// Writes `root` to `path` so that `path` always is a complete file: written beside it, synced, renamed.
///
/// Datasets carry the attributes `unit` and `description`. core::Error with the reason if the disk refuses; then `path`
/// is what it was before. Nothing may be shared.
void write_hdf5(const std::filesystem::path& path, const Group& root);
/// The same by the ranks of `comm`: rank 0 writes the tree, and each rank its rows of shared datasets
/// (MPI-IO). Errors are agreed. Collective.
void write_hdf5(const std::filesystem::path& path, const Group& root, MPI_Comm comm);

/// Reads a file that write_hdf5 made; core::Error if it is missing, damaged, or holds types that are not ours. Datasets
/// that were shared are whole.
[[nodiscard]] Group read_hdf5(const std::filesystem::path& path);
/// The same on one of the ranks that read it together: of each dataset that was shared it gets as many rows as the
/// others, whatever their number was when it was written. All groups in groups of the name `left` stay in the file.
/// Does not communicate: agree on its errors.
[[nodiscard]] Group read_hdf5(const std::filesystem::path& path, MPI_Comm comm, const std::string& left = "");

/// A group whose contents stay in a file until it is written, so that nobody has to hold the results of a thousand
/// variants. leave_in_file() empties `group` but for its attributes, which stand beside those of the file; what stands
/// at `place` in `file` is copied as write_hdf5() meets the group (not by the ranks that share datasets there).
void leave_in_file(Group& group, const std::filesystem::path& file, const std::string& place);
[[nodiscard]] bool is_left(const Group& group);
/// A left group with its contents; any other as it is. core::Error if the file does not have them.
[[nodiscard]] Group with_contents(const Group& group);
/// From now on what `root` has left stands in `file`, where the groups stand in `root`: after that file was written.
void moved_to(Group& root, const std::filesystem::path& file);

/// The tree as the bytes of such a file, and back: to hand it to other ranks. core::Error if the bytes are damaged.
[[nodiscard]] std::string to_bytes(const Group& root);
[[nodiscard]] Group from_bytes(const std::string& bytes);
/// The tree with the whole of its shared datasets on every rank of `comm`, for those who must hand it on. Collective.
void make_whole(Group& root, MPI_Comm comm);

}  // namespace whirl::io
