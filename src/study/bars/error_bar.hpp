#pragma once
// How far a number computed on a mesh is from its limit: one estimator for all studies.

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace whirl::study {

/// What is not known, of numbers and bars.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Directions in which a discretisation has a mesh: around and along a bearing, in time, and along the shaft.
enum class Axis { around, along, time, shaft };
inline constexpr std::array<Axis, 4> all_axes{Axis::around, Axis::along, Axis::time, Axis::shaft};
/// Of a film.
[[nodiscard]] constexpr bool of_film(Axis axis) {
  return axis == Axis::around || axis == Axis::along;
}

/// A mesh that differs from the one in use in one direction.
struct OtherMesh {
  Axis axis = Axis::around;
  std::array<double, 2> factor{1, 1};  ///< cells of all films over cells in use, before rounding
  double spacing = 1;                  ///< over the spacing in use, after rounding
};

/// The same number on a mesh that differs in one direction; `spacing` is its spacing over that of the mesh in use. NaN:
/// it could not be had there.
struct Sample {
  Axis axis = Axis::around;
  double spacing = 1;
  double value = 0;
};

/// What is known of the discretisation before anything is computed.
struct MeshLaw {
  bool estimated = true;  ///< false: nothing is computed on other meshes, and every bar is unknown
  double film_order = 2;
  double time_order = 2;
  double shaft_order = 4;
  /// The force of a film has kinks in the journal's place, of its own mesh: errors need not fall regularly.
  bool kinks = false;
  /// The force of a film is smooth between places where a derivative jumps: normal forms of it are those of its mesh.
  bool piecewise = false;
  /// What feeds a film stands elsewhere on some of the meshes, as only nodes can hold it: two of them may agree by
  /// chance.
  bool feeds_move = false;
};

/// An error bar by its parts; NaN: unknown.
struct Bar {
  double film_mesh = 0;
  double time_mesh = 0;
  double shaft_mesh = 0;
  double kinks = 0;     ///< of a film with kinks: what these scatter from mesh to mesh
  double location = 0;  ///< what an iteration left
  [[nodiscard]] double total() const { return film_mesh + time_mesh + shaft_mesh + kinks + location; }
  /// Its parts as a summary names them: uncertainty_film_mesh, ...; time only where there is such a mesh, shaft and
  /// kinks where they are not zero.
  [[nodiscard]] std::map<std::string, double> parts(bool with_time) const;
};

/// The error of `value` by the numbers on other meshes; each direction alone.
///
/// A number of order p is Q(h) = Q(0) + C h^p. Each sample gives C, that is an estimate of the error here,
///
///     e_i = (Q(1) - Q(r_i))/(1 - r_i^p)
///
/// with p from theory or, where three meshes show a smaller one, as observed (not below 1/2); a larger one is not
/// believed. The finest sample gives the error. What the others say differently, and a quarter of the largest of them,
/// is the doubt. Errors of the two film directions may cancel, and do so differently on each mesh: absolute values are
/// added, bar = sum |e| + sum doubt, which is zero only where all meshes agree. A direction with one sample cannot show
/// its order: its bar is three times |e| (Roache 1994).
///
/// Where feeds move from mesh to mesh, each number has the error of another place in it, which may cancel what the
/// spacing does: the spread of all meshes is added, which is zero only where they all agree.
///
/// Film directions of a force with kinks: where a kink stands among the nodes is chance, on each mesh anew, so that no
/// two meshes show how the error falls. The numbers on all meshes of a direction, this one included, scatter by s h
/// about Q(0) alone, or about Q(0) + C h^p where C is significant, larger than t times its own deviation; p is one or
/// that of theory, and where both show a slope whichever gives the longer bar. Q(0) is known but for u, its standard
/// deviation by least squares with weights 1/h^2. bar = sum |C| + sum |Q(1) - Q(0) - C| + t (sum u^2)^(1/2), of which
/// the first counts as error of the mesh and the rest as that of kinks; t is Student's quantile of 95 % (two-sided) for
/// the degrees of freedom of Welch and Satterthwaite. Unknown with fewer than three meshes in a direction, unless they
/// agree. It holds for numbers that scatter independently: where all meshes see one and the same oscillation it covers
/// less. Source: regression by least squares; JCGM 100:2008, G.4, for t.
[[nodiscard]] Bar error_bar(double value, const std::vector<Sample>& samples, const MeshLaw& law);

/// What Student's t with `freedoms` >= 1 degrees of freedom stays below in absolute value with this probability.
[[nodiscard]] double student_quantile(double probability, int freedoms);

/// Bars of many numbers at once, from the same numbers computed on one mesh after another.
class Bars {
public:
  Bars(std::vector<double> values, MeshLaw law) : values_(std::move(values)), law_(law) {}
  /// What came out on another mesh, in the same order; empty: nothing.
  void add(Axis axis, double spacing, const std::vector<double>& values);
  [[nodiscard]] Bar operator[](std::size_t k) const;

private:
  std::vector<double> values_;
  MeshLaw law_;
  std::vector<std::vector<Sample>> samples_;
};

/// Whether a number with this bar is on one side of `border`.
[[nodiscard]] inline bool decided(double value, double uncertainty, double border = 0) {
  return value - border > uncertainty || border - value > uncertainty;
}

}  // namespace whirl::study
