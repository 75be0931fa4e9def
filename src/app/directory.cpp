#include "directory.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::app {
namespace {

namespace fs = std::filesystem;
using core::InputError;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path unfinished_name(const fs::path& path) {
  return path.string() + ".new";
}

void write_whole(const fs::path& path, const std::string& text) {
  const fs::path temporary = unfinished_name(path);
  std::ofstream out(temporary, std::ios::binary);
  out << text << std::flush;
  out.close();
  if (!out) throw core::Error(fmt::format("cannot write '{}'", temporary.string()));
  fs::rename(temporary, path);
}

// True for the kinds of files that a run and its pictures leave; others in a directory of results are the user's.
bool is_ours(const fs::path& file) {
  const std::string name = file.filename().string(), kind = file.extension().string();
  return name == "resolved.yaml" || name == "summary.json" || name == "results.h5" || name == "report.html" ||
         kind == ".xdmf" || kind == ".png" || kind == ".part" || name == "resolved.yaml.new" ||
         name.find(".checkpoint.h5") != std::string::npos;
}

void prepare(const fs::path& directory, const std::string& resolved, Earlier earlier) {
  if (fs::exists(directory) && !fs::is_directory(directory))
    throw InputError(fmt::format("'{}' is a file; -o names a directory", directory.string()));
  const fs::path deck = directory / "resolved.yaml", unfinished = unfinished_name(deck);
  // A run killed while it wrote its deck leaves only that.
  bool used = false;
  if (fs::exists(directory))
    for (const auto& entry : fs::directory_iterator(directory)) used = used || entry.path() != unfinished;
  if (used) {
    if (!fs::exists(deck))
      throw InputError(fmt::format("'{}' holds files that are not results of whirl", directory.string()));
    if (earlier == Earlier::refuse)
      throw InputError(
          fmt::format("'{}' holds results already: choose another directory with -o, go on with --resume, or "
                      "replace them with --force",
                      directory.string()));
    if (earlier == Earlier::resume && contents(deck) != resolved)
      throw InputError(
          fmt::format("'{}' holds results of another deck: --resume needs the same one", directory.string()));
    // The deck goes last (it is replaced below): it says whose directory this is.
    if (earlier == Earlier::replace)
      for (const auto& entry : fs::directory_iterator(directory))
        if (entry.is_regular_file() && is_ours(entry.path()) && entry.path() != deck) fs::remove(entry.path());
  }
  fs::create_directories(directory);
  write_whole(deck, resolved);
}

}  // namespace

void prepare_directory(MPI_Comm comm, const std::string& directory, const std::string& resolved, Earlier earlier) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  core::agree(comm, [&] {
    if (rank != 0) return;
    try {
      prepare(directory, resolved, earlier);
    } catch (const fs::filesystem_error& e) {
      throw InputError(fmt::format("cannot use '{}' for results: {}", directory, e.code().message()));
    }
  });
}

}  // namespace whirl::app
