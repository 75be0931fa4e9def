#include "whirl/deck/load.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

// Length of the UTF-8 sequence at `s`, 0 if it is not one (overlong forms and surrogates are left to the reader's eye).
std::size_t sequence(const unsigned char* s, std::size_t n) {
  const unsigned char c = s[0];
  const std::size_t length = c < 0x80                ? 1
                             : c >= 0xC2 && c < 0xE0 ? 2
                             : c >= 0xE0 && c < 0xF0 ? 3
                             : c >= 0xF0 && c < 0xF5 ? 4
                                                     : 0;
  if (length == 0 || length > n) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((s[i] & 0xC0) != 0x80) return 0;
  return length;
}

void require_text(const std::string& bytes, const std::string& path) {
  int line = 1;
  const auto* s = reinterpret_cast<const unsigned char*>(bytes.data());
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = sequence(s + i, bytes.size() - i);
    const bool control = s[i] < 0x20 && s[i] != '\n' && s[i] != '\r' && s[i] != '\t';
    if (length == 0 || control) throw InputError(fmt::format("{}:{}:1: the file is not UTF-8 text", path, line));
    if (s[i] == '\n') ++line;
    i += length;
  }
}

std::string slurp(const std::string& path, std::size_t limit) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw InputError(fmt::format("'{}' is a directory", path));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno ? errno : ENOENT)));
  std::string bytes(limit + 1, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.size() > limit) throw InputError(fmt::format("'{}' is larger than {} bytes", path, limit));
  require_text(bytes, path);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
  return bytes;
}

// The deck and its bases, the innermost base first; `chain` are the decks that led here.
Node load_chain(const std::string& path, std::vector<std::string>& chain, const Files& files) {
  Node deck = parse_yaml(files.read_text(path), path);
  if (deck.kind == Node::Kind::none) throw InputError(fmt::format("{}:1:1: the deck is empty", path));
  if (deck.kind != Node::Kind::map) throw InputError(deck.place.text() + ": a deck is a map of `key: value` lines");
  const Node* base = deck.find("base");
  if (!base) return deck;
  const Node named = *base;
  std::erase_if(deck.items, [](const Node& n) { return n.key == "base"; });
  if (named.kind != Node::Kind::scalar) throw InputError(named.place.text() + ": `base` names one deck");
  const std::filesystem::path relative(named.text);
  const std::string next =
      (relative.is_absolute() ? relative : std::filesystem::path(named.place.directory()) / relative)
          .lexically_normal()
          .string();
  chain.push_back(std::filesystem::path(path).lexically_normal().string());
  if (std::find(chain.begin(), chain.end(), next) != chain.end()) {
    std::string loop;
    for (const std::string& c : chain) loop += c + " -> ";
    throw InputError(fmt::format("{}: the bases go round in a circle: {}{}", named.place.text(), loop, next));
  }
  Node below;
  try {
    below = load_chain(next, chain, files);
  } catch (const InputError& e) {
    if (std::string_view(e.what()).starts_with("cannot read") || std::string_view(e.what()).starts_with("'"))
      throw InputError(named.place.text() + ": " + e.what());
    throw;
  }
  chain.pop_back();
  return merge(std::move(below), std::move(deck));
}

}  // namespace

std::string Files::read_text(const std::string& path, std::size_t limit) const {
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::string bytes;
  core::agree(comm_, [&] {
    if (rank == 0) bytes = slurp(path, limit);
  });
  unsigned long size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, 0, comm_);
  bytes.resize(size);
  MPI_Bcast(bytes.data(), static_cast<int>(size), MPI_CHAR, 0, comm_);
  return bytes;
}

Node merge(Node base, Node over) {
  if (base.kind != Node::Kind::map || over.kind != Node::Kind::map) return over;
  Node merged = std::move(over);
  std::vector<Node> items;
  for (Node& b : base.items) {
    Node* o = merged.find(b.key);
    if (!o) {
      items.push_back(std::move(b));
    } else if (o->kind != Node::Kind::none) {
      Node m = merge(std::move(b), *o);
      m.key = o->key;
      m.key_place = o->key_place;
      items.push_back(std::move(m));
    }
  }
  // Keys of the base keep their order, new keys follow; keys that were taken back are gone.
  for (Node& o : merged.items) {
    const bool seen =
        std::any_of(base.items.begin(), base.items.end(), [&](const Node& b) { return b.key == o.key; }) ||
        std::any_of(items.begin(), items.end(), [&](const Node& i) { return i.key == o.key; });
    if (!seen) items.push_back(std::move(o));
  }
  merged.items = std::move(items);
  return merged;
}

Node load(const std::string& path, const std::vector<std::string>& overrides, const Files& files,
          const Structure& structure, std::vector<Change>* changes) {
  try {
    std::vector<std::string> chain;
    Node root = load_chain(path, chain, files);
    for (const std::string& o : overrides) {
      const std::vector<Change> done = apply(parse_edit(o), root, structure, files);
      if (changes) changes->insert(changes->end(), done.begin(), done.end());
    }
    return root;
  } catch (InputError& e) {
    e.mark_agreed();  // every rank read the same bytes and comes to the same end
    throw;
  }
}

Node load(const std::string& path, const std::vector<std::string>& overrides, const Files& files) {
  return load(path, overrides, files, Structure{});
}

}  // namespace whirl::deck
