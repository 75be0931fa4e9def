#include "whirl/deck/raw.hpp"

#include "schema.hpp"
#include "whirl/deck/load.hpp"

namespace whirl::deck {
namespace {

// Tables in place of their names; the values keep the place of the name, which is what errors shall cite.
void read_tables(Node& n, const Files& files) {
  for (Node& i : n.items) read_tables(i, files);
  if (n.kind != Node::Kind::scalar || !names_table(n)) return;
  Node table = load_table(n, files);
  table.key = n.key;
  table.key_place = n.key_place;
  n = std::move(table);
}

class RawMapCodec final : public Codec {
public:
  explicit RawMapCodec(std::string words) : words_(std::move(words)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind != Node::Kind::map) return r.problems.add(node.place, "'" + node.key + "' must be " + words_);
    Node& kept = *static_cast<Node*>(value);
    kept = node;
    try {
      read_tables(kept, r.files);
    } catch (const core::InputError& e) {
      r.problems.add({}, e.what());  // it knows its place
    }
  }
  Node write(const void* value) const override {
    const Node& n = *static_cast<const Node*>(value);
    return n.items.empty() ? Node{} : n;
  }
  Node schema(bool) const override { return typed_schema("object"); }
  std::string type() const override { return words_; }

private:
  std::string words_;
};

}  // namespace

CodecPtr raw_map_codec(std::string words) {
  return std::make_shared<RawMapCodec>(std::move(words));
}

}  // namespace whirl::deck
