#pragma once
// What an evaluation of a share of a film of gas takes and gives.

#include "film/gas/gas_film.hpp"

namespace whirl::film {

struct GasFilm::Part {
  JournalMotion motion;
  Lines lines;
  std::span<const double> states;
  bool tangents;
  StateResponse& response;
  std::size_t rows;  // of nodes
  double *centre = nullptr, *before = nullptr, *after = nullptr, *below = nullptr, *above = nullptr;

  // dh/d(position) at an angle, for all ports.
  using Levers = std::array<double, 4>;
  static Levers levers(double c, double s, double along) { return {-c, -s, -along * c, -along * s}; }
  [[nodiscard]] double turn(const Levers& w) const {
    return motion.position[0] * w[0] + motion.position[1] * w[1] + motion.position[2] * w[2] +
           motion.position[3] * w[3];
  }
  [[nodiscard]] double grows(const Levers& w) const {
    return motion.velocity[0] * w[0] + motion.velocity[1] * w[1] + motion.velocity[2] * w[2] +
           motion.velocity[3] * w[3];
  }
  void add_position(std::size_t row, double by_h, const Levers& w) const {
    for (Eigen::Index n = 0; n < response.forces.rows(); ++n)
      response.inputs(n, static_cast<Eigen::Index>(row)) += by_h * w[static_cast<std::size_t>(n)];
  }
};

}  // namespace whirl::film
