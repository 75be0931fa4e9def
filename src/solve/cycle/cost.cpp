#include "whirl/solve/cycle/cost.hpp"

#include <algorithm>

#include "whirl/core/cost.hpp"

namespace whirl::solve::cost {
namespace {

constexpr double iterations = 3, columns_of_sweeps = 50;

double cube(double n) {
  return n * n * n;
}

// A column through an interval: blocks of degree x degree by which films see their neighbours, down and up the band,
// and six inputs and forces of theirs. Blocks of less than 4 x 4 cost as much.
double film_column(const CycleCounts& c) {
  const double degree = std::max<double>(4, static_cast<double>(c.degree));
  return degree * degree * static_cast<double>(c.own) * static_cast<double>(2 * c.band + 12);
}

// The coordinates: a dense LU of half as many states as there are at all points, of which rows q' = v are eliminated.
double coordinate_column(const CycleCounts& c) {
  const auto n = static_cast<double>(c.states - c.own), m = static_cast<double>(c.degree);
  return m * n * n + m * m * n * n / 4 + m * m * n * static_cast<double>(c.forces);
}

}  // namespace

double dense_joining(const CycleCounts& c) {
  const auto n = static_cast<double>(c.states), intervals = static_cast<double>(c.intervals);
  // Without films the map of an interval is formed and multiplied to those before it.
  const double column = c.own > 0 ? coordinate_column(c) + core::cost::scattered * film_column(c)
                                  : n * n + static_cast<double>(2 * c.degree * c.forces) * n;
  return iterations * intervals * (n + static_cast<double>(c.borders)) * column + 70 * cube(n);
}

// Setting up GMRES and the search takes eight calls.
double sweeps(const CycleCounts& c) {
  return columns_of_sweeps * static_cast<double>(c.intervals) *
             (core::cost::streamed * coordinate_column(c) + core::cost::scattered * film_column(c)) +
         8 * core::cost::call;
}

// With f entries a row in the factors, f^2 to make them and 2 f a column, in complex numbers; modes fill registers,
// columns of a sweep go one by one. Columns of an iteration: forces, border, and two for each step of GMRES.
double time_modes(const CycleCounts& c) {
  const double rows = static_cast<double>(c.intervals) * static_cast<double>(c.degree * c.states),
               f = static_cast<double>(c.entries) / static_cast<double>(c.states),
               columns = static_cast<double>(c.forces + 2 * c.borders) + 8;
  return rows * (iterations * 4 * (f * f + 2 * f * columns) + columns_of_sweeps * core::cost::scattered * 8 * f) +
         8 * core::cost::call;
}

core::plan::CycleWay cheapest(const CycleCounts& c, bool films, bool linear) {
  return core::plan::cycle({dense_joining(c), sweeps(c), time_modes(c)}, films, linear);
}

}  // namespace whirl::solve::cost
