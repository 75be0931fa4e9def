#include "yaml_fault.hpp"

#include <fmt/core.h>
#include <yaml-cpp/exceptions.h>

#include <algorithm>
#include <vector>

namespace whirl::deck {
namespace {

constexpr std::string_view one_column = "keys of one map and items of one list begin in one column";

// A line without its comment.
struct Line {
  std::string_view text;   // without spaces at its ends
  std::size_t indent = 0;  // of the text
  [[nodiscard]] bool is_item() const { return text == "-" || text.starts_with("- "); }
  [[nodiscard]] int column() const { return static_cast<int>(indent) + 1; }
};

// Whether `c` at `k` begins something: a quote or a bracket within a word is text.
bool begins(std::string_view text, std::size_t k) {
  while (k > 0 && text[k - 1] == ' ') --k;
  if (k == 0 || std::string_view(":,[{-\n").find(text[k - 1]) != std::string_view::npos) return true;
  constexpr std::size_t longest = 60;
  std::size_t word = k;
  while (word > 0 && k - word < longest && std::string_view(" \n").find(text[word - 1]) == std::string_view::npos)
    --word;
  return text[word] == '&' || text.substr(word, 2) == "[&" || text.substr(word, 2) == "{&";
}

// The text with comments and quoted values blotted out, at the same places.
std::string bare(std::string_view text) {
  std::string out(text);
  for (std::size_t k = 0; k < out.size(); ++k) {
    std::size_t end = k;
    if (out[k] == '#' && (k == 0 || out[k - 1] == ' ' || out[k - 1] == '\n'))
      end = std::min(out.find('\n', k), out.size());
    else if ((out[k] == '"' || out[k] == '\'') && begins(out, k))
      end = std::min(out.find(out[k], k + 1), out.size() - 1) + 1;
    const char blot = out[k] == '#' ? ' ' : 'x';
    for (std::size_t i = k; i < end; ++i)
      if (out[i] != '\n') out[i] = blot;
    k = std::max(k + 1, end) - 1;
  }
  return out;
}

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t first = line.find_first_not_of(' '), last = line.find_last_not_of(" \r");
    if (first == std::string_view::npos || last == std::string_view::npos || last < first)
      lines.push_back({{}, line.size()});
    else
      lines.push_back({line.substr(first, last + 1 - first), first});
  }
  return lines;
}

// The colon behind a key.
std::size_t colon(std::string_view text) {
  const std::size_t k = text.find(": ");
  return k != std::string_view::npos ? k : text.ends_with(':') ? text.size() - 1 : k;
}

struct Bracket {
  char opens = 0;  // 0: none is open
  int line = 0, column = 0;
};

// The innermost bracket that is open before a place.
Bracket open_before(const std::string& text, int line, int column) {
  std::vector<Bracket> open;
  int l = 0, c = 0;
  for (std::size_t k = 0; k < text.size() && (l < line || (l == line && c < column)); ++k, ++c) {
    const char x = text[k];
    if (x == '\n') ++l, c = -1;
    if ((x == '{' || x == '[') && (!open.empty() || begins(text, k))) open.push_back({x, l, c});
    if (!open.empty() && x == (open.back().opens == '{' ? '}' : ']')) open.pop_back();
  }
  return open.empty() ? Bracket{} : open.back();
}

class Search {
public:
  Search(std::string_view text, int line, int column)
      : source_(lines_of(text)), bare_(bare(text)), lines_(lines_of(bare_)), line_(line), column_(column) {
    if (line_ < static_cast<int>(lines_.size())) here_ = lines_[static_cast<std::size_t>(line_)];
    above_ = line_above(line_);
  }

  // Of "illegal map value": a colon where no key can stand.
  [[nodiscard]] YamlFault second_colon() const {
    const std::size_t before = static_cast<std::size_t>(column_) > here_.indent ? column_ - here_.indent : 0;
    if (colon(here_.text) < before)
      return here(open_before(bare_, line_, column_).opens
                      ? "a second colon: a comma is missing before its key, or quotes around a value with ': '"
                      : "a second colon: a value with ': ' in it needs quotes");
    if (above_ < 0) return here("a colon where no key can stand");
    const Line& above = lines_[static_cast<std::size_t>(above_)];
    const int parent = line_above(above_);
    const bool goes_on =
        parent >= 0 && has_value(parent) && lines_[static_cast<std::size_t>(parent)].indent < above.indent;
    if (colon(above.text) == std::string_view::npos && !goes_on) return no_key(above_);
    if (here_.indent > above.indent || goes_on)
      return here(fmt::format("this line is indented more than line {}, which has a value already: {}",
                              (goes_on ? parent : above_) + 1, one_column));
    return here("a colon where no key can stand: is the line above it complete, and the indentation right?");
  }

