#include "whirl/io/record.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "io/temporary.hpp"
#include "whirl/core/error.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/io/table.hpp"

using namespace whirl;
using namespace whirl::io;

namespace {

Group example() {
  Group g;
  describe_results(g, "Rotor in Öl", "0.1.0");
  g.set("tolerance", 1e-300);
  g.set("steps", std::int64_t{1} << 60);
  Group& s = g.child("studies").child("balanced, 2nd");
  s.set("kind", "equilibrium_branch");
  s.set("empty", "");
  s.put("pressure", {2, 3}, {1, 2, 3, 4, 5, 6.5}, "Pa", "film pressure");
  s.put("nodes", std::vector<std::int64_t>{1, -7, std::int64_t{1} << 62}, "node numbers");
  s.put("bearings", std::vector<std::string>{"B1", "", "Lager \xc3\x84"}, "names");
  s.put("nothing", std::vector<double>{}, "m", "no points yet");
  s.put("no_names", std::vector<std::string>{}, "no names yet");
  s.put("scalar", Dataset{{}, std::vector<double>{-0.0}, "rad/s", "one number"});
  s.put("cube", {0, 4, 2}, {}, "1", "no rows");
  s.put("extremes", {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::denorm_min(), 0.1}, "1", "");
  return g;
}

}  // namespace

TEST(Record, RoundTripThroughHdf5IsExact) {
  const test::Temporary folder;
  const Group g = example();
  write_hdf5(folder / "deep/results.h5", g);
  const Group back = read_hdf5(folder / "deep/results.h5");
  EXPECT_EQ(g, back);
  EXPECT_EQ(checksum(g), checksum(back));
  EXPECT_TRUE(std::signbit(back.group("studies").group("balanced, 2nd").reals("scalar")[0]));
  EXPECT_EQ(back.integer("steps"), std::int64_t{1} << 60);
}

TEST(Record, NothingButTheFileIsLeft) {
  const test::Temporary folder;
  write_hdf5(folder / "a.h5", example());
  write_hdf5(folder / "a.h5", example());
  int files = 0;
  for ([[maybe_unused]] const auto& f : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1);
}

// What is left in a file is copied from there as often as the tree is written, and read on demand.
TEST(Record, ContentsLeftInAFileAreCopied) {
  const test::Temporary folder;
  Group inner = example().group("studies").group("balanced, 2nd");
  Group whole;
  whole.child("state").child("studies").child("s") = inner;
  write_hdf5(folder / "variant.h5", whole);
  Group root;
  root.child("studies").child("sweep").child("variants").child("a").set("title", "a");
  Group& a = root.child("studies").child("sweep").child("variants").child("a");
  leave_in_file(a, folder / "variant.h5", "state/studies");
  EXPECT_TRUE(is_left(a));
  for (int k = 0; k < 2; ++k) {  // the second time from the file that is replaced
    write_hdf5(folder / "results.h5", root);
    moved_to(root, folder / "results.h5");
    if (k == 0) std::filesystem::remove(folder / "variant.h5");
    const Group back = read_hdf5(folder / "results.h5").group("studies").group("sweep").group("variants").group("a");
    EXPECT_EQ(back.group("s"), inner);
    EXPECT_EQ(back.text("title"), "a");
    EXPECT_EQ(back.attributes().size(), 1U);
    EXPECT_EQ(with_contents(root.group("studies").group("sweep").group("variants").group("a")), back);
  }
  // A run that goes on leaves them there, too.
  root = read_hdf5(folder / "results.h5", MPI_COMM_SELF, "variants");
  EXPECT_TRUE(is_left(root.group("studies").group("sweep").group("variants").group("a")));
  write_hdf5(folder / "again.h5", root);
  EXPECT_EQ(read_hdf5(folder / "again.h5"), read_hdf5(folder / "results.h5"));
  std::filesystem::remove(folder / "results.h5");
  EXPECT_THROW(write_hdf5(folder / "none.h5", root), core::Error);
}

TEST(Record, AFailedWriteLeavesTheOldFile) {
  const test::Temporary folder;
  Group old;
  old.set("age", "old");
  write_hdf5(folder / "a.h5", old);
  // A folder in the place of the temporary file makes the new one impossible, also for root.
  std::filesystem::create_directories(folder / "a.h5.part" / "in the way");
  EXPECT_THROW(write_hdf5(folder / "a.h5", example()), core::Error);
  EXPECT_EQ(read_hdf5(folder / "a.h5"), old);
}

TEST(Record, ReadingSaysWhatIsWrong) {
  const test::Temporary folder;
  EXPECT_THROW((void)read_hdf5(folder / "none.h5"), core::Error);
  std::ofstream(folder / "text.h5") << "not HDF5 at all";
  try {
    (void)read_hdf5(folder / "text.h5");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("text.h5"), std::string::npos) << e.what();
  }
}

