#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "whirl/core/error.hpp"

namespace whirl::io {
namespace {

void sync_path(const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags);
  if (fd < 0) throw core::Error("cannot open " + path.string() + ": " + std::strerror(errno));
  const int failed = ::fsync(fd);
  const int why = errno;
  ::close(fd);
  // Some file systems cannot sync a folder; the file itself must be safe.
  if (failed && why != EINVAL && why != EROFS)
    throw core::Error("cannot sync " + path.string() + ": " + std::strerror(why));
}

}  // namespace

void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const std::filesystem::path part = path.string() + ".part";
  try {
    std::filesystem::create_directories(folder);
    write(part);
    sync_path(part, O_RDONLY);
    std::filesystem::rename(part, path);
    sync_path(folder, O_RDONLY | O_DIRECTORY);
  } catch (const std::filesystem::filesystem_error& e) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw core::Error("cannot write " + path.string() + ": " + e.code().message());
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

void replace_file(const std::filesystem::path& path, const std::string& content) {
  replace_file(path, [&](const std::filesystem::path& part) {
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out << content;
    out.close();
    if (!out) throw core::Error("cannot write " + path.string() + ": " + std::strerror(errno));
  });
}

}  // namespace whirl::io
