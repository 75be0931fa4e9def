#pragma once
// A tree of records as an HDF5 file and back. Serial: call on one rank.

#include <filesystem>

#include "whirl/io/record.hpp"

namespace whirl::io {

/// Writes `root` to `path` so that `path` always is a complete file: written beside it, synced, renamed.
///
/// Datasets carry the attributes `unit` and `description`. core::Error with the reason if the disk refuses; then `path`
/// is what it was before.
void write_hdf5(const std::filesystem::path& path, const Group& root);

/// Reads a file that write_hdf5 made; core::Error if it is missing, damaged, or holds types that are not ours.
[[nodiscard]] Group read_hdf5(const std::filesystem::path& path);

/// Marks `root` as a results file: attributes title, version, format, and in words the frames, signs and units.
void describe_results(Group& root, const std::string& title, const std::string& version);

/// The tree as the bytes of such a file, and back: to hand it to other ranks. core::Error if the bytes are damaged.
[[nodiscard]] std::string to_bytes(const Group& root);
[[nodiscard]] Group from_bytes(const std::string& bytes);

}  // namespace whirl::io
