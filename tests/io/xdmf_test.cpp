#include "whirl/io/xdmf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>

#include "io/temporary.hpp"

using namespace whirl;
using namespace whirl::io;

namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Every element is closed in order, every attribute is quoted, no bare < or & is left.
void expect_well_formed(const std::string& xml) {
  static const std::regex tag(R"re(<\?[^?]*\?>|<(/?)([A-Za-z0-9_]+)((?: [A-Za-z]+="[^"<]*")*)(/?)>)re");
  std::vector<std::string> open;
  std::size_t at = 0;
  for (std::sregex_iterator i(xml.begin(), xml.end(), tag), end; i != end; ++i) {
    const std::string between = xml.substr(at, static_cast<std::size_t>(i->position()) - at);
    EXPECT_EQ(between.find_first_of("<>"), std::string::npos) << between;
    at = static_cast<std::size_t>(i->position() + i->length());
    const std::string name = (*i)[2];
    if (name.empty() || (*i)[4] == "/") continue;
    if ((*i)[1] == "/") {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(open.back(), name);
      open.pop_back();
    } else {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(std::regex_replace(xml, std::regex("&(amp|lt|gt|quot);"), "").find('&'), std::string::npos);
}

Group pad() {
  Group p;
  p.put("theta", {-2.0, -1.5, -1.0}, "rad", "");
  p.put("z", {-0.01, 0.01}, "m", "");
  p.put("pressure", {3, 2}, {0, 0, 1, 2, 0, 0}, "Pa", "");
  p.put("thickness", {3, 2}, std::vector<double>(6, 1e-4), "m", "");
  p.put("count", std::vector<std::int64_t>{1}, "");
  return p;
}

}  // namespace

TEST(Xdmf, AFilmHasAWrappedAndAnUnwrappedGrid) {
  Group p = pad();
  const auto grids = film_grids(p, "/studies/s/films/B1/pad1", "B1 pad 1", {0.09, 0.001, -0.002, 3.5});
  ASSERT_EQ(grids.size(), 2u);
  EXPECT_EQ(grids[0].nodes, (Shape{3, 2}));
  ASSERT_EQ(grids[0].fields.size(), 2u);
  EXPECT_EQ(grids[0].fields[0].name, "pressure [Pa]");
  EXPECT_EQ(grids[0].fields[0].dataset, "/studies/s/films/B1/pad1/pressure");
  // Node (i, j) at 3 (2 i + j).
  EXPECT_EQ(p.dataset("node_xyz").shape, (Shape{3, 2, 3}));
  EXPECT_DOUBLE_EQ(p.reals("node_xyz")[6], 0.001 + 0.09 * std::cos(-1.5));
  EXPECT_DOUBLE_EQ(p.reals("node_xyz")[16], -0.002 + 0.09 * std::sin(-1.0));
  EXPECT_DOUBLE_EQ(p.reals("node_xyz")[2], 3.49);
  EXPECT_DOUBLE_EQ(p.reals("node_flat")[6], 0.09 * -1.5);
  EXPECT_DOUBLE_EQ(p.reals("node_flat")[7], -0.01);
  EXPECT_EQ(film_grids(p, "/p", "again", {})[0].fields.size(), 2u);  // coordinates are no fields
}

// Of a pad that ranks share, each makes the coordinates of its rows.
TEST(Xdmf, CoordinatesAreSharedLikeFields) {
  Group whole = pad(), part;
  part.put("theta", whole.dataset("theta"));
  part.put("z", whole.dataset("z"));
  part.put("pressure", {{2, 2}, std::vector<double>(4, 1.0), "Pa", "rows 1 and 2 of three", RowRange{1, 3}});
  const auto grids = film_grids(part, "/p", "pad", {0.09, 0, 0, 0});
  (void)film_grids(whole, "/p", "pad", {0.09, 0, 0, 0});
  EXPECT_EQ(grids[0].nodes, (Shape{3, 2})) << "the file has all";
  ASSERT_EQ(grids[0].fields.size(), 1u);
  for (const char* name : {"node_xyz", "node_flat"}) {
    const Dataset& rows = part.dataset(name);
    EXPECT_EQ(rows.share, (RowRange{1, 3}));
    const auto& all = whole.reals(name);
    EXPECT_EQ(std::get<std::vector<double>>(rows.values), std::vector(all.begin() + 6, all.end()));
  }
}

