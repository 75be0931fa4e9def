// From files and arguments to one tree: YAML, tables, bases, overrides.

#include "whirl/deck/load.hpp"
#include "source_dir.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "whirl/core/error.hpp"
#include "whirl/deck/output.hpp"

using namespace whirl;
namespace fs = std::filesystem;

namespace {

const deck::Files files(MPI_COMM_SELF);

// A directory for the files of one test.
class Folder : public ::testing::Test {
protected:
  Folder() : path_(fs::temp_directory_path() / ("whirl_deck_" + std::to_string(::getpid()))) {
    fs::create_directories(path_ / "below");
  }
  ~Folder() override { fs::remove_all(path_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  const fs::path path_;
};

template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "accepted";
}

std::string yaml_refusal(const std::string& text) {
  return refusal([&] { (void)deck::parse_yaml(text, "d.yaml"); });
}

}  // namespace

TEST(Yaml, EveryValueKnowsItsPlace) {
  const deck::Node n = deck::parse_yaml("a: 1\nb:\n  - x\n  - {c: 'two words'}\n", "d.yaml");
  EXPECT_EQ(n.find("a")->place.text(), "d.yaml:1:4");
  EXPECT_EQ(n.find("b")->key_place.text(), "d.yaml:2:1");
  EXPECT_EQ(n.find("b")->items[1].find("c")->place.text(), "d.yaml:4:9");
  EXPECT_EQ(n.find("b")->items[1].find("c")->text, "two words");
  EXPECT_TRUE(n.find("b")->items[1].find("c")->quoted);
}

TEST(Yaml, AliasesAreCopiesAtTheirOwnPlace) {
  const deck::Node n = deck::parse_yaml("a: &x {b: 1}\nc: *x\n", "d.yaml");
  EXPECT_EQ(n.find("c")->place.text(), "d.yaml:2:4");
  EXPECT_EQ(n.find("c")->find("b")->text, "1");
  EXPECT_EQ(n.find("c")->key, "c");
}

TEST(Yaml, WhatItsParserWouldLetPass) {
  EXPECT_EQ(yaml_refusal("a: 1\na: 2\n"), "d.yaml:2:1: key 'a' is given twice, first in line 1");
  EXPECT_EQ(yaml_refusal("a: &x [1, *x]\n"), "d.yaml:1:11: an alias cannot stand inside the value that it names");
  EXPECT_EQ(yaml_refusal("a: 1\n--- \nb: 2\n"), "d.yaml:3:1: there is a second document; a deck is one document");
  EXPECT_EQ(yaml_refusal("a:\n\tb: 1\n"), "d.yaml:2:1: a tab in the indentation; use spaces");
  EXPECT_NE(yaml_refusal("a: {<<: {b: 1}}\n").find("merge keys"), std::string::npos);
  EXPECT_NE(yaml_refusal("[1, 2]: 3\n").find("a key must be a single word"), std::string::npos);
  EXPECT_NE(yaml_refusal(std::string(201, 'a') + ": 1\n").find("a key of 201 bytes"), std::string::npos);
  EXPECT_EQ(yaml_refusal(std::string(200, 'a') + ": 1\n"), "accepted");
  EXPECT_NE(yaml_refusal("a: !!int 3\n").find("tags"), std::string::npos);
  EXPECT_NE(yaml_refusal("a: *nowhere\n"), "accepted");
  EXPECT_NE(yaml_refusal("a: [1, 2\n"), "accepted");
  EXPECT_EQ(deck::parse_yaml("# nothing\n", "d.yaml").kind, deck::Node::Kind::none);
}

// The parser stops where it cannot go on: the fault is often in the line above.
TEST(Yaml, TheLineOfAFaultAndWhatIsLikelyWrong) {
  struct Case {
    const char *text, *place, *words;
  };
  const Case cases[] = {
      // A missing colon or space.
      {"a:\n  node 5\n  b: 1\n", "2:3", "'node 5' is no key with a value: a colon with a space behind it is missing"},
      {"a:\n  node:5  # five\n\n  b: 1\n", "2:3",
       "'node:5' is no key with a value: the space behind the colon is missing"},
      {"a: 1\nspeed 3\nb: 1\n", "2:1", "'speed 3' is no key with a value: a colon"},
      {"a:\n  - static\n    speed: 1\n", "2:3", "'- static' is no key with a value: a colon"},
      // A colon inside a plain value.
      {"title: A fan: a trial\n", "1:13", "a value with ': ' in it needs quotes"},
      {"a: 1\n'title': A fan: a trial\n", "2:15", "a value with ': ' in it needs quotes"},
      // Indentation.
      {"a:\n  b: 1\n   c: 2\n", "3:5", "indented more than line 2, which has a value already"},
      {"title: A fan\n  of ours\n  b: 1\n", "3:4", "indented more than line 1, which has a value already"},
      {"a:\n    b: 1\n  c: 2\n", "3:3", "begins in column 3, line 2 in column 5"},
      {"a:\n  - b: 1\n   - c: 2\n", "3:4", "begins in column 4, line 2 in column 3"},
      {"a:\n  - b\n  c: 2\n", "3:3", "is '- ' missing before it"},
      {"a:\n  b: 1\n  - c\n", "3:3", "an item of a list among the keys of a map"},
      {"a: - b\n", "1:4", "an item of a list begins on a line of its own"},
      // Brackets: those in quotes and comments are none.
      {"# {\nt: '{['\na: {b: 1, c: 2\nd: 3\n", "3:4", "'{' is not closed before line 4: is '}' missing, or a comma?"},
      {"a: [1, 2\n", "1:4", "'[' is not closed"},
      {"a: [&s {b: 1, *s]\n", "1:17", "'}' is missing before ']'"},
      {"a: [&s {b: 1, c: 2]\n", "1:19", "'}' is missing before ']': it closes the '{' of line 1, column 8"},
      {"a: {b: 1}}\n", "1:10", "'}' closes nothing"},
      {"a: {b: 1 c: 2}\n", "1:11", "a comma is missing"},
  };
  for (const auto& [text, place, words] : cases) {
    const std::string said = yaml_refusal(text);
    EXPECT_TRUE(said.starts_with(std::string("d.yaml:") + place + ": ")) << text << said;
    EXPECT_NE(said.find(words), std::string::npos) << text << said;
  }
}

TEST(Yaml, AnAliasOfNothingIsNamed) {
  EXPECT_EQ(yaml_refusal("a: &bore {b: 1}\nc: {d: *bor}\n"),
            "d.yaml:2:8: '*bor' repeats a value that '&bor' names, but there is no '&bor' above it (did you mean "
            "'bore'?)");
  EXPECT_EQ(
      yaml_refusal("a: &x 1\nb: &y 2\nc:\n  - *there\n"),
      "d.yaml:4:5: '*there' repeats a value that '&there' names, but there is no '&there' above it; there are x, y");
  EXPECT_EQ(yaml_refusal("a: *nowhere\n"),
            "d.yaml:1:4: '*nowhere' repeats a value that '&nowhere' names, but there is no '&nowhere' above it");
}

TEST(Yaml, AliasesOfAliasesDoNotFillTheMemory) {
  std::string text = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 9; ++k) text += before + (k < 8 ? ", " : "]\n");
  }
  EXPECT_NE(yaml_refusal(text).find("more than 300000 values once its aliases are expanded"), std::string::npos);
}

