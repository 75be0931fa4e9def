#include "study/linear/element_convergence.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/bars/shaft_mesh.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/linear/mode_loss.hpp"
#include "study/linear/shaft_modes.hpp"
#include "study/pieces.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/rotor/describe.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/spectral/dense.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

system::Train divided(system::Train train, int parts, rotor::BeamElement element) {
  train = with_cut_shaft(std::move(train), parts);
  train.rotor.element = element;
  if (element == rotor::BeamElement::timoshenko_hermitian) {
    for (const system::Support& s : train.supports) train.rotor.joints.push_back(s.node);
    for (const system::StaticLoad& l : train.loads) train.rotor.joints.push_back(l.node);
    for (const system::Element& e : train.elements) {
      train.rotor.joints.push_back(e.node);
      if (e.to_node) train.rotor.joints.push_back(*e.to_node);
    }
  }
  return train;
}

template <class M>
double condition_number(const M& matrix) {
  const Eigen::VectorXd sizes = spectral::singular_values(matrix);
  return sizes(0) / sizes(sizes.size() - 1);
}

// 2-norm, in the system's scales; not numbers where the machine is too large for dense matrices.
struct ConditionNumber {
  const char *name, *of;
};
constexpr std::array<ConditionNumber, 3> condition_numbers{{{"vectors", "of the modes' vectors, each of length one"},
                                                            {"stiffness", "of dF/dx by the coordinates"},
                                                            {"mass", "of the mass"}}};
using Conditions = std::array<double, condition_numbers.size()>;

Conditions conditions(system::RotorSystem& system, Vec x) {
  spectral::EigenOptions options;
  const PetscInt n = system.size(), q = system.coordinates();
  Conditions out{io::no_value, io::no_value, io::no_value};
  if (n > options.dense_below) return out;
  core::Vector states = core::duplicate(x), rows = core::duplicate(x), rest = core::duplicate(x);
  system.scales(states.get(), rows.get());
  core::check(VecSet(rest.get(), 0));
  const std::vector<double> scale = core::gather(states.get());
  const auto modes = spectral::modes(system, x, options);
  core::check(VecReciprocal(rows.get()));
  // Rows of momentum in coordinates, and in rates of velocities.
  const auto block = [&](double alpha, double sigma, PetscInt offset) {
    core::Matrix j = system.make_jacobian();
    system.jacobian(0, x, rest.get(), alpha, sigma, j.get());
    core::check(MatDiagonalScale(j.get(), rows.get(), states.get()));
    const Eigen::MatrixXd all(whole_matrix(j.get()));
    return Eigen::MatrixXd(all(Eigen::seqN(0, q, 2), Eigen::seqN(offset, q, 2)));
  };
  const Eigen::MatrixXd stiffness = block(1, 0, 0), mass = block(0, 1, 1);
  core::agree(system.comm(), [&] {
    Eigen::MatrixXcd v(n, n);
    Eigen::Index columns = 0;
    for (const spectral::Mode& m : modes)
      for (const bool conjugate : {false, true}) {
        if ((conjugate && m.lambda.imag() == 0) || columns == n) continue;
        for (PetscInt k = 0; k < n; ++k) {
          const Complex value = m.shape[static_cast<std::size_t>(k)] / scale[static_cast<std::size_t>(k)];
          v(k, columns) = conjugate ? std::conj(value) : value;
        }
        v.col(columns++).normalize();
      }
    if (columns == n) out[0] = condition_number(v);
    out[1] = condition_number(stiffness);
    out[2] = condition_number(mass);
  });
  return out;
}

struct Found {
  double elements = 0;
  std::vector<double> frequency, forward;
  Conditions condition{io::no_value, io::no_value, io::no_value};
  void members(auto& archive) { archive(elements, frequency, forward, condition); }
};

// Order at which the last three meshes with equal ratios of parts converge.
double order(double coarse, double middle, double fine, double ratio) {
  const double p = std::log(std::abs((coarse - middle) / (middle - fine))) / std::log(ratio);
  return std::isfinite(p) ? p : io::no_value;
}

// The largest finite one; not a number if there is none.
double largest(const std::vector<double>& values) {
  double most = io::no_value;
  for (const double v : values)
    if (std::isfinite(v) && !(std::abs(v) <= most)) most = std::abs(v);
  return most;
}

// A part of one in percent, of three digits.
io::Quantity percent(double part) {
  return to_digits({100 * part, "%"}, 3);
}

}  // namespace

