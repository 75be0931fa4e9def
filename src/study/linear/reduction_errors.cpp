#include "study/linear/reduction_errors.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "study/linear/compared_modes.hpp"
#include "study/linear/linear_brief.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/rotor/modal_coupling.hpp"

namespace whirl::study {
namespace {

using Eigen::MatrixXd;

std::string name_of(ReductionMethod method) {
  return std::string(deck::name_of(method));
}

// Machines of one rank, the same on all.
class Comparison {
public:
  Comparison(Context& context, const ReductionErrorsOptions& options)
      : context_(context),
        options_(options),
        train_(system::train_of(context.machine,
                                options.orbits ? options.orbits->unbalance : std::vector<std::string>{})) {
    train_.rotor.reduction = {};
    masters_ = system::acting_nodes(context.machine);
    slopes_ = system::slope_nodes(context.machine);
    for (const int node : options.masters)
      if (std::find(masters_.begin(), masters_.end(), node) == masters_.end()) masters_.push_back(node);
  }

  StudyResult run() {
    system::RotorSystem whole(PETSC_COMM_SELF, train_, options_.speed);
    Walker walker(whole);
    Vec rest = walker.at(options_.speed);
    const WholeModes modes(whole, rest, options_.count);
    support_ = options_.support > 0 ? options_.support : mean_stiffness(modes.films());
    auto& results = context_.results;
    auto& summary = results.summary();
    for (Eigen::Index k = 0; k < modes.frequencies().size(); ++k)
      summary.set(fmt::format("frequency.{}", k + 1), modes.frequencies()(k), "rad/s");
    compare(modes);
    if (options_.maps > 0) put_maps(modes);
    if (options_.orbits) put_orbits(whole, modes);
    summary.points = answered_;
    return results.finish("completed", true);
  }

private:
  // Whether a reduction has an answer; if not a warning says why, and the others go on. `compute` is the same on all
  // ranks and does not communicate.
  [[nodiscard]] bool answers(ReductionMethod method, int freedoms, const std::string& what,
                             const std::function<void()>& compute) {
    std::string reason;
    if (has_answer([&] { core::agree(context_.comm, compute); }, &reason)) return true;
    std::string& line = context_.results.summary().warnings.emplace_back(
        fmt::format("{}, {} freedoms: no {}: {}", name_of(method), freedoms, what, reason));
    if (first_reason_.empty()) first_reason_ = line;
    return false;
  }

  [[nodiscard]] double mean_stiffness(const MatrixXd& films) const {
    double sum = 0;
    Eigen::Index ports = 0;
    for (const system::Support& s : train_.supports) {
      for (Eigen::Index d = 0; d < 2; ++d) sum -= films(ports + d, 2 * ports + d);
      ports += film::facts(s.film).tilts ? 4 : 2;
    }
    return std::max(sum / (2 * static_cast<double>(train_.supports.size())), 0.0);
  }

  [[nodiscard]] system::Train reduced(ReductionMethod method, int freedoms) const {
    using enum rotor::Reduction::Type;
    const int modes = freedoms / 2, held = static_cast<int>(masters_.size() + slopes_.size());
    system::Train out = train_;
    rotor::Reduction& r = out.rotor.reduction;
    r.masters = masters_;
    r.slopes = slopes_;
    switch (method) {
      case ReductionMethod::modal_supported:
      case ReductionMethod::modal_free:
        r.type = modal;
        r.modes = modes;
        r.support = method == ReductionMethod::modal_free ? 0 : support_;
        break;
      case ReductionMethod::craig_bampton:
        r.type = craig_bampton;
        r.modes = modes - held;
        break;
      case ReductionMethod::craig_bampton_state:
        r.type = craig_bampton_state;
        r.modes = modes - held;
        r.speed = options_.speed;
    }
    return out;
  }

