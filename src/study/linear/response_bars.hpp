#pragma once
// Error bars of the peaks of a linear response.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "study/linear/response_peaks.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// A peak of one of the places of the study; its values in the summary start with `head`.
struct NamedPeak {
  std::string head;
  std::size_t place = 0;
  double speed = 0, height = 0, amplification = 0;  ///< [rad/s, m, 1]
  PeakErrors errors = {};
  /// Speeds of the lowest places between it and what is higher, of a peak that stands out little; else none.
  std::vector<double> saddles = {};
  bool vanishes = false;  ///< on another mesh the response has no peak there
};

/// Names of the value that says how far a peak of little height stands out [m].
inline constexpr const char* prominence = "prominence";

/// The response on one mesh: semi-major axes [speed][place], and the values at operating speed.
struct MeshResponse {
  std::vector<std::vector<double>> height;
  io::StudySummary operating;
};
/// `mesh` of spacing one: that in use.
using SolveOnMesh =
    std::function<MeshResponse(const FilmMesh& mesh, std::vector<double> speeds, const std::string& piece)>;
using PutPeak = std::function<void(io::StudySummary& to, const std::string& head, double speed, double height,
                                   double amplification)>;

/// Puts bars beside all values of the summary. On each other mesh, of the films and of the shaft, a peak is the foot of
/// the parabola of 1/f^2 through three speeds about it; it moves as that top does against the one of the mesh in use.
/// Peaks that stand together share their three speeds. The amplification factor changes like Q, the root of the
/// curvature over the height of that parabola. A peak with `saddles` gets a value `prominence`: its height above the
/// higher one of them, on every mesh at the same speeds, so that its bar says whether there is a peak at all. Where the
/// response of another mesh bends upwards there, the peak is none on that mesh: its bars are unknown, and it
/// `vanishes`. Where `solve` fails on the mesh in use all bars are unknown, which a warning says. Collective.
void put_response_bars(io::StudySummary& summary, const std::vector<FilmMesh>& meshes, const MeshLaw& law,
                       std::vector<NamedPeak>& peaks, const PutPeak& put, const SolveOnMesh& solve);

/// What the summary has of a peak with its bars, into its entry, and the verdict on its margin: "undetermined" with a
/// note where `doubt` or a bar leaves open whether there is a peak at all.
void take_bars(const io::StudySummary& summary, const NamedPeak& peak, std::string doubt, io::PeakEntry& entry);

/// Warns where the mesh of the shaft leaves much in the values of peaks or in the amplitudes of `nodes` at operating
/// speed, of which less than `operating_rounding` [m] is but rounding.
void warn_of_shaft_mesh(io::StudySummary& summary, const rotor::Options& rotor, const std::vector<NamedPeak>& named,
                        const std::vector<int>& nodes, double operating_rounding);

}  // namespace whirl::study