TEST(Yaml, WrittenTreesReadBack) {
  const std::string text =
      "a: plain words\nb: \"yes: # no\"\nc: [1, -2.5, \"\", \"a, b\"]\nd:\n  - {x: 1 m, y: \"null\"}\n  - e:\n      f: "
      "[]\n";
  const deck::Node n = deck::parse_yaml(text, "d.yaml");
  const std::string once = deck::to_yaml(n);
  EXPECT_EQ(deck::to_yaml(deck::parse_yaml(once, "e.yaml")), once);
  EXPECT_EQ(deck::to_json(deck::parse_yaml(once, "e.yaml")).size() > 0, true);
}

TEST(Table, HeaderCellsGiveKeysAndUnits) {
  const deck::Node n = deck::parse_table("name,length [m],  mass [kg]\nA, 0.25,3\n\"B, long\",1e-3,\n", "t.csv");
  ASSERT_EQ(n.items.size(), 2U);
  EXPECT_EQ(n.items[0].find("length")->text, "0.25 m");
  EXPECT_EQ(n.items[0].find("length")->place.text(), "t.csv:2:4");
  EXPECT_EQ(n.items[0].find("mass")->key_place.text(), "t.csv:1:19");
  EXPECT_EQ(n.items[1].find("name")->text, "B, long");
  EXPECT_EQ(n.items[1].find("mass"), nullptr);
}

