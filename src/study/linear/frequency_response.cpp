#include "study/linear/frequency_response.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/branch_state.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/linear/mode_bars.hpp"
#include "study/linear/passed_over.hpp"
#include "study/linear/resonances.hpp"
#include "study/linear/transfer_points.hpp"
#include "study/lost_points.hpp"
#include "study/pieces.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/film/contract/linear.hpp"
#include "whirl/rotor/divide.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;
void append(std::vector<double>& out, const std::vector<Complex>& matrix) {
  for (const Complex& g : matrix) out.insert(out.end(), {g.real(), g.imag()});
}

// The machine with constant stiffness and damping in place of its films.
system::Train with_coefficients(system::Train train, const std::vector<film::PortCoefficients>& films) {
  for (std::size_t b = 0; b < films.size(); ++b) {
    film::Linear film;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        film.stiffness[2 * i + j] = films[b].stiffness[i][j];
        film.damping[2 * i + j] = films[b].damping[i][j];
      }
    train.supports[b].film = film;
  }
  return train;
}

// What is computed: by the films as they are, by their coefficients at the same or at one other frequency, by those
// that the user gives.
struct Way {
  std::string name;
  enum class Films { whole, at_each, constant, given } films = Films::whole;
  double frequency = 0;  // [rad/s] of constant coefficients
};

class Transfers {
public:
  Transfers(const Context& context, const Layout& layout, const FrequencyResponseOptions& options,
            std::vector<TransferOutput> outputs, const FilmMesh& mesh = {})
      : options_(moved(options, context.machine.rotor, parts_of(mesh))),
        outputs_(moved(std::move(outputs), context.machine.rotor, parts_of(mesh))),
        train_(on_mesh(with_joints(system::train_of(context.machine), options), mesh)),
        system_(layout.space, train_, options.speed.value),
        walker_(system_),
        matrix_(system_, options_.inputs, outputs_) {}

  // Throws core::NotConverged where there is no equilibrium.
  void linearise() {
    if (linearised_) return;
    const Vec x = walker_.at(options_.speed.value);
    matrix_.linearise(x);
    whole_ = system_.gather(x);
    linearised_ = true;
  }
  Transfer at(const Way& way, double omega) {
    linearise();
    if (way.films == Way::Films::whole) return matrix_.at(omega);
    const double frequency = way.films == Way::Films::constant ? way.frequency : omega;
    if (frequency != last_ || way.films != last_films_) {
      std::vector<film::PortCoefficients> films = film_coefficients(system_, whole_, frequency);
      if (way.films == Way::Films::given) put_given(films, frequency);
      const system::Train train = with_coefficients(train_, films);
      if (linear_) {
        linear_->set_train(train);
      } else {
        linear_ = std::make_unique<system::RotorSystem>(system_.comm(), train, options_.speed.value);
        linear_matrix_ = std::make_unique<TransferMatrix>(*linear_, options_.inputs, outputs_);
      }
      core::Vector rest = core::make_vector(linear_->comm(), linear_->local_size(), PETSC_DETERMINE);
      core::check(VecSet(rest.get(), 0));
      linear_matrix_->linearise(rest.get());
      last_ = frequency;
      last_films_ = way.films;
    }
    return linear_matrix_->at(omega);
  }
  [[nodiscard]] Trail trail() { return walker_.trail(); }

  // Of the equilibrium; nothing where its eigenvalues are not found.
  std::optional<solve::Stability> stability() {
    return answer_of([&] { return std::optional(equilibrium_stability(system_, walker_.at(options_.speed.value))); });
  }

private:
  void put_given(std::vector<film::PortCoefficients>& films, double frequency) const {
    for (std::size_t b = 0; b < films.size(); ++b)
      for (const GivenCoefficients& g : options_.given) {
        if (g.bearing != train_.supports[b].name) continue;
        const CoefficientsAt c = interpolated(g.table, frequency);
        films[b].stiffness = {{{c.k_xx, c.k_xy}, {c.k_yx, c.k_yy}}};
        films[b].damping = {{{c.c_xx, c.c_xy}, {c.c_yx, c.c_yy}}};
      }
  }
  // Points of a shaft whose segments are cut.
  template <class Point>
  static std::vector<Point> moved(std::vector<Point> points, const rotor::Options& whole, int parts) {
    for (Point& p : points)
      if (p.node) p.node = rotor::node_after(whole, *p.node, parts);
    return points;
  }
  static FrequencyResponseOptions moved(FrequencyResponseOptions options, const rotor::Options& whole, int parts) {
    options.inputs = moved(std::move(options.inputs), whole, parts);
    return options;
  }
  // Forces may make the shear force jump, where an element asks for the place.
  static system::Train with_joints(system::Train train, const FrequencyResponseOptions& options) {
    for (const TransferInput& input : options.inputs)
      if (input.node && !train.rotor.joints.empty()) train.rotor.joints.push_back(*input.node);
    return train;
  }

