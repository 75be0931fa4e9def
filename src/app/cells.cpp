#include "cells.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>

namespace whirl::app {

namespace {

// The columns of the terminal. mpirun gives its ranks a terminal without a size: scripts/run then tells it by COLUMNS.
// None if the text goes to a file or to another program.
std::optional<std::size_t> terminal_columns() {
  static const std::optional<std::size_t> columns = []() -> std::optional<std::size_t> {
    constexpr std::size_t narrowest = 60, widest = 200;
    winsize size{};
    std::size_t given = 0;
    if (isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) given = size.ws_col;
    if (const char* text = given == 0 ? std::getenv("COLUMNS") : nullptr)
      std::from_chars(text, text + std::strlen(text), given);
    if (given == 0) return std::nullopt;
    return std::clamp(given, narrowest, widest);
  }();
  return columns;
}

}  // namespace

std::size_t widest_line() {
  constexpr std::size_t without_terminal = 100;
  return terminal_columns().value_or(without_terminal);
}

std::string paragraph(const std::string& text, std::size_t indent) {
  return terminal_columns() ? in_lines(text, indent) : fmt::format("{:{}}{}\n", "", indent, text);
}

std::string in_lines(const std::string& text, std::size_t indent) {
  std::string out, line(indent, ' ');
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, to - from);
    if (line.size() + 1 + word.size() > widest_line() && line.find_first_not_of(' ') != std::string::npos) {
      out += line + "\n";
      line.assign(indent + 2, ' ');
    }
    line += (line.find_first_not_of(' ') == std::string::npos ? "" : " ") + word;
    from = to + 1;
  }
  return out + line + "\n";
}

namespace {

bool is_empty(const std::string& cell) {
  return cell.empty() || cell == "-";
}

// 12.5 +- 0.2, (1.2 +- 0.1)e-05, -3, 2 fwd
bool is_number(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of("(+-");
  return first != std::string::npos && std::isdigit(static_cast<unsigned char>(cell[first])) != 0;
}

}  // namespace

std::string CellTable::text() const {
  if (rows_.size() < 2) return {};
  constexpr std::size_t indent = 4, gap = 2;
  std::vector<std::size_t> width(rows_[0].size()), shown;
  std::vector<bool> words(width.size());
  for (std::size_t c = 0; c < width.size(); ++c) {
    for (const auto& row : rows_) width[c] = std::max(width[c], row[c].size());
    words[c] = std::none_of(rows_.begin() + 1, rows_.end(), [c](const auto& row) { return is_number(row[c]); });
    if (c > 0 && !std::all_of(rows_.begin() + 1, rows_.end(), [c](const auto& row) { return is_empty(row[c]); }))
      shown.push_back(c);
  }
  // The columns that tell the rows apart stand in each block.
  std::vector<std::size_t> keys{0};
  const auto told_apart = [&] {
    std::set<std::vector<std::string>> seen;
    return std::all_of(rows_.begin() + 1, rows_.end(), [&](const auto& row) {
      std::vector<std::string> cells;
      for (const std::size_t c : keys) cells.push_back(row[c]);
      return seen.insert(std::move(cells)).second;
    });
  };
  constexpr std::size_t most_keys = 3;
  while (!told_apart() && keys.size() < std::min(most_keys, shown.size())) keys.push_back(shown[keys.size() - 1]);
  const auto wide_with = [&](std::size_t c) {
    std::size_t wide = indent + width[0] + gap + width[c];
    for (auto k = keys.begin() + 1; k != keys.end(); ++k) wide += gap + width[*k];
    return wide;
  };
  const auto leaves_no_room = [&] {
    return std::any_of(shown.begin() + static_cast<std::ptrdiff_t>(keys.size()) - 1, shown.end(),
                       [&](std::size_t c) { return wide_with(c) > widest_line(); });
  };
  if (!told_apart() || leaves_no_room()) keys.resize(1);
  shown.erase(shown.begin(), shown.begin() + static_cast<std::ptrdiff_t>(keys.size() - 1));
  std::size_t narrowest = indent + width[0];
  for (auto c = keys.begin() + 1; c != keys.end(); ++c) narrowest += gap + width[*c];

  std::string out;
  auto from = shown.begin();
  do {
    auto to = from;
    std::size_t wide = narrowest;
    while (to != shown.end() && (to == from || wide + gap + width[*to] <= widest_line())) wide += gap + width[*to++];
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const auto& row = rows_[r];
      const bool goes_on = from == shown.begin() || r == 0 || (to == shown.end() && !remarks_[r].empty()) ||
                           std::any_of(from, to, [&](std::size_t c) { return !is_empty(row[c]); });
      if (!goes_on) continue;
      std::string line = fmt::format("{:{}}{:<{}}", "", indent, row[0], width[0]);
      const auto add = [&](std::size_t c) {
        line += words[c] ? fmt::format("{:{}}{:<{}}", "", gap, row[c], width[c])
                         : fmt::format("{:{}}{:>{}}", "", gap, row[c], width[c]);
      };
      std::for_each(keys.begin() + 1, keys.end(), add);
      std::for_each(from, to, add);
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
      if (to == shown.end() && !remarks_[r].empty()) out += in_lines(remarks_[r], 2 * indent);
    }
    from = to;
  } while (from != shown.end());
  return out;
}

}  // namespace whirl::app