TEST(Table, CarriageReturnsAndByteOrderMark) {
  const std::string name = (fs::temp_directory_path() / ("whirl_bom_" + std::to_string(::getpid()) + ".csv")).string();
  std::ofstream(name, std::ios::binary) << "\xEF\xBB\xBFlength [m]\r\n1\r\n2\r\n";
  const deck::Node n = deck::parse_table(files.read_text(name), name);
  fs::remove(name);
  ASSERT_EQ(n.items.size(), 2U);
  EXPECT_EQ(n.items[1].find("length")->text, "2 m");
}

TEST(Table, WhatIsNoTable) {
  auto table_refusal = [](const std::string& text) { return refusal([&] { (void)deck::parse_table(text, "t.csv"); }); };
  EXPECT_EQ(table_refusal("a,b\n1\n"), "t.csv:2:1: 1 cells in a table of 2 columns");
  EXPECT_EQ(table_refusal("a,a\n1,2\n"), "t.csv:1:3: column 'a' is given twice");
  EXPECT_EQ(table_refusal("a [m\n1\n"), "t.csv:1:1: a header cell is written `key [unit]`");
  EXPECT_EQ(table_refusal("a\n"), "t.csv:1:1: the table has no rows");
  EXPECT_EQ(table_refusal("a\n\"1\n"), "t.csv:2:1: a quote is not closed");
}

TEST_F(Folder, BasesMergeAndKeepPlaces) {
  write("base.yaml", "a: {x: 1, y: 2}\nlist: [1, 2, 3]\ngone: 5\n");
  write("below/middle.yaml", "base: ../base.yaml\na: {y: 3}\n");
  const std::string top = write("top.yaml", "base: below/middle.yaml\nlist: [9]\na: {z: 4}\ngone:\nnew: 1\n");
  const deck::Node n = deck::load(top, {}, files);
  EXPECT_EQ(deck::to_yaml(n), "a: {x: 1, y: 3, z: 4}\nlist: [9]\nnew: 1\n");
  EXPECT_EQ(n.find("a")->find("x")->place.text(), (path_ / "base.yaml").string() + ":1:8");
  EXPECT_EQ(n.find("a")->find("y")->place.text(), (path_ / "below/middle.yaml").string() + ":2:8");
}

TEST_F(Folder, BasesThatGoRoundAreRefused) {
  write("a.yaml", "base: b.yaml\n");
  write("b.yaml", "base: c.yaml\n");
  const std::string c = write("c.yaml", "base: a.yaml\n");
  EXPECT_NE(refusal([&] { (void)deck::load(c, {}, files); }).find("go round in a circle"), std::string::npos);
  const std::string self = write("self.yaml", "base: self.yaml\n");
  EXPECT_EQ(refusal([&] { (void)deck::load(self, {}, files); }).find(self + ":1:7: the bases go round"), 0U);
}

TEST_F(Folder, OverridesComeAfterBasesAndTables) {
  write("t.csv", "length [m]\n1\n2\n");
  write("base.yaml", "b: {c: 1 m, list: [{x: 1}, {x: 2}]}\nrows: t.csv\n");
  const std::string top = write("top.yaml", "base: base.yaml\n");
  const deck::Node n = deck::load(
      top, {"b.c=264 um", "b.list.2.x=5", "rows.2.length=7 mm", "new.deep=[60, 16]", "b.empty={}", "b.list.1.x="},
      files);
  EXPECT_EQ(n.find("b")->find("c")->text, "264 um");
  EXPECT_EQ(n.find("b")->find("c")->place.text(), "--set b.c=264 um");
  EXPECT_EQ(n.find("b")->find("list")->items[1].find("x")->text, "5");
  EXPECT_EQ(n.find("b")->find("list")->items[0].items.size(), 0U);
  EXPECT_EQ(n.find("rows")->items[0].find("length")->text, "1 m");
  EXPECT_EQ(n.find("rows")->items[1].find("length")->text, "7 mm");
  EXPECT_EQ(n.find("new")->find("deep")->items.size(), 2U);
}

