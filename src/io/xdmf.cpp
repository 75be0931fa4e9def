#include "whirl/io/xdmf.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <optional>

#include "io/atomic_file.hpp"
#include "whirl/core/error.hpp"

namespace whirl::io {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

StructuredGrid::Field shown(const std::string& name, const Dataset& data, const std::string& path) {
  return {data.unit.empty() ? name : name + " [" + data.unit + "]", path + "/" + name};
}

}  // namespace

void write_xdmf(const std::filesystem::path& path, const std::string& hdf5_name,
                const std::vector<StructuredGrid>& grids) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
      "  <Grid Name=\"whirl\" GridType=\"Collection\" CollectionType=\"Spatial\">\n";
  const auto out = std::back_inserter(xml);
  for (const StructuredGrid& g : grids) {
    core::require(g.nodes.size() == 2 || g.nodes.size() == 3, "a structured grid has two or three extents");
    const std::string extents = fmt::format("{}", fmt::join(g.nodes, " "));
    Shape values = g.nodes;
    for (std::size_t& n : values) n -= g.of_cells ? 1 : 0;
    const auto item = [&](const std::string& dataset, const Shape& shape, const char* components = "") {
      return fmt::format(
          "<DataItem Dimensions=\"{}{}\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">{}:{}</DataItem>",
          fmt::join(shape, " "), components, escaped(hdf5_name), escaped(dataset));
    };
    fmt::format_to(
        out,
        "   <Grid Name=\"{}\" GridType=\"Uniform\">\n    <Topology TopologyType=\"{}DSMesh\" Dimensions=\"{}\"/>\n",
        escaped(g.name), g.nodes.size(), extents);
    // The three coordinates of a node together: ParaView's newer readers know no other way.
    fmt::format_to(out, "    <Geometry GeometryType=\"XYZ\">\n     {}\n    </Geometry>\n",
                   item(g.coordinates, g.nodes, " 3"));
    for (const StructuredGrid::Field& f : g.fields)
      fmt::format_to(out,
                     "    <Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"{}\">\n     {}\n    </Attribute>\n",
                     escaped(f.name), g.of_cells ? "Cell" : "Node", item(f.dataset, values));
    fmt::format_to(out, "   </Grid>\n");
  }
  xml += "  </Grid>\n </Domain>\n</Xdmf>\n";
  replace_file(path, xml);
}

std::vector<StructuredGrid> film_grids(Group& pad, const std::string& path, const std::string& name,
                                       const FilmPlace& place) {
  const std::vector<double> theta = pad.reals("theta"), z = pad.reals("z");
  const Shape shape = {theta.size(), z.size()};
  StructuredGrid wrapped{name, shape, path + "/node_xyz", {}};
  std::optional<RowRange> share;
  std::size_t rows = theta.size();
  for (const auto& [field, data] : pad.datasets())
    if (data.whole_shape() == shape && std::holds_alternative<std::vector<double>>(data.values) &&
        !field.starts_with("node_")) {
      wrapped.fields.push_back(shown(field, data, path));
      share = data.share;
      rows = data.shape.front();
    }

  std::vector<double> in_space, flat;
  const std::size_t first = share ? share->begin : 0;
  for (std::size_t i = first; i < first + rows; ++i)
    for (double s : z) {
      const double t = theta[i];
      in_space.insert(in_space.end(), {place.centre_x + place.radius * std::cos(t),
                                       place.centre_y + place.radius * std::sin(t), place.centre_z + s});
      flat.insert(flat.end(), {place.radius * t, s, 0.0});
    }
  const Shape triples = {rows, z.size(), 3};
  pad.put("node_xyz",
          {triples, std::move(in_space), "m", "position of the film's nodes in space [theta][z][x, y, z]", share});
  pad.put("node_flat", {triples, std::move(flat), "m",
                        "unwrapped: radius times theta, z from the bearing's middle, zero [theta][z][3]", share});

  StructuredGrid unrolled = wrapped;
  unrolled.name += unwrapped;
  unrolled.coordinates = path + "/node_flat";
  return {std::move(wrapped), std::move(unrolled)};
}

StructuredGrid cell_grid(Group& body, const std::string& path, const std::string& name, const std::string& corners,
                         const Shape& cells, const std::function<std::array<double, 3>(const Shape&)>& position) {
  core::require(cells.size() == 2 || cells.size() == 3, "a body has cells of two or three extents");
  StructuredGrid out{name, cells, path + "/" + corners, {}, true};
  for (std::size_t& n : out.nodes) ++n;
  std::optional<RowRange> share;
  std::size_t end = cells.front();
  for (const auto& [field, data] : body.datasets())
    if (data.whole_shape() == cells && std::holds_alternative<std::vector<double>>(data.values)) {
      out.fields.push_back(shown(field, data, path));
      share = data.share;
      end = share ? share->begin + data.shape.front() : cells.front();
    }
  // Corners before the cells here; who has the last cells has those behind them, too.
  const std::size_t begin = share ? share->begin : 0;
  if (end == cells.front() && (begin < end || !share)) ++end;
  if (share) share = RowRange{begin, cells.front() + 1};
  Shape rows = out.nodes;
  rows.front() = end - begin;
  std::vector<double> places;
  Shape at(cells.size(), 0);
  for (at[0] = begin; at[0] < end; ++at[0])
    for (at[1] = 0; at[1] < out.nodes[1]; ++at[1]) {
      const std::size_t layers = cells.size() == 3 ? out.nodes[2] : 1;
      for (std::size_t k = 0; k < layers; ++k) {
        if (cells.size() == 3) at[2] = k;
        const std::array<double, 3> p = position(at);
        places.insert(places.end(), p.begin(), p.end());
      }
    }
  rows.push_back(3);
  body.put(corners, {rows, std::move(places), "m", "corners of the cells in space, x, y, z last", share});
  return out;
}

}  // namespace whirl::io
