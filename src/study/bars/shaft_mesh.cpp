#include "study/bars/shaft_mesh.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "study/bars/summary_bars.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/rotor/describe.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {

double order_of_shaft(rotor::BeamElement element) {
  return element == rotor::BeamElement::timoshenko ? 2 : 4;
}

bool has_shaft_mesh(const system::Machine& machine, const LayoutOptions& layout) {
  return layout.bars == BarsFrom::meshes && system::is_rotor(machine) &&
         machine.rotor.type == rotor::Options::Type::shaft;
}

bool shaft_mesh_matters(const system::Machine& machine, const LayoutOptions& layout) {
  return has_shaft_mesh(machine, layout) && machine.rotor.reduction.type != rotor::Reduction::Type::guyan;
}

namespace {

void warn(io::StudySummary& summary, const rotor::Options& rotor, const std::string& bars) {
  summary.warnings.push_back(fmt::format(
      "{} leave out the error of the {} elements of the shaft (rotor.element {}): `element_convergence` and "
      "`modes` show it",
      bars, rotor.segments.size(), deck::name_of(rotor.element)));
}

}  // namespace

void warn_curve_without_shaft_mesh(io::StudySummary& summary, const system::Machine& machine,
                                   const LayoutOptions& layout) {
  if (shaft_mesh_matters(machine, layout)) warn(summary, machine.rotor, "the error bars of the curve");
}

void warn_of_shaft_mesh(io::StudySummary& summary, const system::Machine& machine, const LayoutOptions& layout) {
  if (!shaft_mesh_matters(machine, layout)) return;
  double most = 0;
  for (const io::Bifurcation& b : summary.bifurcations)
    if (const auto error = b.more.find("uncertainty_shaft_mesh"); error != b.more.end() && b.value != 0)
      most = std::max(most, error->second / std::abs(b.value));
  warn_of_shaft_mesh(summary, machine.rotor, {{"these bifurcations", most, most_of_frequency}});
  const auto lacks = [](const io::Bifurcation& b) { return !b.more.contains("uncertainty_shaft_mesh"); };
  if (std::ranges::none_of(summary.bifurcations, lacks)) return;
  warn(summary, machine.rotor, "some error bars");
}

void warn_of_shaft_mesh(io::StudySummary& summary, const rotor::Options& rotor, const std::vector<ShaftError>& errors,
                        const std::string& element) {
  std::vector<std::string> words;
  for (const ShaftError& e : errors)
    if (e.part > e.most)
      words.push_back(fmt::format(fmt::runtime(e.part < 0.1 ? "up to {:.2g} % in {}" : "up to {:.0f} % in {}"),
                                  100 * e.part, e.what));
  if (words.empty()) return;
  summary.warnings.push_back(
      fmt::format("the mesh of the shaft ({} elements, {}) leaves {}: cut the segments shorter", rotor.segments.size(),
                  element.empty() ? fmt::format("rotor.element {}", deck::name_of(rotor.element)) : element,
                  fmt::join(words, " and ")));
}

void put_shaft_error(io::StudySummary& summary, const rotor::Options& rotor, double part, const std::string& element) {
  if (part == 0) return;
  summary.set("shaft_mesh.largest_error", part, "1");
  warn_of_shaft_mesh(summary, rotor, {{"these frequencies", part, most_of_frequency}}, element);
}

std::vector<double> bars_of_shaft(const std::vector<double>& here, const rotor::Options& rotor, double order,
                                  const std::function<std::vector<double>(int parts)>& on) {
  MeshLaw law;
  law.shaft_order = order;
  Bars bars(here, law);
  bars.add(Axis::shaft, 0.5, answer_of([&] { return on(2); }));
  if (rotor.segments.size() < 4 * here.size()) bars.add(Axis::shaft, 0.25, answer_of([&] { return on(4); }));
  std::vector<double> out;
  for (std::size_t k = 0; k < here.size(); ++k) out.push_back(bars[k].total());
  return out;
}

double largest_part(const std::vector<double>& bars, const std::vector<double>& frequencies) {
  double out = 0;
  for (std::size_t k = 0; k < bars.size(); ++k)
    if (frequencies[k] > 0 && std::isfinite(bars[k])) out = std::max(out, bars[k] / frequencies[k]);
  return out;
}

system::Train with_cut_shaft(system::Train train, int parts) {
  if (parts == 1) return train;
  const auto after = [whole = train.rotor, parts](int node) { return rotor::node_after(whole, node, parts); };
  train.rotor = rotor::divided(train.rotor, parts);
  for (system::Support& s : train.supports) s.node = after(s.node);
  for (system::StaticLoad& l : train.loads) l.node = after(l.node);
  for (system::Element& e : train.elements) {
    e.node = after(e.node);
    if (e.to_node) e.to_node = after(*e.to_node);
  }
  for (system::UnbalanceMass& u : train.unbalance) u.node = after(u.node);
  return train;
}

system::Train on_mesh(system::Train train, const FilmMesh& mesh) {
  return with_cut_shaft(with_film_mesh(std::move(train), mesh.factor), parts_of(mesh));
}

}  // namespace whirl::study
