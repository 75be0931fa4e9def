#include "directory.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/manifest.hpp"

namespace whirl::app {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr const char* deck_name = "resolved.yaml";
// The deck of a run that replaces an earlier one: it stands from before the first file is removed until the last is.
constexpr const char* replacing_name = "resolved.yaml.next";
constexpr const char* removing_name = "resolved.yaml.removing";
// Those of every run; a folder of a version without manifest has them, too.
constexpr const char* always[] = {"results.h5", "summary.json"};

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path unfinished_name(const fs::path& path) {
  return path.string() + ".new";
}

void write(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  out.close();
  if (!out) throw core::Error(fmt::format("cannot write '{}'", path.string()));
}

void write_whole(const fs::path& path, const std::string& text) {
  const fs::path temporary = unfinished_name(path);
  write(temporary, text);
  fs::rename(temporary, path);
}

bool holds_results(const fs::path& directory, const io::Manifest& manifest) {
  // Of a checkpoint a kill between two renames leaves the one before.
  const auto there = [&](const std::string& name) {
    return name != deck_name && (fs::exists(directory / name) || fs::exists(directory / (name + ".prev")));
  };
  return std::any_of(std::begin(always), std::end(always), there) ||
         std::any_of(manifest.names().begin(), manifest.names().end(), there);
}

}  // namespace

Directory::Lock::~Lock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Directory::lock() {
  const int folder = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  Lock lock(folder);
  // The ranks of a run that has just been killed need a moment to vanish.
  for (int attempt = 0; attempt < 20; ++attempt) {
    if (::flock(folder, LOCK_EX | LOCK_NB) == 0) {
      lock_ = std::move(lock);
      return;
    }
    if (errno != EWOULDBLOCK) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw InputError(fmt::format("another run is at work in '{}': wait for its end or choose another directory with -o",
                               path_.string()));
}

void Directory::prepare(const std::string& resolved, Earlier earlier, const std::vector<std::string>& files) {
  if (fs::exists(path_) && !fs::is_directory(path_))
    throw InputError(fmt::format("'{}' is a file; -o names a directory", path_.string()));
  made_ = fs::create_directories(path_);
  lock();
  const fs::path deck = path_ / deck_name, unfinished = unfinished_name(deck), replacing = path_ / replacing_name,
                 removing = path_ / removing_name;
  for (const fs::path& one : {path_ / io::Manifest::file_name, deck, unfinished, replacing, removing})
    io::require_file(one);
  for (const char* name : always) io::require_file(path_ / name);
  for (const std::string& name : files) io::require_file(path_ / name);
  if (const fs::path tables = path_ / "csv"; fs::exists(tables) && !fs::is_directory(tables))
    throw InputError(fmt::format(
        "'{}' is no folder, and tables go there: remove it or choose another directory with -o", tables.string()));
  io::Manifest manifest(path_);
  manifest.require_files();
  const bool ours = fs::exists(deck) || manifest.exists();
  // A run killed while it wrote its deck leaves only that.
  const bool empty =
      std::all_of(fs::directory_iterator(path_), fs::directory_iterator(), [&](const fs::directory_entry& e) {
        return e.path() == unfinished || e.path() == replacing || e.path() == removing;
      });
  fresh_ = empty;
  if (!empty && !ours) throw InputError(fmt::format("'{}' holds files that are not results of whirl", path_.string()));
  // What a killed --force has left of the results that it had begun to remove goes the same way. Before that nothing is
  // lost.
  if (fs::exists(removing))
    earlier = Earlier::replace;
  else
    fs::remove(replacing);
  // A deck by itself that a manifest names is what a run left that came to nothing.
  const bool used = holds_results(path_, manifest) || (fs::exists(deck) && !manifest.has(deck_name));
  if (used && earlier == Earlier::refuse)
    throw InputError(
        fmt::format("'{}' holds results already: choose another directory with -o, go on with --resume, or "
                    "replace them with --force",
                    path_.string()));
  if (used && earlier == Earlier::resume && contents(deck) != resolved)
    throw InputError(fmt::format("'{}' holds results of another deck: --resume needs the same one", path_.string()));
  if (earlier != Earlier::replace) {
    manifest.add(deck_name);
    return write_whole(deck, resolved);
  }
  try {
    write(replacing, resolved);
  } catch (const core::Error&) {  // nothing was removed yet: the next run shall not go on with that
    std::error_code ignored;
    fs::remove(replacing, ignored);
    throw;
  }
  fs::rename(replacing, removing);
  // The deck stays until it is replaced: it says whose directory this is.
  manifest.remove_files(deck_name);
  for (const char* name : always) fs::remove(path_ / name);
  manifest.add(deck_name);
  fs::rename(removing, deck);
}

Directory::Directory(MPI_Comm comm, const std::string& directory, const std::string& resolved, Earlier earlier,
                     const std::vector<std::string>& files)
    : path_(directory) {
  core::agree(comm, [&] {
    if (core::rank_of(comm) != 0) return;
    try {
      prepare(resolved, earlier, files);
    } catch (const fs::filesystem_error& e) {
      throw InputError(fmt::format("cannot use '{}' for results: {}", directory, e.code().message()));
    }
  });
}

void Directory::abandon() noexcept {
  if (!lock_.held()) return;  // not rank 0, or somebody else may be at work here
  std::error_code ignored;
  try {
    io::Manifest manifest(path_);
    if (holds_results(path_, manifest)) return;
    fs::remove(path_ / deck_name, ignored);
    // An empty folder of ours stays ours: files of the user beside the results must not make it a stranger.
    if (!fresh_) return;
    manifest.remove_files();
    if (made_) fs::remove(path_, ignored);
  } catch (const std::exception&) {  // it could not be read or removed: the error that led here is told
    return;
  }
}

}  // namespace whirl::app
