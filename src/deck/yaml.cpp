#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <unordered_map>

#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/load.hpp"
#include "yaml_fault.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

constexpr std::size_t most_nodes = 300000;  // aliases of aliases could ask for more than there is memory

// The parser writes its escapes `\N` and `\_` (next line, space that does not break) as the single bytes 0x85 and 0xA0,
// which are no text. Here they become the characters U+0085 and U+00A0.
std::string with_whole_characters(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = core::utf8_length(text);
    if (length == 0) out += '\xC2';
    out += text.substr(0, std::max<std::size_t>(length, 1));
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

// Builds our tree from the parser's events. The parser's own tree keeps duplicate keys and cyclic aliases and loses the
// place of aliases; its events do not.
class Builder : public YAML::EventHandler {
public:
  Builder(std::shared_ptr<const std::string> source) : source_(std::move(source)) {}

  Node take() { return std::move(root_); }
  [[nodiscard]] const std::vector<std::string>& anchor_names() const { return anchor_names_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAnchor(const YAML::Mark&, const std::string& name) override { anchor_names_.push_back(name); }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(leaf(mark, Node{}), anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto it = anchors_.find(anchor);
    if (it == anchors_.end()) fail(mark, "an alias cannot stand inside the value that it names");
    count(size_of(it->second), mark);
    Node copy = it->second;
    copy.key.clear();
    copy.place = place(mark);
    add(std::move(copy), 0);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (tag != "?" && tag != "!" && !tag.empty())
      fail(mark, fmt::format("tags such as '{}' have no meaning here", tag));
    const bool quoted = tag == "!";
    // The parser reports an empty or `~` value as a plain scalar in some places.
    if (!quoted && (value.empty() || value == "~" || value == "null")) return OnNull(mark, anchor);
    add(leaf(mark, Node::scalar(quoted ? with_whole_characters(value) : value, quoted)), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, Node::list(), anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, Node::map(), anchor);
  }
  void OnMapEnd() override { close(); }

private:
  struct Open {
    Node node;
    YAML::anchor_t anchor = 0;
    bool has_key = false;
    std::string key;
    Place key_place;
    std::unordered_map<std::string, int> lines;  // of the keys so far
  };

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& message) const {
    throw InputError(place(mark).text() + ": " + message);
  }
  Place place(const YAML::Mark& mark) const { return {source_, mark.line + 1, mark.column + 1}; }
  Node leaf(const YAML::Mark& mark, Node n) {
    count(1, mark);
    n.place = place(mark);
    return n;
  }
  static std::size_t size_of(const Node& n) {
    std::size_t s = 1;
    for (const Node& i : n.items) s += size_of(i);
    return s;
  }
  void count(std::size_t more, const YAML::Mark& mark) {
    n_nodes_ += more;
    require_few(place(mark));
  }
  void require_few(const Place& at) const {
    if (n_nodes_ > most_nodes)
      throw InputError(
          fmt::format("{}: the deck has more than {} values once its aliases are expanded", at.text(), most_nodes));
  }
  bool wants_key() const {
    return !stack_.empty() && stack_.back().node.kind == Node::Kind::map && !stack_.back().has_key;
  }

  void open(const YAML::Mark& mark, const std::string& tag, Node n, YAML::anchor_t anchor) {
    if (wants_key()) fail(mark, "a key must be a single word");
    if (tag != "?" && !tag.empty()) fail(mark, fmt::format("tags such as '{}' have no meaning here", tag));
    stack_.push_back({leaf(mark, std::move(n)), anchor, false, {}, {}, {}});
  }
  void close() {
    Open top = std::move(stack_.back());
    stack_.pop_back();
    add(std::move(top.node), top.anchor);
  }
  void add(Node n, YAML::anchor_t anchor) {
    if (wants_key()) return take_key(n);
    if (anchor != 0) {
      n_nodes_ += size_of(n);  // nested anchors keep their values many times
      require_few(n.place);
      anchors_[anchor] = n;
    }
    if (stack_.empty()) {
      root_ = std::move(n);
      return;
    }
    Open& top = stack_.back();
    if (top.node.kind == Node::Kind::map) {
      n.key = std::move(top.key);
      n.key_place = top.key_place;
      top.has_key = false;
    }
    top.node.items.push_back(std::move(n));
  }
  void take_key(const Node& n) {
    Open& top = stack_.back();
    const std::string where = n.place.text() + ": ";
    if (n.kind != Node::Kind::scalar) throw InputError(where + "a key must be a single word");
    try {
      require_key(n.text);
    } catch (const InputError& e) {
      throw InputError(where + e.what());
    }
    if (const auto [first, fresh] = top.lines.emplace(n.text, n.place.line); !fresh)
      throw InputError(fmt::format("{}key '{}' is given twice, first in line {}", where, n.text, first->second));
    top.key = n.text;
    top.key_place = n.place;
    top.has_key = true;
  }

  std::shared_ptr<const std::string> source_;
  std::vector<Open> stack_;
  std::map<YAML::anchor_t, Node> anchors_;
  std::vector<std::string> anchor_names_;
  Node root_;
  std::size_t n_nodes_ = 0;
};

}  // namespace

Node parse_yaml(std::string_view text, const std::string& source) {
  const auto name = std::make_shared<const std::string>(source);
  std::istringstream in{std::string(text)};
  Builder builder(name);
  try {
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(builder)) return Node{};
    Node root = builder.take();
    Builder rest(name);
    if (parser.HandleNextDocument(rest))
      throw InputError(fmt::format("{}: there is a second document; a deck is one document", rest.take().place.text()));
    return root;
  } catch (const YAML::Exception& e) {
    // A tab in the indentation is the usual reason for a complaint that names something else.
    const int line = std::max(e.mark.line, 0);
    std::string_view rest = text;
    for (int i = 0; i < line && !rest.empty(); ++i) rest.remove_prefix(std::min(rest.size(), rest.find('\n') + 1));
    const std::size_t indent = std::min(rest.find_first_not_of(" \t"), rest.size());
    const std::size_t tab = rest.substr(0, indent).find('\t');
    if (tab != std::string_view::npos)
      throw InputError(fmt::format("{}:{}:{}: a tab in the indentation; use spaces", source, line + 1, tab + 1));
    const int column = std::max(e.mark.column, 0);
    if (const std::string alias = anchor_at(text, line, column);
        e.msg == YAML::ErrorMsg::UNKNOWN_ANCHOR && !alias.empty())
      throw InputError(fmt::format(
          "{}:{}:{}: '*{}' repeats a value that '&{}' names, but there is no '&{}' above it{}", source, line + 1,
          column + 1, alias, alias, alias,
          builder.anchor_names().empty() ? std::string() : did_you_mean_one_of(alias, builder.anchor_names())));
    const YamlFault fault = yaml_fault(text, line, column, e.msg);
    throw InputError(fmt::format("{}:{}:{}: {}", source, fault.line, fault.column, fault.message));
  }
}

}  // namespace whirl::deck
