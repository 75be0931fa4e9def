#include "whirl/deck/load.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <unordered_map>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

constexpr std::size_t most_bases = 100;
constexpr std::size_t most_bytes = std::size_t{16} << 20;  // of all files of a deck: one table may be named many times

void require_text(const std::string& bytes, const std::string& path) {
  int line = 1;
  for (std::string_view rest = bytes; !rest.empty();) {
    const std::size_t length = core::utf8_length(rest);
    const bool control = rest[0] >= 0 && rest[0] < 0x20 && rest[0] != '\n' && rest[0] != '\r' && rest[0] != '\t';
    if (length == 0 || control) throw InputError(fmt::format("{}:{}:1: the file is not UTF-8 text", path, line));
    if (rest[0] == '\n') ++line;
    rest.remove_prefix(length);
  }
}

std::string slurp(const std::string& path, std::size_t limit) {
  // Reading a pipe or a device would wait, or never end.
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(path, none);
  if (std::filesystem::is_directory(status)) throw InputError(fmt::format("'{}' is a directory", path));
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("'{}' is no regular file", path));
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
  if (chain.size() == most_bases)
    throw InputError(
        fmt::format("{}: there are more than {} bases, each of the one before", named.place.text(), most_bases));
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
  n_bytes_ += size;
  if (n_bytes_ > most_bytes)
    throw InputError(fmt::format("'{}': the files of the deck hold more than {} MiB", path, most_bytes >> 20));
  return bytes;
}

Node merge(Node base, Node over) {
  if (base.kind != Node::Kind::map || over.kind != Node::Kind::map) return over;
  std::unordered_map<std::string_view, Node*> changed;
  for (Node& o : over.items) changed.emplace(o.key, &o);
  // Keys of the base keep their order, new keys follow; keys that were taken back are gone.
  std::vector<Node> items;
  for (Node& b : base.items) {
    const auto at = changed.find(b.key);
    if (at == changed.end()) {
      items.push_back(std::move(b));
      continue;
    }
    Node* o = at->second;
    changed.erase(at);
    if (o->kind == Node::Kind::none) continue;
    std::string key = o->key;
    const Place key_place = o->key_place;
    Node m = merge(std::move(b), std::move(*o));
    m.key = std::move(key);
    m.key_place = key_place;
    items.push_back(std::move(m));
  }
  for (Node& o : over.items)
    if (changed.contains(o.key)) items.push_back(std::move(o));
  over.items = std::move(items);
  return over;
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
