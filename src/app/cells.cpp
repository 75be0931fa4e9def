#include "cells.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

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

std::string CellTable::text() const {
  if (rows_.size() < 2) return {};
  constexpr std::size_t indent = 4, gap = 2;
  std::vector<std::size_t> width(rows_[0].size()), shown;
  for (std::size_t c = 0; c < width.size(); ++c) {
    for (const auto& row : rows_) width[c] = std::max(width[c], row[c].size());
    const auto filled = [c](const auto& row) { return row[c] != "-" && !row[c].empty(); };
    if (c > 0 && std::any_of(rows_.begin() + 1, rows_.end(), filled)) shown.push_back(c);
  }
  std::string out;
  auto from = shown.begin();
  do {
    auto to = from;
    std::size_t wide = indent + width[0];
    while (to != shown.end() && (to == from || wide + gap + width[*to] <= widest_line())) wide += gap + width[*to++];
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const auto& row = rows_[r];
      std::string line = fmt::format("{:{}}{:<{}}", "", indent, row[0], width[0]);
      for (auto c = from; c != to; ++c) line += fmt::format("{:{}}{:>{}}", "", gap, row[*c], width[*c]);
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
      if (to == shown.end() && !remarks_[r].empty()) out += in_lines(remarks_[r], 2 * indent);
    }
    from = to;
  } while (from != shown.end());
  return out;
}

}  // namespace whirl::app
