// Decks that mean harm, or are a slip of a program that wrote them: they end soon, with a message, in little memory.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>

#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/load.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;

struct Item {
  int node = 1;
};
void describe(deck::Description<Item>& d) {
  d.add("node", &Item::node, deck::positive, "node of the item").required();
}
struct Machine {
  std::string title;
  std::map<std::string, Item> items;
  std::vector<Item> rows;
};
void describe(deck::Description<Machine>& d) {
  d.add("title", &Machine::title, "what it is about");
  d.add("items", &Machine::items, "items by name");
  d.table("rows", &Machine::rows, "a table of items");
}

// Reads `name` (text in a folder of its own) as a deck: what is said, and the processor time that it took.
class Hostile : public ::testing::Test {
protected:
  Hostile() : folder_(fs::temp_directory_path() / ("whirl_hostile_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Hostile() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  std::string answer(const std::string& path) {
    const std::clock_t begin = std::clock();
    std::string what = "accepted";
    try {
      const deck::Files files(MPI_COMM_SELF);
      deck::Problems problems;
      (void)deck::read<Machine>(deck::load(path, {}, files), files, problems);
      problems.raise();
    } catch (const core::InputError& e) {
      what = e.what();
    }
    // A second is ten times what each takes; lists walked anew for each of their items took 5 to 25.
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 2.0);
    return what;
  }

  const fs::path folder_;
};

}  // namespace

TEST_F(Hostile, NestedAnchorsAreCountedWithTheirCopies) {
  std::string value = "[1";
  for (int i = 0; i < 20000; ++i) value += ",1";
  value += "]";
  for (int i = 0; i < 479; ++i) value = "&a" + std::to_string(i) + " [" + value + "]";
  EXPECT_NE(answer(write("d.yaml", "title: " + value + "\n")).find("more than 300000 values"), std::string::npos);
}

TEST_F(Hostile, ManyUnknownKeys) {
  std::string text;
  for (int i = 0; i < 95000; ++i) text += "k" + std::to_string(i) + ": 1\n";
  const std::string what = answer(write("d.yaml", text));
  EXPECT_NE(what.find("unknown key 'k0'"), std::string::npos);
  EXPECT_NE(what.find("and 94980 more"), std::string::npos) << what;
}

TEST_F(Hostile, ManyKeysOverABase) {
  std::string text = "base: b.yaml\nitems:\n", below = "items:\n";
  for (int i = 0; i < 40000; ++i) {
    text += "  n" + std::to_string(i) + ": {node: 1}\n";
    below += "  m" + std::to_string(i) + ": {node: 1}\n";
  }
  write("b.yaml", below);
  EXPECT_EQ(answer(write("d.yaml", text)), "accepted");
}

TEST_F(Hostile, ManyColumns) {
  std::string head = "c0", row = "1";
  for (int i = 1; i < 60000; ++i) {
    head += ",c" + std::to_string(i);
    row += ",1";
  }
  write("t.csv", head + "\n" + row + "\n");
  EXPECT_NE(answer(write("d.yaml", "rows: t.csv\n")).find("unknown key 'c0'"), std::string::npos);
}

TEST_F(Hostile, OneTableManyTimes) {
  std::string table = "node\n";
  for (int i = 0; i < 500000; ++i) table += "1\n";
  write("t.csv", table);
  const deck::Files files(MPI_COMM_SELF);
  const auto read_again = [&] {
    for (int i = 0; i < 300; ++i) (void)files.read_text((folder_ / "t.csv").string());
  };
  EXPECT_THROW(read_again(), core::InputError);
}

TEST_F(Hostile, OnlyRegularFilesAreRead) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_NE(answer(write("d.yaml", "base: pipe\n")).find("'" + (folder_ / "pipe").string() + "' is no regular file"),
            std::string::npos);
  EXPECT_NE(answer(write("e.yaml", "base: /dev/zero\n")).find("is no regular file"), std::string::npos);
  EXPECT_NE(answer(write("f.yaml", "base: .\n")).find("is a directory"), std::string::npos);
}

TEST_F(Hostile, BasesOfBases) {
  constexpr int n = 150;
  for (int i = 0; i < n; ++i) write(std::to_string(i) + ".yaml", "base: " + std::to_string(i + 1) + ".yaml\n");
  write(std::to_string(n) + ".yaml", "title: deep\n");
  EXPECT_NE(answer((folder_ / "0.yaml").string()).find("more than 100 bases"), std::string::npos);
  EXPECT_EQ(answer((folder_ / "60.yaml").string()), "accepted");
}

TEST_F(Hostile, WhatIsEchoedIsSafeAndShort) {
  const std::string escape = answer(write("d.yaml", "\"\\e[31mred\\e]0;owned\\a\": 1\n"));
  EXPECT_NE(escape.find(R"(unknown key '\x1b[31mred\x1b]0;owned\x07')"), std::string::npos) << escape;
  const std::string digits = answer(write("e.yaml", "items: {a: {node: " + std::string(900000, '9') + "}}\n"));
  EXPECT_LT(digits.size(), 500U);
  EXPECT_NE(digits.find("'node' must be a whole number"), std::string::npos);
  EXPECT_NE(answer(write("f.yaml", "title: \"\\e[31mred\"\n")).find("'title' holds control characters"),
            std::string::npos);
}

TEST(Printable, NothingReachesTheTerminalThatItWouldActUpon) {
  EXPECT_EQ(core::printable("plain text: 180 \xC2\xB5m\nnext"), "plain text: 180 \xC2\xB5m\nnext");
  EXPECT_EQ(core::printable("\x1b[2J\x7f"), R"(\x1b[2J\x7f)");
  EXPECT_EQ(core::printable("\xff\xc3"), R"(\xff\xc3)");
  EXPECT_EQ(core::printable("\xC2\x9B"), R"(\xc2\x9b)") << "a control character of one byte in other codes";
  EXPECT_EQ(core::printable("a\xE2\x80\xAE"), R"(a\xe2\x80\xae)") << "turns the direction of writing";
  EXPECT_EQ(core::printable("\xED\xA0\x80"), R"(\xed\xa0\x80)") << "half of a pair";
  const std::string word = core::printable(std::string(1000, 'x'));
  EXPECT_LT(word.size(), 200U);
  EXPECT_NE(word.find("more)"), std::string::npos);
  EXPECT_LT(core::printable(std::string(100000, 'x').replace(50, 1, " ")).size(), 500U);
  std::string words;
  for (int i = 0; i < 10000; ++i) words += "ab ";
  EXPECT_LT(core::printable(words).size(), 2100U);
}