TEST_F(Folder, WrongOverridesCiteTheArgument) {
  const std::string top = write("top.yaml", "a: 1\nlist: [1, 2]\n");
  auto override_refusal = [&](const std::string& o) { return refusal([&] { (void)deck::load(top, {o}, files); }); };
  EXPECT_EQ(override_refusal("a"), "--set a: expected PATH=VALUE");
  EXPECT_EQ(override_refusal("a.b=1"), "--set a.b=1: 'a' is a value and has no 'b'");
  EXPECT_EQ(override_refusal("list.0=1"), "--set list.0=1: 'list' has items 1 to 2, not '0'");
  EXPECT_EQ(override_refusal("list.3=1"), "--set list.3=1: 'list' has items 1 to 2, not '3'");
  EXPECT_EQ(override_refusal("list.one=1"), "--set list.one=1: 'list' has items 1 to 2, not 'one'");
  EXPECT_EQ(override_refusal("a..b=1").find("--set a..b=1: "), 0U);
  EXPECT_EQ(override_refusal("a=[1").find("--set a=[1: "), 0U);
}

TEST_F(Folder, WhatCannotBeRead) {
  EXPECT_NE(refusal([&] { (void)files.read_text((path_ / "none").string()); }).find("No such file"), std::string::npos);
  EXPECT_NE(refusal([&] { (void)files.read_text(path_.string()); }).find("is a directory"), std::string::npos);
  const std::string large = write("large", std::string((1 << 20) + 1, 'a'));
  EXPECT_NE(refusal([&] { (void)files.read_text(large); }).find("is larger than"), std::string::npos);
  const std::string latin = write("latin", "ok\ncaf\xE9\n");
  EXPECT_EQ(refusal([&] { (void)files.read_text(latin); }), latin + ":2:1: the file is not UTF-8 text");
  const std::string wide = write("wide", std::string("\xFF\xFE"
                                                     "a\0b\0",
                                                     6));
  EXPECT_NE(refusal([&] { (void)files.read_text(wide); }).find("not UTF-8"), std::string::npos);
}

TEST(Files, OneRankReadsForAll) {
  const deck::Files shared(MPI_COMM_WORLD);
  EXPECT_GT(shared.read_text(std::string(WHIRL_SOURCE_DIR) + "/LICENSE").size(), 100U);
  try {
    (void)shared.read_text("nowhere.yaml");
    FAIL();
  } catch (const core::InputError& e) {
    EXPECT_TRUE(e.agreed());
  }
}

TEST(Nearest, IsCloseEnoughToBeMeant) {
  EXPECT_EQ(deck::nearest("clearence", {"radius", "clearance", "length"}), "clearance");
  EXPECT_EQ(deck::nearest("Radius", {"radius", "clearance"}), "radius");
  EXPECT_EQ(deck::nearest("half_sommer", {"half_sommerfeld", "reynolds"}), "half_sommerfeld");
  EXPECT_EQ(deck::nearest("x", {"y", "z"}), "");
  EXPECT_EQ(deck::nearest("banana", {"radius", "clearance"}), "");
}

// A hint mends spelling; it never names another quantity.
TEST(Nearest, IsNoOtherQuantity) {
  for (const char* word : {"c_xx", "m_xx", "k_xz", "kxy"}) EXPECT_EQ(deck::nearest(word, {"k_xx", "k_yy"}), "") << word;
  EXPECT_EQ(deck::nearest("K_xx", {"k_xx", "k_yy"}), "k_xx");
  EXPECT_EQ(deck::nearest("kxx", {"k_yy", "k_xx"}), "k_xx");
  EXPECT_EQ(deck::nearest("stiffness", {"thickness"}), "");
  EXPECT_EQ(deck::nearest("thicknes", {"thickness"}), "thickness");
  EXPECT_EQ(deck::nearest("inner_diameter", {"outer_diameter"}), "");
  EXPECT_EQ(deck::nearest("outer_diametre", {"inner_diameter", "outer_diameter"}), "outer_diameter");
  EXPECT_EQ(deck::nearest("max_speed", {"min_speed"}), "");
  EXPECT_EQ(deck::nearest("speed", {"speeds"}), "speeds");
  EXPECT_EQ(deck::nearest("tilt_damping", {"tilt_stiffness", "damping"}), "");
}
