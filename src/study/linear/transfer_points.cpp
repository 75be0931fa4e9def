#include "study/linear/transfer_points.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "study/linear/response_peaks.hpp"
#include "study/linear/synchronous.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/rotor/freedom.hpp"

namespace whirl::study {

using core::check;
using Complex = std::complex<double>;

namespace {

template <class Point>
std::string place(const Point& p) {
  return (p.bearing.empty() ? fmt::format("node.{}.", *p.node) : fmt::format("bearing.{}.", p.bearing)) +
         std::string(deck::name_of(p.direction));
}

bool is_slope(Along a) {
  return a == Along::slope_x || a == Along::slope_y;
}

rotor::Freedom freedom_of(Along a) {
  return static_cast<rotor::Freedom>(a);
}
static_assert(static_cast<int>(Along::slope_y) == static_cast<int>(rotor::Freedom::slope_y));

int bearing_of(const system::RotorSystem& system, const std::string& name) {
  const auto& supports = system.train().supports;
  const auto found = std::find_if(supports.begin(), supports.end(), [&](const auto& s) { return s.name == name; });
  core::require(found != supports.end(), "an input or output at a bearing that is not there");
  return static_cast<int>(found - supports.begin());
}

}  // namespace

std::string label(const TransferInput& input) {
  return place(input);
}

std::string label(const TransferOutput& output) {
  return place(output) + (output.quantity == TransferOutput::Quantity::displacement
                              ? ""
                              : "." + std::string(deck::name_of(output.quantity)));
}

std::string unit_of(const TransferOutput& output, const TransferInput& input) {
  std::string below = is_slope(input.direction) ? "N m" : "N";
  if (output.quantity == TransferOutput::Quantity::velocity) below += " s";
  if (output.quantity == TransferOutput::Quantity::acceleration) below += " s^2";
  if (below != "N") below = "(" + below + ")";
  return (is_slope(output.direction) ? "1/" : "m/") + below;
}

TransferOutput output_of(const TransferInput& input) {
  return {input.node, input.bearing, input.direction, TransferOutput::Quantity::displacement};
}

std::vector<double> load_on(const rotor::Rotor& rotor, int node, rotor::Freedom freedom, double amount) {
  const rotor::Matrices& m = rotor.matrices();
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(m.mass.get()));
  PetscInt here = 0;
  check(MatGetLocalSize(m.mass.get(), &here, nullptr));
  core::Vector full, on = core::make_vector(comm, here, PETSC_DETERMINE);
  const bool reduced = static_cast<bool>(m.basis);
  if (reduced) check(MatCreateVecs(m.basis.get(), nullptr, full.put()));
  Vec to = reduced ? full.get() : on.get();
  check(VecSet(to, 0.0));
  const PetscInt row = reduced ? rotor::full_coordinate(node, freedom) : rotor.coordinate(node, freedom);
  if (core::rank_of(comm) == 0) check(VecSetValue(to, row, amount, ADD_VALUES));
  check(VecAssemblyBegin(to));
  check(VecAssemblyEnd(to));
  if (reduced) check(MatMultTranspose(m.basis.get(), to, on.get()));
  return core::gather(on.get());
}

TransferMatrix::TransferMatrix(system::RotorSystem& system, const std::vector<TransferInput>& inputs,
                               const std::vector<TransferOutput>& outputs)
    : system_(system), solver_(system), outputs_(outputs) {
  PetscInt begin = 0;
  const core::Vector rows = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  check(VecGetOwnershipRange(rows.get(), &begin, nullptr));
  for (const TransferInput& input : inputs) {
    const std::vector<double> force = load(input);
    auto& right = loads_.emplace_back(static_cast<std::size_t>(system.local_size()));
    // F holds minus the forces on its momentum rows; own states of films, behind all pairs, are not forced.
    for (PetscInt row = begin; row < std::min(begin + system.local_size(), 2 * system.coordinates()); ++row)
      if (row % 2 == 0) right[static_cast<std::size_t>(row - begin)] = force[static_cast<std::size_t>(row / 2)];
  }
}

