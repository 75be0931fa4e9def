#include "whirl/study/bearing/dynamic_coefficients.hpp"

#include <array>
#include <cmath>
#include <functional>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/held_film.hpp"
#include "study/common.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

// Of what a force or moment answers to what motion.
struct Entry {
  std::size_t i, j;
  std::string name, stiffness_unit, damping_unit;
};

std::vector<Entry> entries_of(std::size_t ports) {
  constexpr std::array<const char*, 4> names = {"x", "y", "tilt_x", "tilt_y"};
  constexpr std::array<const char*, 3> stiffness = {"N/m", "N", "N m"}, damping = {"N s/m", "N s", "N m s"};
  std::vector<Entry> out;
  for (std::size_t i = 0; i < ports; ++i)
    for (std::size_t j = 0; j < ports; ++j) {
      const std::size_t slopes = (i > 1 ? 1U : 0U) + (j > 1 ? 1U : 0U);
      out.push_back(
          {i, j, fmt::format("{}{}{}", names[i], slopes > 0 ? "_" : "", names[j]), stiffness[slopes], damping[slopes]});
    }
  return out;
}

struct Measured {
  FilmAtRest::Pair place{}, force{};
  double min_thickness = 0;
  std::vector<film::PortCoefficients> at;  // frequencies
};

// What one rank computes; all do it alike.
std::vector<Measured> measure(const DynamicCoefficientsOptions& o, const system::Support& support) {
  std::vector<Measured> out;
  for (const deck::Quantity& speed : o.speeds) {
    FilmAtRest film(support, speed.value);
    put_journal(film, o, support.geometry.clearance);
    Measured p{film.place(), film.force(), film.answer().min_thickness, {}};
    for (const double ratio : o.frequencies) p.at.push_back(film.coefficients(ratio * speed.value));
    out.push_back(std::move(p));
  }
  return out;
}

// All entries [speed][frequency][K, then B], for their bars.
std::vector<double> entries_in_order(const std::vector<Measured>& points) {
  std::vector<double> out;
  for (const Measured& p : points)
    for (const film::PortCoefficients& c : p.at)
      for (const auto* matrix : {&c.stiffness, &c.damping})
        for (std::size_t i = 0; i < c.ports; ++i)
          for (std::size_t j = 0; j < c.ports; ++j) out.push_back((*matrix)[i][j]);
  return out;
}

// Those of the first speed at the first frequency, and the place.
void put_first(io::StudySummary& summary, const std::vector<Measured>& points, double clearance) {
  const Measured& p = points.front();
  summary.set("x", p.place[0], "m");
  summary.set("y", p.place[1], "m");
  summary.set("eccentricity", std::hypot(p.place[0], p.place[1]) / clearance, "1");
  summary.set("load", std::hypot(p.force[0], p.force[1]), "N");
  summary.set("min_thickness", p.min_thickness, "m");
  const film::PortCoefficients& c = p.at.front();
  for (const Entry& e : entries_of(c.ports)) {
    summary.set("K." + e.name, c.stiffness[e.i][e.j], e.stiffness_unit);
    summary.set("B." + e.name, c.damping[e.i][e.j], e.damping_unit);
  }
}

void put_places(io::Group& group, const std::vector<Measured>& points, const std::vector<deck::Quantity>& speeds) {
  auto& table = group.child("places");
  const auto put = [&](const char* name, const char* unit, const char* text,
                       const std::function<double(std::size_t)>& value) {
    std::vector<double> column;
    for (std::size_t k = 0; k < points.size(); ++k) column.push_back(value(k));
    table.put(name, std::move(column), unit, text);
  };
  put("speed", "rad/s", "of the shaft", [&](std::size_t k) { return speeds[k].value; });
  put("x", "m", "of the journal, from the centre of the bearing", [&](std::size_t k) { return points[k].place[0]; });
  put("y", "m", "of the journal, from the centre of the bearing", [&](std::size_t k) { return points[k].place[1]; });
  put("force_x", "N", "of the film on the journal", [&](std::size_t k) { return points[k].force[0]; });
  put("force_y", "N", "of the film on the journal", [&](std::size_t k) { return points[k].force[1]; });
  put("min_thickness", "m", "least thickness of the film", [&](std::size_t k) { return points[k].min_thickness; });
}

// `bars` of entries_in_order(), or none.
void put_coefficients(io::Group& group, const std::vector<Measured>& points, const DynamicCoefficientsOptions& o,
                      const Bars* bars) {
  auto& table = group.child("coefficients");
  std::vector<double> speeds;
  for (const deck::Quantity& s : o.speeds) speeds.push_back(s.value);
  table.put("speed", speeds, "rad/s", "of the shaft, Omega");
  table.put("ratio", o.frequencies, "1", "frequency of the motion omega over Omega");
  const io::Shape shape{points.size(), o.frequencies.size()};
  const std::size_t ports = points.front().at.front().ports, each = ports * ports;
  for (const Entry& e : entries_of(ports))
    for (const bool stiffness : {true, false}) {
      std::vector<double> values, errors;
      for (std::size_t s = 0; s < points.size(); ++s)
        for (std::size_t f = 0; f < o.frequencies.size(); ++f) {
          const film::PortCoefficients& c = points[s].at[f];
          values.push_back((stiffness ? c.stiffness : c.damping)[e.i][e.j]);
          const std::size_t at = ((s * o.frequencies.size() + f) * 2 + (stiffness ? 0 : 1)) * each + e.i * ports + e.j;
          if (bars) errors.push_back((*bars)[at].total());
        }
      const std::string name = (stiffness ? "k_" : "b_") + e.name, unit = stiffness ? e.stiffness_unit : e.damping_unit;
      table.put(name, shape, values, unit,
                std::string(stiffness ? "stiffness" : "damping") + " [speed][frequency], minus force by motion; x, y " +
                    "displacements, tilt_x = dx/dz, tilt_y = dy/dz slopes of the journal, and their moments");
      if (bars) table.put(name + "_uncertainty", shape, errors, unit, "estimated error from the film mesh");
    }
}

}  // namespace

StudyResult DynamicCoefficients::run(Context& context) {
  system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  if (options.tilt) train.supports[which].film = *film::tilting(train.supports[which].film);
  auto& results = context.results;
  auto& summary = results.summary();
  const double clearance = train.supports[which].geometry.clearance;
  std::vector<Measured> points;
  core::agree(context.comm, [&] { points = measure(options, train.supports[which]); });
  put_first(summary, points, clearance);

  Bars bars(entries_in_order(points), law_of(context.machine));
  SummaryBars of_summary(summary, law_of(context.machine));
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  for (const FilmMesh& mesh : meshes) {
    std::vector<double> numbers;
    io::StudySummary there;
    core::agree(context.comm, [&] {
      const bool answered = has_answer([&] {
        const system::Train other = with_film_mesh(train, mesh.factor);
        const std::vector<Measured> found = measure(options, other.supports[which]);
        numbers = entries_in_order(found);
        put_first(there, found, clearance);
      });
      if (!answered) numbers.clear();
    });
    bars.add(mesh.axis, mesh.spacing, numbers);
    of_summary.add(mesh.axis, mesh.spacing, there);
  }
  constexpr double location = 1e-9;  // of the load that is balanced
  of_summary.write(location);
  auto& group = results.group();
  group.set("bearing", context.machine.bearings[which].name);
  group.set("clearance", clearance);
  put_places(group, points, options.speeds);
  put_coefficients(group, points, options, meshes.empty() ? nullptr : &bars);
  summary.points = static_cast<long>(points.size() * options.frequencies.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
