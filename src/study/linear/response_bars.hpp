#pragma once
// Error bars of the peaks of a linear response.

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "study/linear/response_peaks.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// The peak of the node with this number among those of the study; its values in the summary start with `head`.
struct NamedPeak {
  std::string head;
  std::size_t node = 0;
  double speed = 0, height = 0, amplification = 0;  ///< [rad/s, m, 1]
  PeakErrors errors = {};
  bool vanishes = false;  ///< on another film mesh the response has no peak there
};

/// The response on one film mesh: semi-major axes [speed][node], and the values at operating speed.
struct MeshResponse {
  std::vector<std::vector<double>> height;
  io::StudySummary operating;
};
using SolveOnMesh = std::function<MeshResponse(const std::array<double, 2>& film_cells, std::vector<double> speeds,
                                               const std::string& piece)>;
using PutPeak = std::function<void(io::StudySummary& to, const std::string& head, double speed, double height,
                                   double amplification)>;

/// Puts bars beside all values of the summary. On each other film mesh a peak is the foot of the parabola of 1/f^2
/// through three speeds about it; it moves as that top does against the one of the mesh in use. Peaks that stand
/// together share their three speeds. The amplification factor changes like Q, the root of the curvature over the
/// height of that parabola. Where the response of another mesh bends upwards there, the peak is none on that mesh: its
/// bars are unknown, and it `vanishes`. Where `solve` fails on the mesh in use all bars are unknown, which a warning
/// says. Collective.
void put_response_bars(io::StudySummary& summary, const std::vector<FilmMesh>& meshes, const MeshLaw& law,
                       std::vector<NamedPeak>& peaks, const PutPeak& put, const SolveOnMesh& solve);

}  // namespace whirl::study