StudyResult ElementConvergence::run(Context& context) {
  const Layout layout = plan(context, Sharing::speeds);
  auto& results = context.results;
  auto& summary = results.summary();
  const std::size_t meshes = options.parts.size(), count = static_cast<std::size_t>(options.count);
  const system::Train given = system::train_of(context.machine);
  Pieces pieces(results, context.resume);
  std::size_t ready = 0;
  const auto compute = [&](std::size_t i) {
    const rotor::BeamElement element = options.elements[i / meshes];
    const system::Train train = divided(given, options.parts[i % meshes], element);
    system::RotorSystem system(layout.space, train, options.speed.value);
    Walker walker(system);
    const Vec x = walker.at(options.speed.value);
    ModeSearch search;
    auto modes = shaft_modes(system, x, options.count, 2, std::numeric_limits<double>::infinity(), search);
    // The lowest that vibrate; growing ones that stand among the others are as near on every mesh.
    std::erase_if(modes, [](const ShaftMode& m) { return !spectral::vibrates(m.lambda); });
    const std::vector<double> mass = rotor::node_masses(train.rotor);
    Found out{static_cast<double>(train.rotor.segments.size()), {}, {}};
    if (options.condition) out.condition = conditions(system, x);
    for (std::size_t k = 0; k < count; ++k) {
      const bool known = k < modes.size();
      out.frequency.push_back(known ? modes[k].lambda.imag() : io::no_value);
      out.forward.push_back(known ? spectral::whirl_energy(modes[k].x, modes[k].y, mass).forward : io::no_value);
    }
    results.progress(fmt::format("{}: {} meshes on this rank, {:.1f} s", summary.name, ++ready, results.seconds()));
    return out;
  };
  const std::vector<Found> found =
      distribute(layout, options.elements.size() * meshes, compute, pieces, "mesh", no_trail);
  std::vector<std::vector<Found>> all(options.elements.size());
  for (std::size_t i = 0; i < found.size(); ++i) all[i / meshes].push_back(found[i]);

  auto& group = results.group();
  group.set("speed", options.speed.value);
  for (std::size_t e = 0; e < all.size(); ++e) {
    const std::vector<Found>& of = all[e];
    const std::string name(deck::name_of(options.elements[e]));
    auto& table = group.child("convergence").child(name);
    table.set("place", static_cast<int>(e));
    std::vector<double> elements, frequency, forward, error, shift;
    for (const Found& f : of) {
      elements.push_back(f.elements);
      for (std::size_t k = 0; k < count; ++k) {
        frequency.push_back(f.frequency[k]);
        forward.push_back(f.forward[k]);
        error.push_back(std::abs(f.frequency[k] / of.back().frequency[k] - 1));
      }
    }
    for (std::size_t k = 0; k < count; ++k)
      shift.push_back(of.back().frequency[k] / all.front().back().frequency[k] - 1);
    table.put("elements", elements, "1", "of the whole shaft");
    table.put("frequency", {meshes, count}, frequency, "rad/s", "damped frequencies [mesh][mode], the lowest");
    table.put("forward_share", {meshes, count}, forward, "1", "of their kinetic energy, backward negative");
    table.put("error", {meshes, count}, error, "1", "relative distance from the last mesh");
    table.label_each({io::numbered(count, "mode")});
    table.put("shift", shift, "1", "of the last mesh from the first kind of element, relative");
    for (std::size_t c = 0; c < condition_numbers.size() && options.condition; ++c) {
      const std::string column_name = fmt::format("condition_{}", condition_numbers[c].name);
      table.put(column_name, column(of, [c](const Found& f) { return f.condition[c]; }), "1",
                fmt::format("condition number {}, 2-norm in the states' scales", condition_numbers[c].of));
      summary.set(name + "." + column_name, of.back().condition[c], "1");
    }
    const std::size_t last = meshes - 1;
    const double ratio = static_cast<double>(options.parts[last]) / options.parts[last - 1];
    const bool even = meshes > 2 && options.parts[last - 1] * options.parts[last - 1] ==
                                        options.parts[last] * options.parts[last - 2];
    // Two meshes that are nearly alike leave more than their distance.
    const double left = std::min(1.0, std::pow(ratio, order_of_shaft(options.elements[e])) - 1);
    for (std::size_t k = 0; k < count; ++k) {
      const double fine = of[last].frequency[k], middle = of[last - 1].frequency[k];
      summary.set(fmt::format("{}.frequency.{}", name, k + 1), fine, "rad/s",
                  {{"uncertainty", std::abs(fine - middle) / left}});
      if (even)
        summary.set(fmt::format("{}.order.{}", name, k + 1), order(of[last - 2].frequency[k], middle, fine, ratio),
                    "1");
      if (e > 0) summary.set(fmt::format("{}.shift.{}", name, k + 1), shift[k], "1");
    }
  }
  summary.points = static_cast<long>(found.size());
  return results.finish("completed", true);
}

