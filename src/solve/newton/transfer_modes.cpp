#include "solve/newton/transfer_modes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solve/newton/transfer_search.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/least_squares.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::solve {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

// Tolerance of the films' own eigenvalues, relative.
constexpr double pole_accuracy = 1e-10;

// Whether `z` is one of these or a combination.
bool in_span(const std::vector<VectorXcd>& found, const VectorXcd& z) {
  if (found.empty()) return false;
  MatrixXcd basis(z.size(), static_cast<Index>(found.size()));
  for (std::size_t k = 0; k < found.size(); ++k) basis.col(static_cast<Index>(k)) = found[k];
  const VectorXcd part = core::least_squares(basis, z);
  return (basis * part - z).norm() <= 1e-3 * z.norm();
}

// As of spectral::modes: SI, the largest entry of the scaled vector one.
spectral::Mode mode_of(Complex lambda, double rounding, std::vector<Complex> state, const std::vector<double>& scale) {
  Complex largest = 0;
  for (const Complex& v : state)
    if (std::abs(v) > std::abs(largest)) largest = v;
  for (std::size_t k = 0; k < state.size(); ++k) state[k] *= scale[k] / largest;
  return {lambda, std::move(state), rounding};
}

}  // namespace

TransferModes transfer_modes(problem::System& system, Vec x, const TransferOptions& options) {
  core::require(options.frequency > 0 && options.decay > 0, "a region for eigenvalues");
  FrequencyResolvent machine(system);
  machine.linearise(x);
  const Ellipse ellipse(options);
  std::vector<double> scale;
  if (options.shapes) {
    core::Vector states = core::duplicate(x), rows = core::duplicate(x);
    system.scales(states.get(), rows.get());
    scale = core::gather(states.get());
  }
  TransferModes out;
  std::vector<Complex> marks;  // places of det T near the edge, on both sides of it
  for (std::size_t i = 0; i < machine.ports().size(); ++i) try {
      for (const auto& pole : machine.poles(i, ellipse.target(), ellipse.radius())) {
        if (!pole.silent && pole.value.imag() >= 0) marks.push_back(pole.value);
        if (ellipse.level(pole.value) > 1) continue;
        ++out.poles;
        if (!pole.silent || pole.value.imag() < 0) continue;
        const double rounding = pole_accuracy * std::abs(pole.value);
        out.modes.push_back(options.shapes ? mode_of(pole.value, rounding, machine.state(i, pole.shape), scale)
                                           : spectral::Mode{pole.value, {}, rounding});
      }
    } catch (const core::NotConverged& e) {
      out.doubt = e.what();
    }
  const auto number = [](Complex z) { return z.imag() != 0 ? 2 : 1; };
  int silent = 0, found = 0;
  for (const spectral::Mode& m : out.modes) silent += number(m.lambda);

  // What the leader asks of all: H at a place, or the whole state of a motion.
  struct Order {
    double real = 0, imag = 0, ahead_real = 0, ahead_imag = 0, slopes = 0, shape = 0;
  } order;
  FrequencyResolvent::Transfers h;
  VectorXcd motion(machine.hub());
  std::vector<Complex> state;
  const auto part = [&] {
    core::share(system.comm(), &order.real, 6);
    if (order.shape == 0) {
      h = machine.evaluate({order.real, order.imag}, order.slopes != 0);
      return;
    }
    core::share(system.comm(), reinterpret_cast<double*>(motion.data()), 2 * static_cast<std::size_t>(motion.size()));
    state = machine.state(motion, {order.ahead_real, order.ahead_imag});
  };
  std::vector<spectral::Mode> modes;
  const auto work = [&](const std::function<void()>& together) {
    TransferSearch search(machine, options, [&](Complex lambda, bool slopes) {
      order = {lambda.real(), lambda.imag(), 0, 0, slopes ? 1.0 : 0.0, 0};
      ++out.solves;
      together();
      return h;
    });
    out.fit = search.sample();
    if (out.fit > options.fit) out.doubt = fmt::format("the fit of the films is off by {:.1e}", out.fit);
    const auto winding = search.winding(options.contour, marks);
    const auto count = [&](const std::optional<int>& turns) {
      if (turns)
        out.counted = *turns + out.poles;
      else
        out.doubt = "an eigenvalue lies on the edge of the region";
    };
    count(winding);
    const int wanted = winding ? std::max(0, out.counted - silent) : 20;
    std::vector<Root> fitted, roots;  // of the fit, of the machine
    const auto near = [&](Complex a, Complex b) { return std::abs(a - b) <= 1e-8 * ellipse.size(); };
    // A multiple eigenvalue has as many independent motions.
    const auto is_new = [&](std::vector<Root>& known, const Root& r) {
      std::vector<VectorXcd> same;
      for (const Root& k : known)
        if (near(k.lambda, r.lambda)) same.push_back(k.motion);
      if (in_span(same, r.motion)) return false;
      known.push_back(r);
      return true;
    };
    const auto try_all = [&](std::vector<Root> candidates) {
      for (Root& r : candidates) {
        if (!search.refine_on_fit(r)) continue;
        // The fit is real on the axis but for rounding, the machine is: Newton's method stays there.
        if (near(r.lambda, r.lambda.real())) {
          Index largest = 0;
          r.motion.cwiseAbs().maxCoeff(&largest);
          r = {r.lambda.real(), (r.motion / r.motion(largest)).real().cast<Complex>().normalized()};
        }
        if (!is_new(fitted, r)) continue;
        const auto ahead = search.refine(r);
        if (!ahead || ellipse.level(r.lambda) > 1) continue;
        if (std::abs(r.lambda.imag()) <= 1e-13 * ellipse.size()) r.lambda = r.lambda.real();
        if (r.lambda.imag() < 0 || !is_new(roots, r)) continue;
        found += number(r.lambda);
        if (!options.shapes) {
          modes.push_back({r.lambda, {}, r.rounding});
          continue;
        }
        order = {0, 0, ahead->real(), ahead->imag(), 0, 1};
        motion = r.motion;
        together();
        modes.push_back(mode_of(r.lambda, r.rounding, state, scale));
      }
    };
    if (wanted > 0)
      try_all(search.candidates({ellipse.centre, ellipse.along, ellipse.across, true}, options.contour, wanted));
    // Where many eigenvalues are near to each other one curve does not tell them apart.
    double radius = ellipse.size() / 2;
    for (int level = 0; level < options.levels && found < wanted; ++level, radius /= 2) {
      const double step = radius * std::numbers::sqrt2;  // circles about squares
      for (double up = step / 2; up < ellipse.across + step / 2 && found < wanted; up += step)
        for (double along = step / 2; along < 2 * ellipse.along + step / 2 && found < wanted; along += step) {
          const Complex centre(ellipse.centre - ellipse.along + along, up);
          if (ellipse.level({centre.real(), std::max(0.0, up - step / 2)}) < 1.2)
            try_all(search.candidates({centre, radius, radius, false}, 64, std::min(wanted, 16)));
        }
    }
    // Zeros near the edge are marks as well, once they are known.
    const double spacing = std::numbers::pi * ellipse.size() / options.contour;
    const std::size_t poles = marks.size();
    for (const Root& r : fitted)
      if (std::abs(ellipse.level(r.lambda) - 1) * ellipse.size() < spacing) marks.push_back(r.lambda);
    if (winding && marks.size() > poles) count(search.winding(options.contour, marks));
  };
  core::lead(system.comm(), 0, work, part);
  // Rank 0's for all.
  const bool first = core::rank_of(system.comm()) == 0;
  std::vector<double> facts{static_cast<double>(modes.size()), static_cast<double>(out.counted),
                            static_cast<double>(found), static_cast<double>(out.solves), out.fit};
  core::share(system.comm(), facts.data(), facts.size());
  if (!first) modes.resize(static_cast<std::size_t>(facts[0]));
  for (spectral::Mode& m : modes) {
    double head[] = {m.lambda.real(), m.lambda.imag(), m.rounding};
    core::share(system.comm(), head, 3);
    m.lambda = {head[0], head[1]};
    m.rounding = head[2];
    if (!options.shapes) continue;
    m.shape.resize(static_cast<std::size_t>(system.size()));
    core::share(system.comm(), reinterpret_cast<double*>(m.shape.data()), 2 * m.shape.size());
  }
  out.modes.insert(out.modes.end(), modes.begin(), modes.end());
  out.counted = static_cast<int>(facts[1]);
  out.solves = static_cast<int>(facts[3]);
  out.fit = facts[4];
  out.missed = std::max(0, out.counted - silent - static_cast<int>(facts[2]));
  if (out.doubt.empty() && out.counted < silent + static_cast<int>(facts[2]))
    out.doubt = "there are more eigenvalues than the count says";
  auto length = static_cast<int>(out.doubt.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, system.comm());
  out.doubt.resize(static_cast<std::size_t>(length));
  MPI_Bcast(out.doubt.data(), length, MPI_CHAR, 0, system.comm());
  std::sort(out.modes.begin(), out.modes.end(), [](const spectral::Mode& m, const spectral::Mode& n) {
    return std::pair(m.lambda.imag(), m.lambda.real()) < std::pair(n.lambda.imag(), n.lambda.real());
  });
  return out;
}

}  // namespace whirl::solve