  // Of "end of map not found" and "end of sequence not found".
  [[nodiscard]] YamlFault wrong_column() const {
    if (above_ < 0 || here_.text.empty()) return here(fmt::format("wrong indentation: {}", one_column));
    const Line& above = lines_[static_cast<std::size_t>(above_)];
    if (above.indent == here_.indent && above.is_item() && !here_.is_item())
      return here(
          fmt::format("a key among the items of a list: is '- ' missing before it, or is it indented too far?"));
    if (above.indent == here_.indent && !above.is_item() && here_.is_item())
      return here("an item of a list among the keys of a map: is its '- ' wrong, or is it indented too little?");
    if (above.indent == here_.indent && colon(above.text) == std::string_view::npos) return no_key(above_);
    return here(fmt::format("wrong indentation: this line begins in column {}, line {} in column {}; {}",
                            here_.column(), above_ + 1, above.column(), one_column));
  }

  // Of a list or map in brackets.
  [[nodiscard]] YamlFault bracket(const std::string& complaint) const {
    const Bracket open = open_before(bare_, line_, column_);
    const char closes = open.opens == '{' ? '}' : ']';
    if (!open.opens) return here(fmt::format("'{}' closes nothing: is there one too many?", character()));
    if (character() == ']' || character() == '}')
      return here(fmt::format("'{}' is missing before '{}': it closes the '{}' of line {}, column {}", closes,
                              character(), open.opens, open.line + 1, open.column + 1));
    if (complaint == YAML::ErrorMsg::FLOW_END) return here(complaint);
    const bool same = open.line == line_;
    if (same && character() == ':') return second_colon();
    return {open.line + 1, open.column + 1,
            same ? fmt::format("'{}' is not closed: is '{}' missing, or a comma before column {}?", open.opens, closes,
                               column_ + 1)
                 : fmt::format("'{}' is not closed before line {}: is '{}' missing, or a comma?", open.opens, line_ + 1,
                               closes)};
  }

  [[nodiscard]] YamlFault here(std::string message) const {
    return {std::max(line_, 0) + 1, std::max(column_, 0) + 1, std::move(message)};
  }

private:
  // The nearest line above that says something; -1: none.
  [[nodiscard]] int line_above(int line) const {
    do --line;
    while (line >= 0 &&
           (line >= static_cast<int>(lines_.size()) || lines_[static_cast<std::size_t>(line)].text.empty()));
    return line;
  }
  [[nodiscard]] bool has_value(int line) const {
    const std::string_view text = lines_[static_cast<std::size_t>(line)].text;
    const std::size_t k = colon(text);
    return k != std::string_view::npos && k + 1 < text.size();
  }
  [[nodiscard]] YamlFault no_key(int line) const {
    const Line& l = lines_[static_cast<std::size_t>(line)];
    const std::string_view text =
        source_[static_cast<std::size_t>(line)].text.substr(0, std::min<std::size_t>(l.text.size(), 60));
    const bool close = l.text.find(':') != std::string_view::npos;
    return {line + 1, l.column(),
            fmt::format("'{}' is no key with a value: {} is missing", text,
                        close ? "the space behind the colon" : "a colon with a space behind it")};
  }
  [[nodiscard]] char character() const {
    const std::size_t k = static_cast<std::size_t>(column_) - here_.indent;
    return k < here_.text.size() ? here_.text[k] : ' ';
  }

  std::vector<Line> source_;
  std::string bare_;
  std::vector<Line> lines_;  // of `bare_`
  int line_, column_;
  Line here_;
  int above_ = -1;
};

}  // namespace

std::string anchor_at(std::string_view text, int line, int column) {
  for (; line > 0 && !text.empty(); --line)
    text.remove_prefix(std::min(text.size(), text.find('\n')) + (text.find('\n') != std::string_view::npos));
  text = text.substr(std::min(text.size(), static_cast<std::size_t>(std::max(column, 0))));
  if (text.empty() || (text[0] != '*' && text[0] != '&')) return {};
  return std::string(text.substr(1, std::min(text.find_first_of(" \t\r\n,[]{}"), text.size()) - 1));
}

YamlFault yaml_fault(std::string_view text, int line, int column, const std::string& complaint) {
  using namespace YAML::ErrorMsg;
  const Search search(text, line, column);
  if (complaint == MAP_VALUE) return search.second_colon();
  if (complaint == END_OF_MAP || complaint == END_OF_SEQ) return search.wrong_column();
  if (complaint == END_OF_MAP_FLOW || complaint == END_OF_SEQ_FLOW || complaint == FLOW_END)
    return search.bracket(complaint);
  if (complaint == BLOCK_ENTRY)
    return search.here("'- ' cannot stand here: an item of a list begins on a line of its own");
  return search.here(complaint);
}

}  // namespace whirl::deck
