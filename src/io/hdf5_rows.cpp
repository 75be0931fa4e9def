// Files into which each rank writes the rows of datasets that it holds.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>

#include "io/atomic_file.hpp"
#include "io/hdf5_handle.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::io {
namespace {

std::size_t bytes_of_shared(const Group& root) {
  std::size_t bytes = 0;
  each_shared(root, [&](const std::string&, const Dataset& data) {
    std::size_t n = sizeof(double);
    for (const std::size_t extent : data.whole_shape()) n *= extent;
    bytes += n;
  });
  return bytes;
}

// HDF5 gives the datasets their room behind the image; what it changes of the rest stands within the image.
constexpr std::size_t to_spare = 1 << 16;

// The tree without the rows, and room on the disk for these: where there is none, this is where it is said. HDF5 cuts
// off what it does not need.
void make_room(const std::filesystem::path& part, const Group& root) {
  const std::string bytes = image_of(root);
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out << bytes;
  out.close();
  int why = out ? 0 : errno;
  if (why == 0) {
    const int fd = ::open(part.c_str(), O_WRONLY);
    why =
        fd < 0 ? errno : ::posix_fallocate(fd, 0, static_cast<off_t>(bytes.size() + bytes_of_shared(root) + to_spare));
    if (fd >= 0) ::close(fd);
    if (why == EINVAL || why == EOPNOTSUPP) why = 0;  // a file system that promises nothing
  }
  if (why != 0) throw core::Error(std::strerror(why));
}

// The file is opened, changed and closed by all ranks, but each writes its rows by itself: they are one piece, of which
// a collective transfer would make copies on other ranks, and where one rank's writing failed it would leave the others
// waiting for ever.
void write_rows(MPI_Comm comm, const std::filesystem::path& part, const Group& root) {
  std::optional<File> file;
  core::agree(comm, [&] {
    const List how(unlocked());
    check(H5Pset_fapl_mpio(how, comm, MPI_INFO_NULL));
    file.emplace(H5Fopen(part.c_str(), H5F_ACC_RDWR, how));
  });
  each_shared(root, [&](const std::string& path, const Dataset& data) {
    core::agree(comm, [&] {
      const List how(H5Pcreate(H5P_DATASET_XFER));
      check(H5Pset_dxpl_mpio(how, H5FD_MPIO_INDEPENDENT));
      const Data d(H5Dopen2(*file, path.c_str(), H5P_DEFAULT));
      const Space there(H5Dget_space(d));
      select_rows(there, data.share->begin, data.shape.front());
      const std::vector<hsize_t> extents(data.shape.begin(), data.shape.end());
      const Space here(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr));
      if (data.size() == 0) check(H5Sselect_none(here));
      const auto* reals = std::get_if<std::vector<double>>(&data.values);
      if (reals)
        check(H5Dwrite(d, H5T_NATIVE_DOUBLE, here, there, how, reals->data()));
      else
        check(H5Dwrite(d, H5T_NATIVE_INT64, here, there, how, std::get<std::vector<std::int64_t>>(data.values).data()));
    });
  });
  core::agree(comm, [&] { file->close(); });
}

// Counts of messages are int: more numbers than that go in several.
constexpr std::uint64_t most_at_once = 1 << 28;

template <class T>
std::vector<T> gather(const std::vector<T>& here, std::size_t begin, std::size_t total, MPI_Datatype type,
                      MPI_Comm comm) {
  std::vector<T> all(total);
  std::copy(here.begin(), here.end(), all.begin() + static_cast<std::ptrdiff_t>(begin));
  for (int rank = 0; rank < core::size_of(comm); ++rank) {
    std::array<std::uint64_t, 2> run{begin, here.size()};
    MPI_Bcast(run.data(), 2, MPI_UINT64_T, rank, comm);
    for (std::uint64_t done = 0; done < run[1]; done += most_at_once)
      MPI_Bcast(all.data() + run[0] + done, static_cast<int>(std::min(most_at_once, run[1] - done)), type, rank, comm);
  }
  return all;
}

}  // namespace

void make_whole(Group& root, MPI_Comm comm) {
  std::vector<std::string> shared;
  for (const auto& [name, data] : root.datasets())
    if (data.share) shared.push_back(name);
  for (const std::string& name : shared) {
    const Dataset& data = root.dataset(name);
    std::size_t row = 1;
    for (std::size_t axis = 1; axis < data.shape.size(); ++axis) row *= data.shape[axis];
    Dataset whole{data.whole_shape(), {}, data.unit, data.description};
    const std::size_t begin = row * data.share->begin, total = row * data.share->total;
    if (const auto* x = std::get_if<std::vector<double>>(&data.values))
      whole.values = gather(*x, begin, total, MPI_DOUBLE, comm);
    else
      whole.values = gather(std::get<std::vector<std::int64_t>>(data.values), begin, total, MPI_INT64_T, comm);
    root.put(name, std::move(whole));
  }
  for (const auto& [name, sub] : root.groups()) make_whole(root.child(name), comm);
}

void write_hdf5(const std::filesystem::path& path, const Group& root, MPI_Comm comm) {
  if (!is_shared(root))
    return core::agree(comm, [&] {
      if (core::rank_of(comm) == 0) write_hdf5(path, root);
    });
  const Quiet quiet;
  const auto named = [&path](const auto& step) {
    return [&path, step](const std::filesystem::path& part) {
      try {
        step(part);
      } catch (core::Error& e) {
        core::Error whole("cannot write " + path.string() + ": " + e.what());
        if (e.agreed()) whole.mark_agreed();
        throw whole;
      }
    };
  };
  replace_file(path, comm, named([&](const auto& part) { make_room(part, root); }),
               named([&](const auto& part) { write_rows(comm, part, root); }));
}

}  // namespace whirl::io
