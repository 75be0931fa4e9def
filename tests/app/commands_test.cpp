// Commands that the comments of decks and the pages show: the decks exist, and every `--set` in them is accepted.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "source_dir.hpp"
#include "whirl/core/error.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;

const fs::path root = WHIRL_SOURCE_DIR;

// The text without the marks of comments, in one line.
std::string text_of(const fs::path& path, bool comments_only) {
  std::ifstream file(path);
  std::string line, out;
  while (std::getline(file, line)) {
    const std::size_t mark = line.find_first_not_of(' ');
    const bool comment = mark != std::string::npos && line[mark] == '#';
    if (comments_only && !comment) continue;
    out += (comment ? line.substr(mark + 1) : line) + " ";
  }
  return out;
}

// The overrides of `text`; those with nothing but space, or a line that goes on, between them belong together.
std::vector<std::vector<std::string>> overrides_in(const std::string& text) {
  static const std::regex one(R"re((?:--set\s+)([\w.{},*]+\+?)=("[^"]*"|[^\s"]+))re");
  std::vector<std::vector<std::string>> groups;
  std::size_t end = std::string::npos;
  for (std::sregex_iterator m(text.begin(), text.end(), one), last; m != last; ++m) {
    std::string value = (*m)[2];
    const bool quoted = value.front() == '"';
    if (quoted)
      value = value.substr(1, value.size() - 2);
    else
      while (std::string(".,;:)`").find(value.back()) != std::string::npos) value.pop_back();
    const auto begin = static_cast<std::size_t>(m->position());
    if (end == std::string::npos || text.find_first_not_of(" \\", end) != begin) groups.emplace_back();
    groups.back().push_back((*m)[1].str() + "=" + value);
    end = begin + static_cast<std::size_t>(m->length());
  }
  return groups;
}

void accept(const fs::path& deck, const std::vector<std::string>& overrides) {
  std::string all;
  for (const auto& o : overrides) all += " --set " + o;
  try {
    (void)study::load(MPI_COMM_WORLD, deck.string(), overrides);
  } catch (const core::InputError& e) {
    ADD_FAILURE() << deck << all << ": " << e.what();
  }
}

}  // namespace

TEST(ShownCommands, OverridesInDecksAreAccepted) {
  std::size_t shown = 0;
  for (const auto& e : fs::recursive_directory_iterator(root / "inputs")) {
    if (e.path().extension() != ".yaml") continue;
    const std::string text = text_of(e.path(), true);
    for (const auto& group : overrides_in(text)) {
      accept(e.path(), group);
      ++shown;
    }
    static const std::regex run(R"(whirl run (\S+))");
    for (std::sregex_iterator m(text.begin(), text.end(), run), last; m != last; ++m)
      EXPECT_EQ((*m)[1].str(), fs::relative(e.path(), root).string());
  }
  EXPECT_GE(shown, 10U);
}

TEST(ShownCommands, ThoseOfThePagesAreAccepted) {
  std::size_t shown = 0;
  std::vector<fs::path> pages{root / "README.md"};
  for (const char* folder : {"docs", "inputs"})
    for (const auto& e : fs::recursive_directory_iterator(root / folder))
      if (e.path().extension() == ".md") pages.push_back(e.path());
  static const std::regex command(
      R"re((inputs/[^\s`()\]]+\.yaml)((?:\s+--set\s+[\w.{},*]+\+?=(?:"[^"]*"|[^\s"`]+))*))re");
  for (const auto& page : pages) {
    const std::string text = text_of(page, false);
    for (std::sregex_iterator m(text.begin(), text.end(), command), last; m != last; ++m) {
      const fs::path deck = root / (*m)[1].str();
      if (deck.string().find('*') != std::string::npos) continue;
      const auto groups = overrides_in((*m)[2].str());
      accept(deck, groups.empty() ? std::vector<std::string>{} : groups.front());
      ++shown;
    }
  }
  EXPECT_GE(shown, 2U);
}
