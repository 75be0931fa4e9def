#pragma once
// XDMF beside an HDF5 file, so that ParaView opens its meshes.

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "whirl/io/record.hpp"

namespace whirl::io {

/// A film that is unrolled onto a plane has a name that ends with this.
inline constexpr std::string_view unwrapped = " unwrapped";

/// A structured mesh of n0 x n1 (x n2) nodes whose fields are datasets of that shape, or, where they belong to its
/// cells, of one less in each extent.
struct StructuredGrid {
  struct Field {
    std::string name;     ///< as ParaView shows it, with its unit
    std::string dataset;  ///< path in the HDF5 file
  };
  std::string name;
  Shape nodes;              ///< two or three extents, slowest index first
  std::string coordinates;  ///< path of the dataset of shape `nodes` x 3: x, y, z of each node
  std::vector<Field> fields;
  bool of_cells = false;
};

/// Writes `path` (atomic) that refers to `hdf5_name`, a file in the same folder. The grids appear as one block each.
void write_xdmf(const std::filesystem::path& path, const std::string& hdf5_name,
                const std::vector<StructuredGrid>& grids);

/// Where the film of a pad lies in space.
struct FilmPlace {
  double radius = 0;                  ///< m, of the wrapped surface
  double centre_x = 0, centre_y = 0;  ///< m, bearing centre
  double centre_z = 0;                ///< m, axial position of the film's z = 0
};

/// Prepares one pad for ParaView: adds node coordinates to `pad` and returns its grids "<name>" (wrapped around the
/// shaft) and "<name> unwrapped" (x = radius * theta, y = z).
///
/// `pad` holds theta[n_theta] (rad), z[n_z] (m) and fields of shape [n_theta][n_z]; `path` is the place of `pad` in the
/// file, "/studies/..."; every such field becomes a field of both grids. Where the fields are shared, all in the same
/// rows, the coordinates are as well.
[[nodiscard]] std::vector<StructuredGrid> film_grids(Group& pad, const std::string& path, const std::string& name,
                                                     const FilmPlace& place);

/// Prepares a body of cells for ParaView: adds to `body` the positions of their corners as the dataset `corners`, of
/// shape `cells` + 1 x 3, and returns its grid. Finite volumes are shown as they are, a ring without a seam.
///
/// Every dataset of `body` of shape `cells` (two or three extents, rows first) becomes a field; `path` is the place of
/// `body` in the file. `position` gives x, y, z [m] of the corner before cell (row, column, layer), the last one a step
/// beyond the last cell. Where the fields are shared by rows, so are the corners: those of the last row are written by
/// the rank that has the last cells, and position() is asked for no others.
[[nodiscard]] StructuredGrid cell_grid(Group& body, const std::string& path, const std::string& name,
                                       const std::string& corners, const Shape& cells,
                                       const std::function<std::array<double, 3>(const Shape& corner)>& position);

}  // namespace whirl::io
