// Files that all ranks write together.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>
#include <functional>
#include <optional>

#include "io/temporary.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/checkpoint.hpp"
#include "whirl/io/hdf5.hpp"

using namespace whirl;
using namespace whirl::io;

namespace {

const MPI_Comm world = MPI_COMM_WORLD;

// Rank 0's folder for all.
class Shared {
public:
  Shared() {
    std::string name = folder_.path().string();
    MPI_Bcast(name.data(), static_cast<int>(name.size()), MPI_CHAR, 0, world);  // all of the same length
    path_ = name;
  }
  ~Shared() { MPI_Barrier(world); }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] long files() const {
    MPI_Barrier(world);
    return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  }

private:
  test::Temporary folder_;
  std::filesystem::path path_;
};

// Rows [begin, end) of an array of `total` rows of two numbers that tell their places.
template <class T>
Dataset rows(std::size_t begin, std::size_t end, std::size_t total, double factor) {
  std::vector<T> values;
  for (std::size_t i = 2 * begin; i < 2 * end; ++i) values.push_back(static_cast<T>(factor * static_cast<double>(i)));
  return {{end - begin, 2}, std::move(values), "m", "places", RowRange{begin, total}};
}

// A tree with what ranks share. The first rank of several has no rows of the one and most of the other.
Group tree(std::size_t total, double factor, MPI_Comm comm = world) {
  const auto rank = static_cast<std::size_t>(core::rank_of(comm)), size = static_cast<std::size_t>(core::size_of(comm));
  const auto uneven = [&](std::size_t r) { return r == 0 || size == 1 ? total * r : total - (size - r); };
  const auto without = [&](std::size_t r) { return size == 1 ? total * r : r == 0 ? 0 : total * (r - 1) / (size - 1); };
  Group g;
  g.set("step", 3);
  g.put("small", {1.5, 2.5}, "1", "on every rank");
  g.put("first", rows<double>(uneven(rank), uneven(rank + 1), total, factor));
  g.put("rows of nothing",
        {{uneven(rank + 1) - uneven(rank), 0}, std::vector<double>(), "m", "", RowRange{uneven(rank), total}});
  g.child("deep").put("second", rows<std::int64_t>(without(rank), without(rank + 1), total, factor));
  return g;
}

// The same as one rank writes and reads it.
Group whole(std::size_t total, double factor) {
  Group g = tree(total, factor, MPI_COMM_SELF);
  for (Group* at : {&g, &g.child("deep")})
    for (const auto& [name, data] : at->datasets()) {
      Dataset all = data;
      all.share.reset();
      at->put(name, std::move(all));
    }
  return g;
}

void expect_error(const std::function<void()>& work, const std::string& text) {
  try {
    work();
    ADD_FAILURE() << "nothing was said";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    EXPECT_TRUE(e.agreed());
  }
}

// A limit on the size of this process's files stands for a full disk.
class NoRoom {
public:
  explicit NoRoom(rlim_t bytes) : before_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit less{bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &less);
  }
  ~NoRoom() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    (void)::signal(SIGXFSZ, before_);
  }

private:
  sighandler_t before_;
  rlimit limit_{};
};

}  // namespace

TEST(Rows, EachRankWritesItsOwnAndAnybodyReadsThem) {
  const Shared folder;
  const Group g = tree(1000, 0.5);
  write_hdf5(folder / "deep/a.h5", g, world);
  EXPECT_EQ(folder.files(), 1);
  EXPECT_EQ(read_hdf5(folder / "deep/a.h5"), whole(1000, 0.5));

  // As many rows for each rank, in whatever way they were written.
  const Group back = read_hdf5(folder / "deep/a.h5", world);
  const auto rank = static_cast<std::size_t>(core::rank_of(world)),
             size = static_cast<std::size_t>(core::size_of(world));
  const Dataset wanted = rows<double>(1000 * rank / size, 1000 * (rank + 1) / size, 1000, 0.5);
  EXPECT_EQ(back.dataset("first"), wanted);
  EXPECT_EQ(back.reals("small"), g.reals("small"));
  EXPECT_THROW((void)back.reals("first"), core::Error) << "nobody may take some rows for all";
  EXPECT_EQ(checksum(back, world), checksum(g, world));
  EXPECT_EQ(checksum(back, world), checksum(tree(1000, 0.5, MPI_COMM_SELF))) << "whoever holds which rows";
  EXPECT_NE(checksum(back, world), checksum(tree(1000, 0.25), world));

  // Nobody's file is larger than its contents: the room that was kept for it has gone.
  const auto bytes = std::filesystem::file_size(folder / "deep/a.h5");
  EXPECT_LT(bytes, 2 * 1000 * 2 * 8 + 20000U);
}