  FrequencyResponseOptions options_;
  std::vector<TransferOutput> outputs_;
  system::Train train_;
  system::RotorSystem system_;
  Walker walker_;
  TransferMatrix matrix_;
  bool linearised_ = false;
  std::vector<double> whole_;
  std::unique_ptr<system::RotorSystem> linear_;
  std::unique_ptr<TransferMatrix> linear_matrix_;
  double last_ = 0;
  Way::Films last_films_ = Way::Films::whole;
};

// Where a response is largest; the first frequency where it is nowhere known.
std::size_t largest_of(const Matrices& found, std::size_t response) {
  std::size_t most = 0;
  double largest = -1;
  for (std::size_t k = 0; k < found.size(); ++k)
    if (const double here = std::abs(found[k][response]); here > largest) most = k, largest = here;
  return most;
}

// Error bars of complex responses at some of the frequencies, in the units of these; NaN: unknown. Empty without
// meshes.
struct TransferBars {
  std::vector<std::size_t> at;             // of the frequencies, ascending
  std::vector<std::vector<double>> error;  // [response][of these]
  std::vector<std::vector<double>> shaft;  // likewise: what the mesh of the shaft has in them
  std::vector<double> undamped;            // of the frequency of each undamped resonance [rad/s]
  [[nodiscard]] double of(std::size_t response, std::size_t frequency) const {
    return error[response][static_cast<std::size_t>(std::find(at.begin(), at.end(), frequency) - at.begin())];
  }
};

// The machine with its films as they are at a few frequencies, and where each response is largest, on other meshes of
// the films and of the shaft. One task is one mesh. Where a response grows without limit it has no largest value.
// `lost`: why a frequency has no answer.
TransferBars bars_of(const Context& context, const Layout& layout, Pieces& pieces,
                     const FrequencyResponseOptions& options, const std::vector<TransferOutput>& outputs,
                     const std::vector<double>& frequencies, const Matrices& found, const std::vector<Endless>& endless,
                     const std::vector<std::string>& lost) {
  TransferBars out;
  std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  if (shaft_mesh_matters(context.machine, context.layout)) meshes.push_back(cut_shaft_mesh);
  if (meshes.empty()) return out;
  const std::size_t responses = found.front().size();
  const std::vector<std::size_t> few = few_of(frequencies.size(), most_with_bars);
  std::set<std::size_t> at(few.begin(), few.end());
  for (std::size_t e = 0; e < responses; ++e)
    if (std::ranges::none_of(endless, [&](const Endless& u) { return u.responses[e]; }))
      at.insert(largest_of(found, e));
  std::erase_if(at, [&](std::size_t k) { return !lost[k].empty(); });
  out.at.assign(at.begin(), at.end());
  const auto compute = [&](std::size_t i) {
    std::vector<double> all;
    const bool answered = has_answer([&] {
      Transfers there(context, layout, options, outputs, meshes[i]);
      for (const std::size_t k : out.at) append(all, there.at({"machine"}, frequencies[k]).values);
      if (endless.empty()) return;
      const auto found_there = there.stability().value_or(solve::Stability{});
      for (const Endless& u : endless) all.push_back(nearest_to(u.frequency, found_there.values));
    });
    if (!answered) all.clear();
    return all;
  };
  const auto on_meshes = distribute(layout, meshes.size(), compute, pieces, "other mesh", no_trail);
  std::vector<double> here;
  for (const std::size_t k : out.at) append(here, found[k]);
  for (const Endless& u : endless) here.push_back(u.frequency);
  Bars bars(here, law_of(context.machine, context.layout));
  for (std::size_t i = 0; i < meshes.size(); ++i) bars.add(meshes[i].axis, meshes[i].spacing, on_meshes[i]);
  out.error.resize(responses);
  out.shaft.resize(responses);
  for (std::size_t k = 0; k < out.at.size(); ++k)
    for (std::size_t e = 0; e < responses; ++e) {
      const std::size_t real = 2 * (k * responses + e);
      const Bar a = bars[real], b = bars[real + 1];
      out.error[e].push_back(std::hypot(a.total(), b.total()));
      out.shaft[e].push_back(std::hypot(a.shaft_mesh, b.shaft_mesh));
    }
  for (std::size_t k = 0; k < endless.size(); ++k)
    out.undamped.push_back(bars[2 * out.at.size() * responses + k].total());
  return out;
}

}  // namespace

