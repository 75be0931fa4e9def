#include "paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "known.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {

using core::InputError;

std::vector<std::string> steps_of(std::string_view path) {
  std::vector<std::string> steps(1);
  int depth = 0;
  for (const char c : path) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth < 0 || depth > 1) break;
    if (c == '.' && depth == 0)
      steps.emplace_back();
    else
      steps.back() += c;
  }
  if (depth != 0) throw InputError("the braces of the path do not match");
  if (std::count(path.begin(), path.end(), '{') > 8) throw InputError("the path has more than 8 braces");
  if (std::find(steps.begin(), steps.end(), "") != steps.end()) throw InputError("a step of the path is empty");
  return steps;
}

std::vector<std::string> alternatives(const std::string& step) {
  const std::size_t open = step.find('{'), close = step.find('}');
  if (open == std::string::npos) return {step};
  std::vector<std::string> all;
  std::string_view inside = std::string_view(step).substr(open + 1, close - open - 1);
  while (true) {
    const std::size_t comma = inside.find(',');
    std::string_view word = inside.substr(0, comma);
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    if (word.empty()) throw InputError(fmt::format("a name in '{}' is empty", step));
    if (all.size() > 1000) throw InputError(fmt::format("'{}' stands for more than 1000 names", step));
    for (const std::string& end : alternatives(step.substr(close + 1)))
      all.push_back(step.substr(0, open) + std::string(word) + end);
    if (comma == std::string_view::npos) return all;
    inside.remove_prefix(comma + 1);
  }
}

// A mismatch goes back to the last star only, whose run grows by one character.
bool fits(std::string_view word, std::string_view pattern) {
  std::size_t w = 0, p = 0, after_star = std::string_view::npos, run_end = 0;
  while (w < word.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p;
      run_end = w;
    } else if (p < pattern.size() && pattern[p] == word[w]) {
      ++p;
      ++w;
    } else if (after_star != std::string_view::npos) {
      p = after_star;
      w = ++run_end;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

namespace {

using Path = std::vector<std::string>;

Path joined(std::span<const std::string> before, const std::string& step) {
  Path all(before.begin(), before.end());
  all.push_back(step);
  return all;
}

// What a description knows of a path; nothing where there is no such option.
std::optional<Leaf> known(const Structure& structure, std::span<const std::string> path, const Node& root) {
  try {
    return leaf_of(structure, nullptr, path, &root);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// The options of the map at a path.
std::vector<std::string> keys_at(const Structure& structure, std::span<const std::string> path, const Node& root) {
  const Structure* map = path.empty() ? &structure : nullptr;
  if (!map)
    if (const auto leaf = known(structure, path, root)) map = leaf->map;
  return map ? map->keys() : std::vector<std::string>{};
}

}  // namespace

std::string meant_path(const Structure& structure, const Node& root, std::span<const std::string> before,
                       const std::string& step, std::span<const std::string> after) {
  constexpr std::size_t most_steps = 3, most_places = 2000;
  const auto hint = [&](const Path& path) {
    Path whole = path;
    whole.insert(whole.end(), after.begin(), after.end());
    return fmt::format(" (did you mean '{}'?)", fmt::join(whole, "."));
  };
  const Node* start = &root;
  for (const std::string& s : before)
    if (start) start = given_part(start, s);
  // Of a list there are items alone.
  const bool list = start && start->kind == Node::Kind::list;
  if (!list &&
      (known(structure, joined(before, step), root) || !nearest(step, keys_at(structure, before, root)).empty()))
    return {};
  struct Place {
    const Node* node;
    Path path;
  };
  std::vector<Place> places;
  if (start) places.push_back({start, Path(before.begin(), before.end())});
  for (std::size_t k = 0; k < places.size() && places.size() < most_places; ++k) {
    const auto [node, path] = places[k];
    if (k > 0 && node->kind != Node::Kind::list)
      if (const auto leaf = known(structure, joined(path, step), root); leaf && !leaf->words.empty())
        return hint(joined(path, step));
    if (path.size() - before.size() == most_steps) continue;
    const bool items = node->kind == Node::Kind::list;
    for (std::size_t i = 0; i < node->items.size(); ++i)
      places.push_back({&node->items[i], joined(path, items ? fmt::format("{}", i + 1) : node->items[i].key)});
  }
  if (!start || start->kind != Node::Kind::map || start->items.size() != 1) return {};
  const Path kind = joined(before, start->items[0].key);
  const std::string near = nearest(step, keys_at(structure, kind, root));
  return near.empty() ? std::string() : hint(joined(kind, near));
}

std::string meant_path(const Structure& structure, const Node& root, std::span<const std::string> path) {
  for (std::size_t i = 0; i < path.size(); ++i)
    if (!known(structure, path.first(i + 1), root))
      return meant_path(structure, root, path.first(i), path[i], path.subspan(i + 1));
  return {};
}

}  // namespace whirl::deck
