#include "study/added_branch.hpp"

#include <fmt/core.h>

#include <charconv>

namespace whirl::study {

std::string name_of_doubled(const std::string& name, std::size_t k) {
  return fmt::format("{} flip {}", name, k);
}

std::string name_of_solution(const std::string& name, std::size_t k) {
  return fmt::format("{} solution {}", name, k);
}

std::optional<std::size_t> number_in(std::string_view text, std::string_view like) {
  like.remove_suffix(1);
  if (!text.starts_with(like)) return {};
  text.remove_prefix(like.size());
  std::size_t k = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), k);
  const bool whole = code == std::errc() && end == text.data() + text.size() && !text.starts_with('0');
  return whole ? std::optional(k) : std::nullopt;
}

}  // namespace whirl::study
