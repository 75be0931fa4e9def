#include "whirl/core/printable.hpp"

namespace whirl::core {
namespace {

constexpr std::size_t longest_word = 200, longest_line = 2000;

unsigned char byte(std::string_view text, std::size_t i) noexcept {
  return static_cast<unsigned char>(text[i]);
}

bool continues(std::string_view text, std::size_t i) noexcept {
  return i < text.size() && (byte(text, i) & 0xC0) == 0x80;
}

// Beginning and end of `text`, cut between characters, with the number of bytes left out between them.
void append_short(std::string& out, std::string_view text, std::size_t most) {
  if (text.size() <= most) {
    out += text;
    return;
  }
  std::size_t head = most / 3, tail = text.size() - most / 6;
  while (head > 0 && continues(text, head)) --head;
  while (tail < text.size() && continues(text, tail)) ++tail;
  out += text.substr(0, head);
  out += "...(";
  out += std::to_string(tail - head);
  out += " more)...";
  out += text.substr(tail);
}

std::string escaped(std::string_view text) {
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::size_t n = length == 0 ? 1 : length;
    if (length > 0 && !begins_with_control(text)) {
      out += text.substr(0, n);
    } else {
      for (std::size_t i = 0; i < n; ++i) {
        out += "\\x";
        out += digits[byte(text, i) >> 4];
        out += digits[byte(text, i) & 15];
      }
    }
    text.remove_prefix(n);
  }
  return out;
}

}  // namespace

std::size_t utf8_length(std::string_view text) noexcept {
  if (text.empty()) return 0;
  const unsigned char c = byte(text, 0);
  const std::size_t length = c < 0x80                ? 1
                             : c >= 0xC2 && c < 0xE0 ? 2
                             : c >= 0xE0 && c < 0xF0 ? 3
                             : c >= 0xF0 && c < 0xF5 ? 4
                                                     : 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!continues(text, i)) return 0;
  if (length < 3) return length;
  const unsigned char second = byte(text, 1);
  const bool overlong = (c == 0xE0 && second < 0xA0) || (c == 0xF0 && second < 0x90);
  const bool surrogate = c == 0xED && second > 0x9F, beyond = c == 0xF4 && second > 0x8F;
  return overlong || surrogate || beyond ? 0 : length;
}

bool begins_with_control(std::string_view text) noexcept {
  if (text.empty()) return false;
  const unsigned char c = byte(text, 0);
  if (c < 0x20) return c != '\n' && c != '\t' && c != '\r';
  if (c == 0x7F) return true;
  if (c == 0xC2) return text.size() > 1 && byte(text, 1) < 0xA0;
  if (c != 0xE2 || text.size() < 3) return false;
  const unsigned second = byte(text, 1), third = byte(text, 2);
  // U+202A to U+202E and U+2066 to U+2069 turn the direction, U+2028 and U+2029 end lines.
  return (second == 0x80 && third >= 0xA8 && third <= 0xAE) || (second == 0x81 && third >= 0xA6 && third <= 0xA9);
}

std::string printable(std::string_view text) {
  const std::string safe = escaped(text);
  std::string out, line;
  std::string_view rest = safe;
  while (true) {
    const std::size_t end = rest.find_first_of(" \n");
    append_short(line, rest.substr(0, end), longest_word);
    const bool last = end == std::string_view::npos;
    if (last || rest[end] == '\n') {
      append_short(out, line, longest_line);
      line.clear();
      if (last) return out;
      out += '\n';
    } else {
      line += ' ';
    }
    rest.remove_prefix(end + 1);
  }
}

}  // namespace whirl::core