StudyResult FrequencyResponse::run(Context& context) {
  std::vector<TransferOutput> outputs = options.outputs;
  if (outputs.empty())
    for (const TransferInput& input : options.inputs) outputs.push_back(output_of(input));
  const std::string unit = options.range.unit;
  const auto in_unit = [&](double omega) { return deck::from_si(omega, unit, deck::frequency); };
  const auto shown = [&](double omega) { return fmt::format("{:.6g} {}", in_unit(omega), unit); };
  const bool by_log = options.spacing == FrequencyResponseOptions::Spacing::log;
  const std::vector<double> frequencies =
      (by_log ? by_ratios : evenly)(options.range.from, options.range.to, options.points);
  std::vector<Way> ways{{"machine"}};
  if (options.coefficients) ways.push_back({"coefficients", Way::Films::at_each});
  for (const deck::Quantity& q : options.constant_at)
    ways.push_back({fmt::format("constant.{}", ways.size() - options.coefficients), Way::Films::constant, q.value});
  if (!options.given.empty()) ways.push_back({"given", Way::Films::given});

  const Layout layout = plan(context, Sharing::speeds);
  Transfers machine(context, layout, options, outputs);
  auto& results = context.results;
  auto& summary = results.summary();
  Pieces pieces(results, context.resume);
  std::size_t ready = 0;
  std::vector<Matrices> all;
  Roundings rounding;                          // of the machine
  std::vector<std::vector<std::string>> lost;  // why a frequency has no answer; empty: it has
  for (const Way& way : ways) {
    const auto compute = [&](std::size_t i) {
      machine.linearise();  // without an equilibrium nothing has an answer
      auto here = answered([&] { return machine.at(way, frequencies[i]); });
      results.progress(
          fmt::format("{}: {} frequencies on this rank, {:.1f} s", summary.name, ++ready, results.seconds()));
      return here;
    };
    Matrices& found = all.emplace_back();
    auto& reasons = lost.emplace_back();
    const std::size_t responses = outputs.size() * options.inputs.size();
    const Transfer none{std::vector(responses, Complex(io::no_value, io::no_value)),
                        std::vector(responses, io::no_value)};
    for (const auto& [there, why] :
         distribute(layout, frequencies.size(), compute, pieces, way.name, machine.trail())) {
      reasons.push_back(why);
      found.push_back(there.value_or(none).values);
      if (all.size() == 1) rounding.push_back(there.value_or(none).rounding);
    }
  }

  const auto one_machine = [&](std::size_t) { return machine.stability(); };
  const auto stability = distribute(layout, 1, one_machine, pieces, "stability", machine.trail()).front();
  // Equilibria know of no loss factor: of such shafts nothing is said.
  if (context.machine.rotor.loss_factor == 0) {
    put_growth(stability ? std::optional(growth_of(*stability)) : std::nullopt,
               fmt::format("at {:.6g} {}", deck::from_si(options.speed.value, options.speed.unit), options.speed.unit),
               "No vibration settles into these transfer functions", summary);
  }
  // Nobody asked for these frequencies: where one has no answer the study goes on.
  const auto beside = [&](const std::vector<double>& at) {
    const auto one = [&](std::size_t i) { return answer_of([&] { return machine.at({"machine"}, at[i]); }); };
    return distribute(layout, at.size(), one, pieces, "resonance", machine.trail());
  };
  const auto [narrow, at_narrow, endless] = between(frequencies, stability ? stability->values : std::vector<Complex>{},
                                                    search_of(context.machine.rotor, 0), beside);
  lost[0] = leave_out_poles(frequencies, std::move(lost[0]), endless, all[0]);
  if (std::ranges::none_of(lost[0], &std::string::empty)) return results.finish(lost[0].front(), false);
  const TransferBars bars = bars_of(context, layout, pieces, options, outputs, frequencies, all[0], endless, lost[0]);

  auto& group = results.group();
  group.set("speed", options.speed.value);
  group.set("frequency_unit", unit);
  auto& response = group.child("response");
  response.put("frequency", frequencies, "rad/s", "of force and motion");
  if (!bars.at.empty()) {
    group.child("bars").put("frequency", column(bars.at, [&](std::size_t k) { return frequencies[k]; }), "rad/s",
                            "at which errors are estimated: a few, and where each is largest");
  }
  for (std::size_t w = 0; w < ways.size(); ++w) {
    auto& table = response.child(ways[w].name);
    table.set("frequency", ways[w].frequency);
    const std::string head = w == 0 ? "no answer at" : fmt::format("no answer of '{}' at", ways[w].name);
    warn_of_lost_points(summary, head, lost[w], [&](std::size_t k) { return shown(frequencies[k]); });
  }
  const std::size_t inputs = options.inputs.size();
  const auto answers = [&](std::size_t at, std::size_t e) { return std::abs(all[0][at][e]) > rounding[at][e]; };
  std::vector<ResponseName> names;
  std::vector<std::string> silent;
  double most_by_shaft = 0;
  for (std::size_t o = 0; o < outputs.size(); ++o)
    for (std::size_t i = 0; i < inputs; ++i) {
      const std::string name = label(outputs[o]) + ".from." + label(options.inputs[i]),
                        of = unit_of(outputs[o], options.inputs[i]);
      names.push_back({name, of});
      for (std::size_t w = 0; w < ways.size(); ++w) {
        const auto of_each = [&](double (*part)(const Complex&)) {
          return column(all[w], [&](const auto& matrix) { return part(matrix[o * inputs + i]); });
        };
        const std::vector<double> amplitude = of_each(std::abs);
        auto& table = response.child(ways[w].name).child(name);
        table.put("real", of_each(std::real), of, "of the output over the input, for exp(+i w t)");
        table.put("imaginary", of_each(std::imag), of, "likewise");
        table.put("amplitude", amplitude, of, "0-peak over 0-peak");
        table.put("phase", of_each(std::arg), "rad", "of the output ahead of the input");
        if (w > 0) continue;
        const std::size_t e = o * inputs + i, most = largest_of(all[0], e);
        if (!put_endless(summary, names.back(), e, endless, bars.undamped, unit)) {
          std::map<std::string, double> bar;
          if (!bars.at.empty()) bar["uncertainty"] = bars.of(e, most);
          summary.set(name + ".largest", amplitude[most], of, bar);
          summary.set(name + ".largest_at", in_unit(frequencies[most]), unit);
        }
        if (!answers(most, e)) silent.push_back(name);
        if (bars.at.empty()) continue;
        std::optional<double> worst;
        for (std::size_t k = 0; k < bars.at.size(); ++k) {
          if (!answers(bars.at[k], e)) continue;
          const double part = bars.error[e][k] / amplitude[bars.at[k]];
          most_by_shaft = std::max(most_by_shaft, bars.shaft[e][k] / amplitude[bars.at[k]]);
          if (!worst || !(part <= *worst)) worst = part;  // unknown stays unknown
          if (std::isnan(*worst)) break;
        }
        if (worst) summary.set(name + ".relative_error", *worst, "1");
        group.child("bars").put(name, bars.error[e], of, "estimated error of the complex response from the meshes");
      }
    }
  for (std::size_t w = 1; w < ways.size(); ++w) {
    const Difference apart = difference(all[0], rounding, all[w], frequencies);
    summary.set(ways[w].name + ".difference", apart.relative, "1");
    summary.set(ways[w].name + ".difference_at", in_unit(apart.frequency), unit);
  }
  warn_of_endless(summary, endless, bars.undamped, names, unit);
  warn_of_passed_over(summary, narrow, at_narrow, frequencies, all[0], names, unit);
  if (!silent.empty())
    summary.warnings.push_back(
        fmt::format("no answer but rounding, below 1e-12 of the largest motion of the machine: {}. They are zero, and "
                    "have no relative error",
                    fmt::join(silent, ", ")));
  warn_of_shaft_mesh(summary, context.machine.rotor, {{"these transfer functions", most_by_shaft, most_of_amplitude}});
  const auto without = frequencies.size() - static_cast<std::size_t>(std::ranges::count(lost[0], std::string()));
  summary.points = static_cast<long>(frequencies.size() - without);
  return results.finish(status_of(without, frequencies.size(), "frequencies", "answer"), true);
}

}  // namespace whirl::study
