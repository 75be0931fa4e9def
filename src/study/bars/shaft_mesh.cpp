#include "study/bars/shaft_mesh.hpp"

#include "whirl/rotor/divide.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {

double order_of_shaft(rotor::Element element) {
  return element == rotor::Element::timoshenko ? 2 : 4;
}

bool has_shaft_mesh(const system::Machine& machine, const LayoutOptions& layout) {
  return layout.bars == BarsFrom::meshes && system::is_rotor(machine) &&
         machine.rotor.type == rotor::Options::Type::shaft && machine.rotor.couplings.empty();
}

system::Train with_cut_shaft(system::Train train, int parts) {
  if (parts == 1) return train;
  train.rotor = rotor::divided(train.rotor, parts);
  for (system::Support& s : train.supports) s.node = rotor::node_after(s.node, parts);
  for (system::StaticLoad& l : train.loads) l.node = rotor::node_after(l.node, parts);
  for (system::Element& e : train.elements) {
    e.node = rotor::node_after(e.node, parts);
    if (e.to_node) e.to_node = rotor::node_after(*e.to_node, parts);
  }
  for (system::UnbalanceMass& u : train.unbalance) u.node = rotor::node_after(u.node, parts);
  return train;
}

}  // namespace whirl::study