TEST(Record, ChecksumSeesEveryChange) {
  const Group g = example();
  const auto changed = [&](const auto& change) {
    Group h = g;
    change(h.child("studies").child("balanced, 2nd"));
    return checksum(h) != checksum(g);
  };
  EXPECT_TRUE(changed([](Group& s) { s.put("pressure", {3, 2}, {1, 2, 3, 4, 5, 6.5}, "Pa", "film pressure"); }));
  EXPECT_TRUE(changed([](Group& s) { s.put("pressure", {2, 3}, {1, 2, 3, 4, 5, 6.6}, "Pa", "film pressure"); }));
  EXPECT_TRUE(changed([](Group& s) { s.put("pressure", {2, 3}, {1, 2, 3, 4, 5, 6.5}, "kPa", "film pressure"); }));
  EXPECT_TRUE(changed([](Group& s) { s.put("scalar", Dataset{{}, std::vector<double>{0.0}, "rad/s", "one number"}); }));
  EXPECT_TRUE(changed([](Group& s) { s.child("more"); }));
  EXPECT_TRUE(changed([](Group& s) { s.set("empty", " "); }));
}

TEST(Record, MisuseIsABugAndAMissingEntryAnError) {
  Group g;
  EXPECT_THROW(g.put("a/b", {1.0}, "m", ""), core::Bug);
  EXPECT_THROW(g.put("x", {2, 2}, {1, 2, 3}, "m", ""), core::Bug);
  EXPECT_THROW((void)g.reals("x"), core::Error);
  g.put("x", {1.0}, "m", "");
  EXPECT_THROW((void)g.strings("x"), core::Error);
  EXPECT_THROW(g.child("x"), core::Bug);
  EXPECT_EQ(safe_name("0.5/1"), "0.5_1");
  EXPECT_EQ(safe_name(""), "_");
}

namespace {

// Ends the process with 4 if the refusal is told and leaves nothing behind.
[[noreturn]] void write_without_room(const std::filesystem::path& path, const Group& large) {
  (void)::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100000, 100000};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) std::exit(5);
  try {
    write_hdf5(path, large);
  } catch (const core::Error& e) {
    if (e.what() != "cannot write " + path.string() + ": File too large") std::exit(6);
    std::exit(std::filesystem::exists(path.string() + ".part") ? 7 : 4);
  }
  std::exit(0);
}

}  // namespace

// A limit on the size of files stands for a full disk. The process goes on, and ends in order: HDF5's own end included.
TEST(RecordDeathTest, AFullDiskIsAnErrorAndNoFault) {
  const test::Temporary folder;
  const auto path = folder / "results.h5";
  Group small, large;
  small.put("x", std::vector<double>(10, 1.0), "m", "");
  large.put("x", std::vector<double>(100000, 1.0), "m", "");
  write_hdf5(path, small);
  EXPECT_EXIT(write_without_room(path, large), testing::ExitedWithCode(4), "");
  EXPECT_EQ(read_hdf5(path), small);
}

TEST(Table, ColumnsBecomeDatasets) {
  Table t({{"parameter", "rpm", "speed"}, {"x", "m", "position per bearing", {2}}});
  t.append({{1000.0}, {1, 2}});
  t.append({{2000.0}, {3, 4}});
  t.append({{3000.0}, {5, 6}});
  EXPECT_THROW(t.append({{3000.0}, {5, 6, 7}}), core::Bug);
  t.truncate(2);
  Group g;
  t.write(g);
  EXPECT_EQ(g.dataset("x").shape, (Shape{2, 2}));
  EXPECT_EQ(g.dataset("x").unit, "m");
  EXPECT_EQ(g.reals("x"), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(g.reals("parameter"), (std::vector<double>{1000, 2000}));

  Table again(t.columns());
  again.read(g);
  EXPECT_EQ(again.rows(), 2u);
  EXPECT_EQ(again.column("x"), t.column("x"));
  Table other({{"parameter", "rpm", "speed"}, {"x", "m", "position per bearing", {3}}});
  EXPECT_THROW(other.read(g), core::Error);
  EXPECT_EQ(other.rows(), 0u);
}

TEST(Table, RowsOfSingleNumbers) {
  Table t({{"a", "1", ""}, {"b", "1", ""}});
  t.append({1.0, 2.0});
  t.append({3.0, 4.0});
  EXPECT_EQ(t.column("b"), (std::vector<double>{2, 4}));
  EXPECT_THROW(t.append({1.0}), core::Bug);
}
