#include "cells.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace whirl::app {

std::size_t widest_line() {
  static const std::size_t columns = [] {
    constexpr std::size_t narrowest = 60, without_terminal = 100, widest = 200;
    winsize size{};
    if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
      return without_terminal;
    return std::clamp<std::size_t>(size.ws_col, narrowest, widest);
  }();
  return columns;
}

std::string number(std::optional<double> value) {
  if (!value) return "-";
  const double size = std::abs(*value);
  if (size != 0 && (size < 1e-3 || size >= 1e6)) return fmt::format("{:.3e}", *value);
  const int before = size == 0 ? 1 : static_cast<int>(std::floor(std::log10(size))) + 1;
  return fmt::format("{:.{}f}", *value, std::max(0, 4 - before));
}

std::string cell_of(const io::Quantity& q, double factor) {
  if (!std::isfinite(q.value)) return "-";
  const auto bar = q.more.find("uncertainty");
  const double error = bar == q.more.end() ? io::no_value : factor * bar->second;
  return std::isfinite(error) && error > 0 ? with_uncertainty(factor * q.value, error, "") : number(factor * q.value);
}

std::string brief_cell(const io::Quantity& q, double factor) {
  constexpr double hidden = 2e-3;
  const auto bar = q.more.find("uncertainty");
  const bool shown = bar != q.more.end() && bar->second > hidden * std::abs(q.value);
  return shown || !std::isfinite(q.value) ? cell_of(q, factor) : fmt::format("{:.4g}", factor * q.value);
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

Values::Values(const io::StudySummary& s) {
  for (const auto& [name, quantity] : s.values) all_[name] = quantity;
}

io::Quantity Values::quantity(const std::string& name) const {
  const auto at = all_.find(name);
  return at == all_.end() ? io::Quantity{} : at->second;
}

std::optional<double> Values::get(const std::string& name) const {
  const auto at = all_.find(name);
  if (at == all_.end() || !std::isfinite(at->second.value)) return std::nullopt;
  return at->second.value;
}

std::string Values::unit(const std::string& name) const {
  const auto at = all_.find(name);
  return at == all_.end() ? "" : at->second.unit;
}

double Values::bar(const std::string& name) const {
  const auto at = all_.find(name);
  if (at == all_.end() || !at->second.more.contains("uncertainty")) return io::no_value;
  return at->second.more.at("uncertainty");
}

std::string Values::cell(const std::string& name, double factor) const {
  const auto at = all_.find(name);
  return at == all_.end() ? "-" : cell_of(at->second, factor);
}

std::string Values::brief(const std::string& name, double factor) const {
  const auto at = all_.find(name);
  return at == all_.end() ? "-" : brief_cell(at->second, factor);
}

std::vector<std::string> Values::between(const io::StudySummary& s, const std::string& head, const std::string& tail) {
  std::vector<std::string> found;
  for (const auto& [name, quantity] : s.values)
    if (name.size() > head.size() + tail.size() && name.starts_with(head) && name.ends_with(tail))
      found.push_back(name.substr(head.size(), name.size() - head.size() - tail.size()));
  return found;
}

std::string Grid::text() const {
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
    for (const auto& row : rows_) {
      std::string line = fmt::format("{:{}}{:<{}}", "", indent, row[0], width[0]);
      for (auto c = from; c != to; ++c) line += fmt::format("{:{}}{:>{}}", "", gap, row[*c], width[*c]);
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    from = to;
  } while (from != shown.end());
  return out;
}

}  // namespace whirl::app