io::Brief ElementConvergence::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  if (!result.delivered || !result.group.has_group("convergence")) return {};
  const io::Group& all = result.group.group("convergence");
  const Values v(result.summary);
  const auto count = static_cast<std::size_t>(options.count), meshes = options.parts.size();
  io::Brief out;
  io::BriefTable finest{
      "Whirl frequencies on the finest mesh",
      {{"mode"}},
      {},
      "bar: distance from the mesh before, or what the order of the elements leaves, if that is more"},
      orders{"Order of convergence, by the last three meshes", {{"mode"}}, {}, {}},
      errors{"Largest distance of a frequency from the finest mesh", {{"elements"}}, {}, {}},
      conditions{"Condition numbers on the finest mesh",
                 {{"element"},
                  {"vectors", "1"},
                  {"power (v)", "1"},
                  {"stiffness", "1"},
                  {"power (s)", "1"},
                  {"mass", "1"},
                  {"power (m)", "1"}},
                 {},
                 "2-norm, in the scales of the states; power: with which they rise over the number of elements, from "
                 "the mesh before"};
  finest.rows.resize(count);
  orders.rows.resize(count);
  errors.rows.resize(meshes - 1);
  for (std::size_t k = 0; k < count; ++k) {
    finest.rows[k].emplace_back(std::to_string(k + 1));
    orders.rows[k].emplace_back(std::to_string(k + 1));
  }
  const std::string first(deck::name_of(options.elements.front()));
  for (const rotor::BeamElement element : options.elements) {
    const std::string name(deck::name_of(element));
    const io::Group& table = all.group(name);
    const std::vector<double>&n = table.reals("elements"), &error = table.reals("error");
    finest.columns.push_back({name, "Hz"});
    orders.columns.push_back({name, "1"});
    errors.columns.push_back({name, "%"});
    if (name != first) finest.columns.push_back({"shift", "%"});
    std::vector<double> shifts, moves;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string mode = std::to_string(k + 1);
      const io::Quantity f = v[name + ".frequency." + mode], order = v[name + ".order." + mode],
                         shift = v[name + ".shift." + mode];
      finest.rows[k].emplace_back(scaled(f, 1 / (2 * std::numbers::pi), "Hz"));
      if (name != first) finest.rows[k].emplace_back(percent(shift.value));
      orders.rows[k].emplace_back(to_digits(order, 3));
      shifts.push_back(shift.value);
    }
    for (std::size_t m = 0; m + 1 < meshes; ++m) {
      if (errors.rows[m].empty()) errors.rows[m].emplace_back(fmt::format("{:.0f}", n[m]));
      const auto at = error.begin() + static_cast<std::ptrdiff_t>(m * count);
      moves.assign(at, at + static_cast<std::ptrdiff_t>(count));
      errors.rows[m].emplace_back(percent(largest(moves)));
    }
    if (const double worst = largest(moves); std::isfinite(worst))
      out.sentences.push_back(
          fmt::format("{}: from {:.0f} to {:.0f} elements the {} lowest whirl frequencies move by at most {}", name,
                      n[meshes - 2], n.back(), count, io::reading(percent(worst))));
    if (const double most = largest(shifts); name != first && std::isfinite(most))
      out.sentences.back() +=
          fmt::format("; they differ from those of {} by at most {}", first, io::reading(percent(most)));
    if (!options.condition) continue;
    auto& row = conditions.rows.emplace_back();
    row.emplace_back(name);
    for (const ConditionNumber& number : condition_numbers) {
      const std::vector<double>& c = table.reals(fmt::format("condition_{}", number.name));
      row.emplace_back(to_digits({c.back(), "1"}, 3));
      row.emplace_back(to_digits({std::log(c.back() / c[meshes - 2]) / std::log(n.back() / n[meshes - 2]), "1"}, 3));
    }
  }
  out.tables = {std::move(finest), std::move(orders), std::move(errors), std::move(conditions)};
  // Of meshes whose numbers have no constant ratio nothing is known of the order.
  std::erase_if(out.tables, [](const io::BriefTable& t) {
    return std::ranges::none_of(t.rows, [](const auto& row) {
      return std::any_of(row.begin() + 1, row.end(), [](const io::BriefCell& c) { return c.is_number(); });
    });
  });
  return out;
}

}  // namespace whirl::study
