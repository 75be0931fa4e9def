#include "schema.hpp"

namespace whirl::deck {

Node typed_schema(const std::string& type) {
  Node n = Node::map();
  n.set("type", Node::scalar(type, true));
  return n;
}

Node object_schema() {
  Node n = typed_schema("object");
  n.set("additionalProperties", Node::scalar("false"));
  n.set("properties", Node::map());
  return n;
}

Node either_schema(Node a, Node b) {
  Node n = Node::map();
  Node& any_of = n.set("anyOf", Node::list());
  any_of.push(std::move(a));
  any_of.push(std::move(b));
  return n;
}

std::string with_bounds(const std::string& words, const Check& check) {
  const std::string bounds = check.text();
  return bounds.empty() ? words : words + ", " + bounds;
}

}  // namespace whirl::deck