// A unit force on the coordinates, whole on every rank.
std::vector<double> TransferMatrix::load(const TransferInput& input) const {
  if (!input.bearing.empty()) {
    std::vector<double> out(static_cast<std::size_t>(system_.coordinates()), 0.0);
    const int b = bearing_of(system_, input.bearing), d = static_cast<int>(input.direction);
    out[static_cast<std::size_t>(system_.journal(b, d))] += 1;
    if (const PetscInt pedestal = system_.pedestal(b, d); pedestal >= 0) out[static_cast<std::size_t>(pedestal)] -= 1;
    return out;
  }
  std::vector<double> out = load_on(system_.rotor(), *input.node, freedom_of(input.direction));
  out.resize(static_cast<std::size_t>(system_.coordinates()), 0.0);
  return out;
}

void TransferMatrix::linearise(Vec x) {
  x_ = core::duplicate(x);
  check(VecCopy(x, x_.get()));
  solver_.linearise(x);
}

void TransferMatrix::linearise_with_loss(double omega) {
  const system::RotorSystem::WithLoss loss(system_, omega > 0 ? system_.loss_at(omega) : system::RotorSystem::Loss{});
  solver_.linearise(x_.get());
}

Transfer TransferMatrix::at(double omega) {
  if (system_.train().rotor.loss_factor > 0) linearise_with_loss(omega);
  solver_.factorise({0, omega});
  const std::size_t inputs = loads_.size();
  Transfer out{std::vector<Complex>(outputs_.size() * inputs), std::vector<double>(outputs_.size() * inputs)};
  for (std::size_t i = 0; i < inputs; ++i) {
    const HarmonicState state = harmonic_response(system_, solver_, loads_[i]);
    std::vector<double> shaft[2];
    for (std::size_t part = 0; part < 2; ++part) shaft[part] = system_.shaft(state[part].data(), 0, false);
    const auto coordinate = [&](PetscInt q) {
      const auto k = static_cast<std::size_t>(2 * q);
      return Complex(state[0][k], state[1][k]);
    };
    std::array<double, 2> largest{};  // displacement, slope
    for (std::size_t k = 0; k < shaft[0].size(); ++k) {
      double& most = largest[rotor::is_slope(rotor::freedom_at(static_cast<int>(k)))];
      most = std::max(most, std::hypot(shaft[0][k], shaft[1][k]));
    }
    for (int b = 0; b < system_.n_bearings(); ++b)
      for (int d = 0; d < 2; ++d) largest[0] = std::max(largest[0], std::abs(coordinate(system_.journal(b, d))));
    for (std::size_t o = 0; o < outputs_.size(); ++o) {
      const TransferOutput& output = outputs_[o];
      Complex z;
      if (output.bearing.empty()) {
        const auto k = static_cast<std::size_t>(rotor::full_coordinate(*output.node, freedom_of(output.direction)));
        z = {shaft[0][k], shaft[1][k]};
      } else {
        const int b = bearing_of(system_, output.bearing), d = static_cast<int>(output.direction);
        z = coordinate(system_.journal(b, d));
        if (system_.pedestal(b, d) >= 0) z -= coordinate(system_.pedestal(b, d));
      }
      Complex rate = 1;
      if (output.quantity == TransferOutput::Quantity::velocity) rate = {0, omega};
      if (output.quantity == TransferOutput::Quantity::acceleration) rate = -omega * omega;
      out.values[o * inputs + i] = z * rate;
      out.rounding[o * inputs + i] = motion_rounding * largest[is_slope(output.direction)] * std::abs(rate);
    }
  }
  return out;
}

Difference difference(const Matrices& whole, const Roundings& rounding, const Matrices& other,
                      const std::vector<double>& frequencies) {
  Difference out;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    double apart = 0, size = 0, nothing = 0;
    for (std::size_t e = 0; e < whole[k].size(); ++e) {
      apart += std::norm(other[k][e] - whole[k][e]);
      size += std::norm(whole[k][e]);
      nothing += rounding[k][e] * rounding[k][e];
    }
    const double relative = size > nothing ? std::sqrt(apart / size) : 0;
    if (relative > out.relative) out = {relative, frequencies[k]};
  }
  return out;
}

}  // namespace whirl::study