  void compare(const WholeModes& modes) {
    const std::size_t methods = options_.methods.size(), sizes = options_.freedoms.size(),
                      count = static_cast<std::size_t>(options_.count);
    std::vector<double> frequency, vector, diagonal, freedoms(options_.freedoms.begin(), options_.freedoms.end());
    std::vector<std::string> method_names;
    auto& summary = context_.results.summary();
    for (const ReductionMethod method : options_.methods) {
      method_names.push_back(name_of(method));
      for (const int kept : options_.freedoms) {
        WholeModes::Errors e;
        if (!answers(method, kept, "errors", [&] {
              system::RotorSystem small(PETSC_COMM_SELF, reduced(method, kept), options_.speed);
              e = modes.errors(small);
            })) {
          for (auto* column : {&frequency, &vector, &diagonal}) column->insert(column->end(), count, io::no_value);
          continue;
        }
        ++answered_;
        for (Eigen::Index k = 0; k < e.frequency.size(); ++k) {
          frequency.push_back(e.frequency(k));
          vector.push_back(e.vector(k));
          diagonal.push_back(std::abs(e.r(k, k)));
        }
        const std::string head = fmt::format("{}.{}", method_names.back(), kept);
        summary.set(head + ".frequency_error", e.frequency.maxCoeff(), "1");
        summary.set(head + ".vector_error", e.vector.maxCoeff(), "1");
        context_.results.progress(fmt::format("{}: {}, {} freedoms, {:.1f} s", summary.name, method_names.back(), kept,
                                              context_.results.seconds()));
      }
    }
    if (answered_ == 0) throw core::NotConverged(first_reason_);
    auto& table = context_.results.group().child("errors");
    const io::Shape shape{methods, sizes, count};
    table.put("method", method_names, "reduction of the shaft");
    table.put("freedoms", freedoms, "1", "freedoms kept, of both planes");
    table.put("whole", std::vector<double>(modes.frequencies().begin(), modes.frequencies().end()), "rad/s",
              "whirl frequencies with the whole shaft");
    table.put("frequency", shape, frequency, "1",
              "|Im s/Im s_whole - 1| [method][freedoms][mode], not a number where a reduction has no answer");
    table.put("vector", shape, vector, "1",
              "distance of eigenvectors of length one in the energy norm [method][freedoms][mode]");
    table.put("diagonal", shape, diagonal, "1",
              "|R_kk| of R = I - W^T N V*, vectors of length one in the energy norm [method][freedoms][mode]");
    table.label_each({io::labels_of(freedoms, "freedoms"), io::numbered(count, "mode")});
  }

  void put_matrix(io::Group& to, const char* name, const MatrixXd& a, const char* text) {
    std::vector<double> rows;
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      for (Eigen::Index j = 0; j < a.cols(); ++j) rows.push_back(a(i, j));
    to.put(name, {static_cast<std::size_t>(a.rows()), static_cast<std::size_t>(a.cols())}, std::move(rows), "1", text);
  }

  // Entries in SI; their units differ from one to the next.
  void put_maps(const WholeModes& modes) {
    auto& maps = context_.results.group().child("maps");
    maps.set("freedoms", options_.maps);
    maps.set("speed", options_.speed);
    for (const auto& [name, support] : {std::pair{"supported", support_}, std::pair{"free", 0.0}}) {
      const auto coupling = rotor::gyroscopic_coupling(train_.rotor, masters_, support);
      put_matrix(maps.child("coupling"), name, coupling.matrix,
                 "V^T G V of all mass-normalised real modes of a plane, by rising frequency");
    }
    const auto block = [](const MatrixXd& a, Eigen::Index row, Eigen::Index column) {
      return MatrixXd(a(Eigen::seq(row, Eigen::last, 2), Eigen::seq(column, Eigen::last, 2)));
    };
    for (const ReductionMethod method : options_.methods) {
      MatrixXd r, rates, rest;
      bool in_states = false;
      if (!answers(method, options_.maps, "maps", [&] {
            system::RotorSystem small(PETSC_COMM_SELF, reduced(method, options_.maps), options_.speed);
            r = modes.errors(small).r.cwiseAbs();
            const auto rotor_rows = Eigen::seqN(0, 2 * small.rotor().size());
            rates = MatrixXd(small.structure()->l1())(rotor_rows, rotor_rows);
            rest = MatrixXd(small.structure()->l0())(rotor_rows, rotor_rows);
            in_states = small.rotor().states().has_value();
          }))
        continue;
      auto& of = maps.child(name_of(method));
      put_matrix(of, "R", r, "|R| of R = I - W^T N V*");
      if (in_states) {
        put_matrix(of, "N", rates, "L^T N R: states of masters, then of modes; the two rows of a pair are exchanged");
        put_matrix(of, "P", rest, "L^T P R at the speed, without films");
      } else {
        put_matrix(of, "M", block(rates, 0, 1), "reduced mass matrix");
        put_matrix(of, "K", block(rest, 0, 0), "reduced stiffness matrix, without films");
        put_matrix(of, "G", block(rest, 0, 1), "reduced damping and gyroscopic matrix at the speed");
      }
    }
  }

