#include "whirl/io/xdmf.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

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
    const auto item = [&](const std::string& dataset) {
      return fmt::format(
          "<DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">{}:{}</DataItem>", extents,
          escaped(hdf5_name), escaped(dataset));
    };
    fmt::format_to(
        out,
        "   <Grid Name=\"{}\" GridType=\"Uniform\">\n    <Topology TopologyType=\"{}DSMesh\" Dimensions=\"{}\"/>\n",
        escaped(g.name), g.nodes.size(), extents);
    fmt::format_to(out, "    <Geometry GeometryType=\"X_Y_Z\">\n");
    for (const std::string& c : g.coordinates) fmt::format_to(out, "     {}\n", item(c));
    fmt::format_to(out, "    </Geometry>\n");
    for (const StructuredGrid::Field& f : g.fields)
      fmt::format_to(
          out, "    <Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Node\">\n     {}\n    </Attribute>\n",
          escaped(f.name), item(f.dataset));
    fmt::format_to(out, "   </Grid>\n");
  }
  xml += "  </Grid>\n </Domain>\n</Xdmf>\n";
  replace_file(path, xml);
}

std::vector<StructuredGrid> film_grids(Group& pad, const std::string& path, const std::string& name,
                                       const FilmPlace& place) {
  const std::vector<double> theta = pad.reals("theta"), z = pad.reals("z");
  const Shape shape = {theta.size(), z.size()};
  StructuredGrid wrapped{name, shape, {path + "/node_x", path + "/node_y", path + "/node_z"}, {}};
  for (const auto& [field, data] : pad.datasets())
    if (data.shape == shape && std::holds_alternative<std::vector<double>>(data.values) && !field.starts_with("node_"))
      wrapped.fields.push_back({data.unit.empty() ? field : field + " [" + data.unit + "]", path + "/" + field});

  std::vector<double> x, y, axial, arc, flat, zero;
  for (double t : theta)
    for (double s : z) {
      x.push_back(place.centre_x + place.radius * std::cos(t));
      y.push_back(place.centre_y + place.radius * std::sin(t));
      axial.push_back(place.centre_z + s);
      arc.push_back(place.radius * t);
      flat.push_back(s);
      zero.push_back(0);
    }
  pad.put("node_x", shape, std::move(x), "m", "position of the film's nodes in space, x");
  pad.put("node_y", shape, std::move(y), "m", "position of the film's nodes in space, y");
  pad.put("node_z", shape, std::move(axial), "m", "position of the film's nodes in space, z");
  pad.put("node_arc", shape, std::move(arc), "m", "unwrapped: radius times theta");
  pad.put("node_axial", shape, std::move(flat), "m", "unwrapped: z from the bearing's middle");
  pad.put("node_flat", shape, std::move(zero), "m", "unwrapped: the plane");

  StructuredGrid unwrapped = wrapped;
  unwrapped.name += " unwrapped";
  unwrapped.coordinates[0] = path + "/node_arc";
  unwrapped.coordinates[1] = path + "/node_axial";
  unwrapped.coordinates[2] = path + "/node_flat";
  return {std::move(wrapped), std::move(unwrapped)};
}

}  // namespace whirl::io
