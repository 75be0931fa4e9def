#include "whirl/io/manifest.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "io/atomic_file.hpp"
#include "whirl/core/error.hpp"
#include "whirl/io/checkpoint.hpp"

namespace whirl::io {
namespace {

namespace fs = std::filesystem;

bool stays_inside(const std::string& name) {
  const fs::path path(name);
  return !name.empty() && name.find_first_of("\r\n") == std::string::npos && path.is_relative() &&
         std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".." || part == "."; });
}

// Whether a folder on the way from `folder` to the file `name` below it is a link, which leads elsewhere.
bool passes_a_link(const fs::path& folder, const fs::path& name) {
  for (fs::path inner = name.parent_path(); !inner.empty(); inner = inner.parent_path())
    if (fs::is_symlink(fs::symlink_status(folder / inner))) return true;
  return false;
}

// What stands beside a file while it is written, and what a kill leaves of it.
std::vector<std::string> leftovers(const std::string& name) {
  std::vector<std::string> out{name + ".part"};
  if (name.ends_with(Checkpoint::ending))
    for (const char* suffix : Checkpoint::beside) out.push_back(name + suffix);
  return out;
}

std::string contents(const fs::path& path) {
  require_file(path);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

void require_file(const fs::path& path) {
  const fs::file_status there = fs::status(path);
  if (!fs::exists(there) || fs::is_regular_file(there)) return;
  throw core::InputError("'" + path.string() + "' is " +
                         (fs::is_directory(there) ? "a folder"
                          : fs::is_fifo(there)    ? "a pipe"
                                                  : "no file") +
                         ", and results go there: remove it or choose another directory with -o");
}

Manifest::Manifest(fs::path folder) : folder_(std::move(folder)) {
  const std::string text = contents(folder_ / file_name);
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    std::string name = text.substr(begin, end - begin);
    if (name.ends_with('\r')) name.pop_back();
    if (stays_inside(name) && !has(name)) names_.push_back(std::move(name));
  }
}

bool Manifest::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

bool Manifest::exists() const {
  return fs::exists(folder_ / file_name);
}

void Manifest::add(const std::string& name) {
  if (!stays_inside(name)) throw core::Error("no name of a result: '" + name + "'");
  if (has(name)) return;
  const fs::path path = folder_ / file_name;
  // An unfinished line would become a name together with this one.
  if (const std::string text = contents(path); !text.empty() && text.back() != '\n')
    replace_file(path, text.substr(0, text.find_last_of('\n') + 1));
  std::ofstream out(path, std::ios::binary | std::ios::app);
  out << name + "\n" << std::flush;
  if (!out) throw core::Error("cannot write " + path.string() + ": " + std::strerror(errno));
  names_.push_back(name);
}

void Manifest::require_files() const {
  for (const std::string& name : names_) {
    require_file(folder_ / name);
    for (const std::string& left : leftovers(name)) require_file(folder_ / left);
  }
}

bool Manifest::remove_file(const std::string& name) const {
  const fs::path path = folder_ / name;
  if (passes_a_link(folder_, name) || fs::is_directory(fs::symlink_status(path))) return false;
  fs::remove(path);
  for (const std::string& left : leftovers(name)) fs::remove(folder_ / left);
  return true;
}

void Manifest::remove_checkpoints() const {
  for (const std::string& name : names_)
    if (name.ends_with(Checkpoint::ending)) (void)remove_file(name);
}

void Manifest::remove_files(const std::string& keep) {
  for (const std::string& name : names_) {
    if (name == keep || !remove_file(name)) continue;
    // Folders that are not empty refuse, and stay.
    std::error_code ignored;
    for (fs::path inner = fs::path(name).parent_path(); !inner.empty(); inner = inner.parent_path())
      fs::remove(folder_ / inner, ignored);
  }
  names_.clear();
  fs::remove(folder_ / file_name);
}

}  // namespace whirl::io
