#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

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

// What a step of the writing of `path` may throw, with its name.
void named(const std::filesystem::path& path, const std::function<void()>& step) {
  try {
    step();
  } catch (const std::filesystem::filesystem_error& e) {
    throw core::Error("cannot write " + path.string() + ": " + e.code().message());
  }
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

void put_in_place(const std::filesystem::path& part, const std::filesystem::path& path) {
  std::filesystem::rename(part, path);
  sync_path(folder_of(path), O_RDONLY | O_DIRECTORY);
}

}  // namespace

void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write) {
  const std::filesystem::path part = path.string() + ".part";
  try {
    named(path, [&] {
      std::filesystem::create_directories(folder_of(path));
      std::filesystem::remove(part);  // a pipe of that name would be waited for
      write(part);
      sync_path(part, O_RDONLY);
      put_in_place(part, path);
    });
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

void replace_file(const std::filesystem::path& path, MPI_Comm comm,
                  const std::function<void(const std::filesystem::path&)>& begin,
                  const std::function<void(const std::filesystem::path&)>& together) {
  const std::filesystem::path part = path.string() + ".part";
  const bool first = core::rank_of(comm) == 0;
  try {
    core::agree(comm, [&] {
      if (first)
        named(path, [&] {
          std::filesystem::create_directories(folder_of(path)), std::filesystem::remove(part), begin(part);
        });
    });
    together(part);
    // Each rank's own pages: another computer may hold them.
    core::agree(comm, [&] { sync_path(part, O_RDONLY); });
    core::agree(comm, [&] {
      if (first) named(path, [&] { put_in_place(part, path); });
    });
  } catch (...) {
    std::error_code ignored;
    if (first) std::filesystem::remove(part, ignored);
    MPI_Barrier(comm);  // errors are agreed: all ranks are here, and none finds it any more
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
