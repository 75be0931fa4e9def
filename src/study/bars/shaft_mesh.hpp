#pragma once
// The mesh of the shaft beside the one in use: every segment cut into shorter elements.

#include <functional>
#include <string>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/options.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

/// Order at which frequencies of a shaft of these elements converge: four, but two with the default one, whose shear
/// angle is that of the static solution. Source: the elements' table (room rotor), measured.
[[nodiscard]] double order_of_shaft(rotor::BeamElement element);

/// Whether bars are wanted, and the machine has a shaft of beams.
[[nodiscard]] bool has_shaft_mesh(const system::Machine& machine, const LayoutOptions& layout);

/// Whether shorter elements have other matrices: elements at rest are exact, so that a shaft with static reduction has
/// the same reduced ones.
[[nodiscard]] bool shaft_mesh_matters(const system::Machine& machine, const LayoutOptions& layout);

/// The mesh of with_cut_shaft(train, 2) among those that bars stand on.
inline const FilmMesh cut_shaft_mesh{Axis::shaft, {1, 1}, 0.5};
/// Into how many parts a mesh cuts the segments.
[[nodiscard]] constexpr int parts_of(const FilmMesh& mesh) {
  return mesh.axis == Axis::shaft ? 2 : 1;
}

/// Warns of bifurcations in the summary whose bars leave out the mesh of the shaft, where it matters, and of those in
/// which it leaves more than most_of_frequency.
void warn_of_shaft_mesh(io::StudySummary& summary, const system::Machine& machine, const LayoutOptions& layout);
/// Warns likewise of the bars of a curve, none of which knows the mesh of the shaft.
void warn_curve_without_shaft_mesh(io::StudySummary& summary, const system::Machine& machine,
                                   const LayoutOptions& layout);

/// What the mesh of the shaft may leave in numbers of one kind.
struct ShaftError {
  const char* what = "";  ///< "the frequencies of these modes"
  double part = 0;        ///< the largest error, relative to its number
  double most = 0;        ///< up to which nothing is said
};
/// Of a frequency or a speed, and of an amplitude, which moves by more where a resonance is near.
inline constexpr double most_of_frequency = 0.01, most_of_amplitude = 0.05;
/// Warns of those that are larger than is right, with the element and what to do, in one sentence. `element`: as the
/// sentence names it, where it is not that of the rotor.
void warn_of_shaft_mesh(io::StudySummary& summary, const rotor::Options& rotor, const std::vector<ShaftError>& errors,
                        const std::string& element = {});
/// Puts the largest error of a frequency as "shaft_mesh.largest_error" [1] and warns of it; nothing of zero, that is
/// where it is not known.
void put_shaft_error(io::StudySummary& summary, const rotor::Options& rotor, double part,
                     const std::string& element = {});

/// Bars of the lowest frequencies of a shaft, which hang on its mesh alone and converge with `order`: `on` computes
/// them again with every segment cut in two, and in four where the shaft has fewer than four elements for each of them.
/// There two meshes may agree by chance: sqrt(12)/h of a bar of linear elements is the highest frequency on n and
/// the n-th on 2 n of them. NaN: unknown.
[[nodiscard]] std::vector<double> bars_of_shaft(const std::vector<double>& here, const rotor::Options& rotor,
                                                double order, const std::function<std::vector<double>(int parts)>& on);
/// The largest of the bars over their frequencies; zero without any that is known.
[[nodiscard]] double largest_part(const std::vector<double>& bars, const std::vector<double>& frequencies);

/// The train with every beam of its shaft cut into `parts` equal ones; what stands at nodes stays in its place.
[[nodiscard]] system::Train with_cut_shaft(system::Train train, int parts);
/// The train on one of the meshes that bars stand on, of its films or of its shaft.
[[nodiscard]] system::Train on_mesh(system::Train train, const FilmMesh& mesh);

}  // namespace whirl::study