  void put_orbits(system::RotorSystem& whole, const WholeModes& modes) {
    const ReductionOrbits& o = *options_.orbits;
    auto& group = context_.results.group().child("orbits");
    auto& summary = context_.results.summary();
    group.set("node", o.node);
    group.set("speed", options_.speed);
    const double step = 2 * std::numbers::pi / (options_.speed * o.samples);
    const auto samples = static_cast<Eigen::Index>(std::lround(o.revolutions * o.samples)) + 1;
    const Orbit exact = orbit_from_rest(whole, modes.films(), o.node, step, samples);
    const double size = exact.colwise().norm().maxCoeff();
    const auto component = [](const Orbit& orbit, Eigen::Index d) {
      const Eigen::VectorXd row = orbit.row(d);
      return std::vector<double>(row.begin(), row.end());
    };
    std::vector<double> time;
    for (Eigen::Index k = 0; k < samples; ++k) time.push_back(step * static_cast<double>(k));
    group.put("time", time, "s", "since the unbalance set in");
    group.put("x", component(exact, 0), "m", "orbit of the node of the whole shaft, from where it rests");
    group.put("y", component(exact, 1), "m", "orbit of the node of the whole shaft, from where it rests");
    summary.set("orbit.size", size, "m");
    std::vector<double> errors, x, y, freedoms(o.freedoms.begin(), o.freedoms.end());
    for (const ReductionMethod method : options_.methods)
      for (const int kept : o.freedoms) {
        Orbit found;
        if (!answers(method, kept, "orbit", [&] {
              system::RotorSystem small(PETSC_COMM_SELF, reduced(method, kept), options_.speed);
              found = orbit_from_rest(small, modes.films(), o.node, step, samples);
            })) {
          errors.push_back(io::no_value);
          for (auto* to : {&x, &y}) to->insert(to->end(), static_cast<std::size_t>(samples), io::no_value);
          continue;
        }
        const double error = (found - exact).colwise().norm().maxCoeff();
        errors.push_back(size > 0 ? error / size : 0);
        summary.set(fmt::format("orbit.{}.{}.error", name_of(method), kept), errors.back(), "1");
        for (const auto& [to, d] : {std::pair{&x, 0}, std::pair{&y, 1}}) {
          const std::vector<double> values = component(found, d);
          to->insert(to->end(), values.begin(), values.end());
        }
      }
    const io::Shape shape{options_.methods.size(), o.freedoms.size(), static_cast<std::size_t>(samples)};
    group.put("freedoms", freedoms, "1", "freedoms of the reduced shafts");
    group.put("reduced_x", shape, x, "m", "the same of the reduced shafts [method][freedoms][time]");
    group.put("reduced_y", shape, y, "m", "the same of the reduced shafts [method][freedoms][time]");
    group.put("error", {shape[0], shape[1]}, errors, "1",
              "largest distance from the orbit of the whole shaft over the size of this [method][freedoms]");
    group.label("error", {io::labels_of(freedoms, "freedoms")});
  }

  Context& context_;
  const ReductionErrorsOptions& options_;
  system::Train train_;
  std::vector<int> masters_, slopes_;
  double support_ = 0;
  long answered_ = 0;         // reductions with errors
  std::string first_reason_;  // of those without an answer
};

}  // namespace

StudyResult ReductionErrors::run(Context& context) {
  return Comparison(context, options).run();
}

io::Brief ReductionErrors::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  if (!result.delivered || result.summary.values.empty()) return {};
  const auto table = [&](std::string caption, const std::vector<int>& sizes, const std::string& head,
                         const std::string& tail, std::string note) {
    io::BriefTable out{std::move(caption), {{"freedoms"}}, {}, std::move(note)};
    for (const ReductionMethod method : options.methods) out.columns.push_back({name_of(method), "%"});
    for (const int kept : sizes) {
      auto& row = out.rows.emplace_back();
      row.emplace_back(std::to_string(kept));
      for (const ReductionMethod method : options.methods) {
        const io::Quantity q = v[fmt::format("{}{}.{}.{}", head, name_of(method), kept, tail)];
        row.push_back(std::isnan(q.value) ? io::BriefCell("no answer")
                                          : io::BriefCell(to_digits(scaled(q, 100, "%"), 3)));
      }
    }
    return out;
  };
  io::Brief out;
  // The smallest shaft from which on all larger ones keep every frequency.
  constexpr double wanted = 1e-3;
  std::vector<std::string> enough;
  for (const ReductionMethod method : options.methods) {
    int least = 0;
    std::vector<int> sizes = options.freedoms;
    std::ranges::sort(sizes, std::greater{});
    for (const int kept : sizes) {
      if (!(v[fmt::format("{}.{}.frequency_error", name_of(method), kept)].value < wanted)) break;
      least = kept;
    }
    enough.push_back(fmt::format("{} {}", name_of(method), least > 0 ? std::to_string(least) : "more than tried"));
  }
  out.sentences.push_back(
      fmt::format("freedoms that keep the {} lowest whirl frequencies to 0.1 %: {}", options.count, in_words(enough)));
  out.tables.push_back(table(fmt::format("Largest error of the {} lowest whirl frequencies", options.count),
                             options.freedoms, "", "frequency_error", "against the whole shaft"));
  out.tables.push_back(table("Largest error of their eigenvectors", options.freedoms, "", "vector_error",
                             "distance of vectors of length one in the energy norm; 100 %: as far apart as can be"));
  if (options.orbits)
    out.tables.push_back(
        table(fmt::format("Orbits of node {} from rest under the unbalance", options.orbits->node),
              options.orbits->freedoms, "orbit.", "error",
              fmt::format("largest distance, of the size of the orbit, {}", io::reading(v["orbit.size"]))));
  return out;
}

}  // namespace whirl::study