TEST(Rows, WithoutAnyTheFileIsThatOfOneRank) {
  const Shared folder;
  const Group g = whole(10, 1);
  write_hdf5(folder / "together.h5", g, world);
  EXPECT_EQ(read_hdf5(folder / "together.h5", world), g) << "every rank has all";
  if (core::rank_of(world) == 0) {
    write_hdf5(folder / "alone.h5", g);
    EXPECT_EQ(std::filesystem::file_size(folder / "together.h5"), std::filesystem::file_size(folder / "alone.h5"));
  }
}

TEST(Rows, ACheckpointSurvivesAnotherNumberOfRanks) {
  const Shared folder;
  const Checkpoint c(folder / "branch.h5");
  // Written by one rank and read by all, and the other way round.
  if (core::rank_of(world) == 0) c.save(tree(100, 2, MPI_COMM_SELF), MPI_COMM_SELF);
  MPI_Barrier(world);
  EXPECT_EQ(checksum(c.load(world).state, world), checksum(tree(100, 2), world));
  c.save(tree(100, 3), world);
  EXPECT_EQ(c.load().state, tree(100, 3, MPI_COMM_SELF));
  EXPECT_FALSE(c.load(world).from_previous);
}

TEST(Rows, MayBeMadeWholeAgain) {
  Group g = tree(100, 2);
  make_whole(g, world);
  EXPECT_EQ(g, whole(100, 2));
  EXPECT_EQ(from_bytes(to_bytes(g)), g);
}

// Damage in the rows of one rank makes all of them go back.
TEST(Rows, DamageIsSeenByAllRanks) {
  const Shared folder;
  const Checkpoint c(folder / "branch.h5");
  c.save(tree(1000, 2), world);
  c.save(tree(1000, 3), world);
  if (core::rank_of(world) == 0) {
    std::fstream f(folder / "branch.h5", std::ios::in | std::ios::out | std::ios::binary);
    f.seekp(static_cast<std::streamoff>(std::filesystem::file_size(folder / "branch.h5") - 64));
    f << "damaged!";
  }
  MPI_Barrier(world);
  const Checkpoint::Loaded l = c.load(world);
  EXPECT_TRUE(l.from_previous);
  EXPECT_NE(l.reason.find("damaged"), std::string::npos) << l.reason;
  EXPECT_EQ(checksum(l.state, world), checksum(tree(1000, 2), world));
  MPI_Barrier(world);
  if (core::rank_of(world) == 0)
    for (const char* name : {"branch.h5", "branch.h5.prev"}) std::ofstream(folder / name) << "not HDF5 at all";
  MPI_Barrier(world);
  expect_error([&] { (void)c.load(world); }, "branch.h5.prev");
}

// There is no room for the rows (rank 0 says so before anybody writes), or one rank's writing fails. The old file
// stays, nothing is left beside it, and the process goes on writing.
TEST(Rows, AFullDiskIsAnErrorOfAllRanks) {
  const Shared folder;
  const auto path = folder / "results.h5";
  write_hdf5(path, tree(10, 1), world);
  {
    std::optional<NoRoom> full;
    if (core::rank_of(world) == 0) full.emplace(1000000);
    expect_error([&] { write_hdf5(path, tree(100000, 1), world); }, path.string() + ": File too large");
  }
  if (core::size_of(world) > 1) {
    std::optional<NoRoom> full;
    if (core::rank_of(world) == core::size_of(world) - 1) full.emplace(200000);  // the tree, but not its rows
    testing::internal::CaptureStderr();                                          // of Open MPI
    expect_error([&] { write_hdf5(path, tree(100000, 1), world); }, "cannot write " + path.string());
    (void)testing::internal::GetCapturedStderr();
  }
  EXPECT_EQ(folder.files(), 1);
  EXPECT_EQ(read_hdf5(path), whole(10, 1));
  write_hdf5(path, tree(1000, 1), world);
  EXPECT_EQ(read_hdf5(path), whole(1000, 1));
}

TEST(Rows, MisuseIsABug) {
  Group g;
  EXPECT_THROW(g.put("x", Dataset{{2}, std::vector<double>{1, 2}, "m", "", RowRange{9, 10}}), core::Bug);
  EXPECT_THROW(g.put("x", Dataset{{1}, std::vector<std::string>{"a"}, "", "", RowRange{0, 1}}), core::Bug);
  const Group shared = tree(10, 1, MPI_COMM_SELF);
  EXPECT_THROW((void)to_bytes(shared), core::Bug);
  EXPECT_THROW(write_hdf5("never.h5", shared), core::Bug);
}
