#pragma once
// Which files of a folder belong to a run.

#include <filesystem>
#include <string>
#include <vector>

namespace whirl::io {

/// The names of the files that a run and its pictures made in a folder: `manifest.txt`, one a line, relative to it.
///
/// Whoever makes a file appends its name first, in whatever language; a name that stands there twice does no harm.
/// Names that lead out of the folder are passed over, and so is a last line without its end, which a kill left. Files
/// behind a link to another folder are written there if the user made one, but never removed.
/// Serial: call on one rank.
class Manifest {
public:
  static constexpr const char* file_name = "manifest.txt";

  explicit Manifest(std::filesystem::path folder);

  /// Names a file (with '/' between folders) unless it is named already. core::Error if that cannot be written, or if
  /// the name holds a line end or leads out of the folder.
  void add(const std::string& name);
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// True if the folder has a manifest.
  [[nodiscard]] bool exists() const;
  /// core::InputError if what stands under one of the names, or under a name that a kill leaves of it, is no file.
  void require_files() const;
  /// Removes the files named, except `keep`, and what a kill left of them (`NAME.part`, `.prev`, `.next`,
  /// `.next.part`); folders below this one that are empty then; and the manifest, which goes last.
  void remove_files(const std::string& keep = {});
  /// Removes the checkpoints among them, and what a kill left of these.
  void remove_checkpoints() const;

private:
  // False if it leads elsewhere or is a folder, and stays.
  [[nodiscard]] bool remove_file(const std::string& name) const;
  std::filesystem::path folder_;
  std::vector<std::string> names_;
};

/// core::InputError if there is something at `path` that is no file but a folder, a pipe or a device: to read it would
/// wait for ever, to replace it would fail after the work.
void require_file(const std::filesystem::path& path);

}  // namespace whirl::io