TEST(Xdmf, IsWellFormedAndNamesOnlyDatasetsThatExist) {
  const test::Temporary folder;
  Group p = pad();
  auto grids = film_grids(p, "/films/B1", "B1 <\"1 & 2\">", {0.09, 0, 0, 0});
  grids.push_back({"solid", {2, 3, 4}, "/xyz", {{"temperature", "/t"}}});
  write_xdmf(folder / "films.xdmf", "results.h5", grids);
  const std::string xml = content(folder / "films.xdmf");
  expect_well_formed(xml);
  EXPECT_NE(xml.find("3DSMesh\" Dimensions=\"2 3 4\""), std::string::npos);
  static const std::regex reference("results.h5:/films/B1/([a-z_]+)<");
  int n = 0;
  for (std::sregex_iterator i(xml.begin(), xml.end(), reference), end; i != end; ++i, ++n) {
    EXPECT_TRUE(p.has_dataset((*i)[1])) << (*i)[1];
    const bool place = (*i)[1].str().starts_with("node_");
    EXPECT_EQ(p.dataset((*i)[1]).shape, place ? (Shape{3, 2, 3}) : (Shape{3, 2}));
  }
  EXPECT_EQ(n, 2 * (1 + 2));
  // Coordinates apart (X_Y_Z) open in one of ParaView's three readers only; the extents of each item are its dataset's.
  EXPECT_EQ(xml.find("X_Y_Z"), std::string::npos);
  EXPECT_NE(xml.find("Dimensions=\"3 2 3\""), std::string::npos);
  EXPECT_NE(xml.find("Dimensions=\"2 3 4 3\""), std::string::npos);
}

// A quarter of a ring, two rows, three columns, one layer.
StructuredGrid quarter(Group& body) {
  return cell_grid(body, "/bush", "bush", "corners", {2, 3, 1}, [](const Shape& at) {
    const double theta = static_cast<double>(at[1]) * 0.5, r = 1 + static_cast<double>(at[2]);
    return std::array<double, 3>{r * std::cos(theta), r * std::sin(theta), static_cast<double>(at[0]) * 0.25};
  });
}

TEST(Xdmf, CellsHaveCornersOneMoreInEachExtent) {
  const test::Temporary folder;
  Group body;
  body.put("temperature", {2, 3, 1}, {1, 2, 3, 4, 5, 6}, "K", "");
  body.put("wall", {2, 3}, std::vector<double>(6, 0.0), "K", "not of the cells");
  const StructuredGrid grid = quarter(body);
  EXPECT_EQ(grid.nodes, (Shape{3, 4, 2}));
  ASSERT_EQ(grid.fields.size(), 1u);
  EXPECT_EQ(grid.fields[0].name, "temperature [K]");
  const Dataset& corners = body.dataset("corners");
  EXPECT_EQ(corners.shape, (Shape{3, 4, 2, 3}));
  const auto& p = body.reals("corners");
  const std::size_t last = 3 * ((2 * 4 + 3) * 2 + 1);
  EXPECT_NEAR(p[last], 2 * std::cos(1.5), 1e-15);
  EXPECT_NEAR(p[last + 2], 0.5, 1e-15);
  write_xdmf(folder / "bush.xdmf", "results.h5", {grid});
  const std::string xml = content(folder / "bush.xdmf");
  expect_well_formed(xml);
  EXPECT_NE(xml.find("3DSMesh\" Dimensions=\"3 4 2\""), std::string::npos);
  EXPECT_NE(xml.find("Dimensions=\"3 4 2 3\""), std::string::npos);
  EXPECT_NE(xml.find("Center=\"Cell\">\n     <DataItem Dimensions=\"2 3 1\""), std::string::npos);
}

// Each of three ranks writes the corners before its cells, the one with the last cells those behind them, too.
TEST(Xdmf, CornersAreSharedLikeCells) {
  Group whole;
  whole.put("temperature", {2, 3, 1}, std::vector<double>(6, 1.0), "K", "");
  (void)quarter(whole);
  std::vector<double> joined;
  for (const RowRange& rows : {RowRange{0, 2}, RowRange{1, 2}, RowRange{2, 2}}) {
    const std::size_t n = rows.begin < 2 ? 1 : 0;
    Group part;
    part.put("temperature", {{n, 3, 1}, std::vector<double>(3 * n, 1.0), "K", "", rows});
    EXPECT_EQ(quarter(part).nodes, (Shape{3, 4, 2}));
    const Dataset& here = part.dataset("corners");
    EXPECT_EQ(here.share, (RowRange{rows.begin, 3}));
    EXPECT_EQ(here.shape.front(), std::vector<std::size_t>({1, 2, 0})[rows.begin]);
    const auto& values = std::get<std::vector<double>>(here.values);
    joined.insert(joined.end(), values.begin(), values.end());
  }
  EXPECT_EQ(joined, whole.reals("corners"));
}

// A section of a body of revolution: cells in a plane.
TEST(Xdmf, ASectionHasTwoExtents) {
  Group body;
  body.put("temperature", {3, 2}, std::vector<double>(6, 1.0), "K", "");
  const StructuredGrid grid = cell_grid(body, "/journal", "journal", "corners", {3, 2}, [](const Shape& at) {
    return std::array<double, 3>{static_cast<double>(at[1]), 0, static_cast<double>(at[0])};
  });
  EXPECT_EQ(grid.nodes, (Shape{4, 3}));
  EXPECT_EQ(body.dataset("corners").shape, (Shape{4, 3, 3}));
  EXPECT_EQ(body.reals("corners").back(), 3);
}
