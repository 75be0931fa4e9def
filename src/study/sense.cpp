#include "study/sense.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/bearing/gas_point.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {
namespace {

constexpr double warm = 313.15;  // K, 40 degC: at which oils are named

// Of the fluid in a film with these results: that of a gas where it is densest, that of an oil at its mean temperature.
struct FluidInFilm {
  double density, viscosity;
};
FluidInFilm fluid_of(const system::Support& s, const film::FilmReport& report) {
  if (const auto* gas = film::find<film::Gas>(s.film))
    return {report.max_pressure / (gas->gas_constant * gas->temperature), s.lubricant.viscosity};
  double viscosity = s.lubricant.viscosity;
  const auto* thd = film::find<film::Thd>(s.film);
  if (thd && thd->viscosity && std::isfinite(report.mean_temperature))
    viscosity = thermal::viscosity(thd->viscosity->law, report.mean_temperature).value;
  return {s.lubricant.density, viscosity};
}

bool is_laminar(const film::Options& film) {
  if (const auto* o = film::find<film::Reynolds>(film)) return o->turbulence == film::Turbulence::laminar;
  if (const auto* o = film::find<film::Thd>(film)) return o->turbulence == film::Turbulence::laminar;
  return true;
}

// What a kind of fluid or a material has; zero is a number that was not given.
struct Usual {
  const char* what;
  double least, most;
  const char* unit;
  double to_unit;
  const char* examples;
};
bool is_usual(double value, const Usual& usual) {
  return value >= usual.least && value <= usual.most;
}
void judge(double value, const Usual& usual, const std::string& name, std::vector<std::string>& lines) {
  if (value == 0 || is_usual(value, usual)) return;
  lines.push_back(fmt::format("{}: a {} of {:.4g} {} is unusual ({}): is its unit right?", name, usual.what,
                              value * usual.to_unit, usual.unit, usual.examples));
}

// ISO 3448: its thickest oil, VG 3200, has 2.9 Pa s at 40 degC.
constexpr Usual liquid_viscosity{"viscosity", 1e-4, 3,
                                 "mPa s",     1e3,  "water has 0.3 to 1.8 mPa s, oils 2 to 3000 mPa s"};
constexpr Usual liquid_density{"density", 500, 3000, "kg/m^3", 1, "oils have about 870 kg/m^3, water 1000"};
// From plastics to tungsten carbide.
constexpr Usual modulus{"modulus", 1e9, 1e12, "GPa", 1e-9, "steel has about 206 GPa, aluminium 70 GPa"};
constexpr Usual shear_modulus{"shear modulus", 3e8, 5e11, "GPa", 1e-9, "steel has about 80 GPa, aluminium 26 GPa"};
constexpr Usual gas_density{"density", 0.05, 50, "kg/m^3", 1, "air has 1.2 kg/m^3 at 20 degC"};
constexpr Usual gas_viscosity{"viscosity", 5e-6, 1e-4, "mPa s", 1e3, "air has 0.018 mPa s at 20 degC"};

// Of the same without results: a gas as dense as at its ends, an oil as viscous as where it is coldest.
FluidInFilm thickest_fluid(const system::Support& s) {
  film::FilmReport report;
  if (const auto* gas = film::find<film::Gas>(s.film)) report.max_pressure = gas->ambient;
  if (const auto* thd = film::find<film::Thd>(s.film)) {
    report.mean_temperature = thd->feed;
    for (const film::HeatedWall* wall : {&thd->bush, &thd->journal})
      if (wall->type == film::HeatedWall::Type::isothermal)
        report.mean_temperature = std::min(report.mean_temperature, wall->temperature);
  }
  return fluid_of(s, report);
}

double reynolds_number(const system::Support& s, const FluidInFilm& fluid, double speed) {
  return fluid.density * std::abs(speed) * s.geometry.radius * s.geometry.clearance / fluid.viscosity;
}

double knudsen_number(const system::Support& s, const film::Gas& gas, double thickness) {
  return mean_free_path(gas, s.lubricant.viscosity, gas.ambient) / thickness;
}

std::string laminar_words(const film::Geometry& geometry, double speed) {
  return fmt::format(
      "Reynolds number at {:.6g} rad/s ({:.6g} rpm) of a film computed as laminar, but vortices or turbulence begin at "
      "{:.4g}: films of type reynolds and thd have 'turbulence'",
      speed, speed * 30 / std::numbers::pi, laminar_limit(geometry));
}

// Sentences, each on all the bearings of which it is true.
class Sentences {
public:
  void add(const std::string& bearing, double number, const std::string& end) {
    const auto known = std::ranges::find(all_, end, &Sentence::first);
    auto& bearings = known == all_.end() ? all_.emplace_back(end, std::vector<std::string>{}).second : known->second;
    bearings.push_back(fmt::format("{} ({:.4g})", bearing, number));
  }
  void put(io::StudySummary& summary) const {
    for (const auto& [end, bearings] : all_)
      summary.warnings.push_back(
          fmt::format("{} {}: {}", bearings.size() == 1 ? "bearing" : "bearings", fmt::join(bearings, ", "), end));
  }

private:
  using Sentence = std::pair<std::string, std::vector<std::string>>;
  std::vector<Sentence> all_;
};

}  // namespace

double laminar_limit(const film::Geometry& geometry) {
  return std::min(41.1 * std::sqrt(geometry.radius / geometry.clearance), 2000.0);
}

double slip_limit(const film::Gas& gas) {
  return gas.slip == film::Gas::Slip::none ? 0.01 : gas.slip == film::Gas::Slip::first ? 0.1 : 1;
}

std::vector<std::string> unusual_lubricants(const system::Machine& machine) {
  std::vector<std::string> lines;
  for (const system::Bearing& b : machine.bearings) {
    if (film::facts(b.film).coefficients) continue;
    const auto* name = std::get_if<std::string>(&b.lubricant);
    const auto* own = std::get_if<film::Lubricant>(&b.lubricant);
    if (!own && !machine.lubricants.contains(*name)) continue;
    const film::Lubricant& fluid = own ? *own : machine.lubricants.at(*name);
    const std::string place = own ? fmt::format("bearings.{}.lubricant", b.name) : "lubricants." + *name;
    std::vector<std::string> here;
    if (film::find<film::Gas>(b.film)) {
      judge(fluid.viscosity, gas_viscosity, place, here);
    } else {
      const auto* thd = film::find<film::Thd>(b.film);
      if (thd && thd->viscosity)
        judge(thermal::viscosity(thd->viscosity->law, warm).value, liquid_viscosity,
              fmt::format("bearings.{}.film.viscosity at 40 degC", b.name), here);
      else
        judge(fluid.viscosity, liquid_viscosity, place, here);
      judge(fluid.density, liquid_density, place, here);
      // Both of a gas: its units are right, and a study may put a film of gas in the place of this one.
      if (is_usual(fluid.viscosity, gas_viscosity) && is_usual(fluid.density, gas_density)) here.clear();
    }
    for (std::string& line : here)
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<std::string> unusual_material(const system::Machine& machine) {
  std::vector<std::string> lines;
  if (!system::is_rotor(machine) || machine.rotor.type == rotor::Options::Type::rigid) return lines;
  const rotor::Material& material = machine.rotor.material;
  for (const auto& [temperature, value] : material.modulus)
    if (lines.empty()) judge(value, modulus, "rotor.material", lines);
  judge(material.shear_modulus, shear_modulus, "rotor.material", lines);
  return lines;
}

std::vector<std::string> negative_damping(const system::Machine& machine) {
  std::vector<std::string> lines;
  const auto look = [&](const std::string& place, const std::array<double, 4>& constant, const auto& table) {
    // The constant part never acts without a row of the table.
    double least_x = table.empty() ? 0 : table.front().c_xx, least_y = table.empty() ? 0 : table.front().c_yy;
    for (const auto& row : table) {
      least_x = std::min(least_x, row.c_xx);
      least_y = std::min(least_y, row.c_yy);
    }
    least_x += constant[0], least_y += constant[3];
    std::vector<std::string> found;
    if (least_x < 0) found.push_back(fmt::format("C_xx = {:.4g} N s/m", least_x));
    if (least_y < 0) found.push_back(fmt::format("C_yy = {:.4g} N s/m", least_y));
    if (found.empty()) return;
    lines.push_back(fmt::format("{}: negative damping ({}) feeds the vibration: is its sign right?", place,
                                fmt::join(found, ", ")));
  };
  for (const system::Bearing& b : machine.bearings)
    if (const auto* film = film::find<film::Linear>(b.film)) look("bearings." + b.name, film->damping, film->table);
  for (const system::Element& e : machine.elements) look("elements." + e.name, e.damping, e.table);
  return lines;
}

std::vector<std::pair<std::string, io::Quantity>> lifted_journals(const io::StudySummary& summary) {
  constexpr std::string_view head = "load.";
  std::vector<std::pair<std::string, io::Quantity>> out;
  double sum = 0, most = 0;
  for (const auto& [name, q] : summary.values) {
    if (!name.starts_with(head) || !std::isfinite(q.value)) continue;
    sum += q.value;
    most = std::max(most, std::abs(q.value));
    if (q.value + std::max(q.bar(), 0.0) < 0) out.emplace_back(name.substr(head.size()), q);
  }
  // What is nothing beside the largest load is rounding.
  std::erase_if(out, [&](const auto& lifted) { return lifted.second.value > -1e-6 * most; });
  return sum > 0 ? out : std::vector<std::pair<std::string, io::Quantity>>{};
}

void warn_of_lifted(io::StudySummary& summary) {
  Sentences sentences;
  for (const auto& [bearing, load] : lifted_journals(summary))
    sentences.add(
        bearing, load.value,
        "load in N, which points upwards: the shaft lifts the journal into the upper half of its bearing. An overhung "
        "mass does that; where there is none, look at masses, nodes and 'elevation'");
  sentences.put(summary);
}

std::vector<std::string> lifted_by_weight(const system::Machine& machine) {
  const auto gravity = system::lateral(machine.gravity);
  if (!system::is_rotor(machine) || machine.rotor.type == rotor::Options::Type::rigid) return {};
  if (machine.bearings.size() != 2 || !machine.elements.empty() || !(gravity[1] < 0)) return {};
  const std::vector<double> z = rotor::node_positions(machine.rotor), masses = rotor::node_masses(machine.rotor);
  double weight = 0, moment = 0;  // downwards, about node 1
  const auto press = [&](double force, double at) {
    weight += force;
    moment += force * at;
  };
  for (std::size_t k = 0; k < z.size(); ++k) press(-gravity[1] * masses[k], z[k]);
  for (const rotor::Disc& d : machine.rotor.discs)
    moment -= gravity[1] * rotor::resolved(d, machine.rotor.material).mass * d.offset;
  for (const system::StaticLoad& l : machine.loads) {
    if (l.moment) return {};
    press(-l.force[1], z[static_cast<std::size_t>(l.node - 1)]);
  }
  const auto place = [&](std::size_t b) { return z[static_cast<std::size_t>(machine.bearings[b].node - 1)]; };
  const double span = place(1) - place(0);
  if (span == 0 || !(weight > 0)) return {};
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < 2; ++b) {
    const double load = (b == 0 ? 1 : -1) * (weight * place(1 - b) - moment) / span;
    if (load < -1e-6 * weight)
      lines.push_back(fmt::format(
          "bearing {}: its load is {:.4g} N by the weight of the shaft, {:.4g} N, and points upwards: the "
          "shaft lifts the journal. An overhung mass does that; where there is none, look at masses and nodes",
          machine.bearings[b].name, load, weight));
  }
  return lines;
}

void put_film_numbers(io::StudySummary& summary, const std::string& head, const system::Support& support,
                      const film::FilmReport& report, double load, double speed) {
  const film::Geometry& g = support.geometry;
  if (g.length > 0) summary.set(head + "specific_load", std::abs(load) / (2 * g.radius * g.length), "Pa");
  const double reynolds = reynolds_number(support, fluid_of(support, report), speed);
  if (reynolds > 0 && std::isfinite(reynolds)) summary.set(head + "reynolds_number", reynolds, "1");
  if (const auto* gas = film::find<film::Gas>(support.film))
    summary.set(head + "knudsen_number", knudsen_number(support, *gas, report.min_thickness), "1");
}

void warn_of_films(io::StudySummary& summary, const system::Train& train, const AskedFilms& asked) {
  const auto value = [&](const std::string& name) -> const io::Quantity* {
    const auto at = std::find_if(summary.values.begin(), summary.values.end(),
                                 [&](const auto& entry) { return entry.first == name; });
    return at == summary.values.end() ? nullptr : &at->second;
  };
  Sentences sentences;
  for (std::size_t b = 0; b < train.supports.size(); ++b) {
    const system::Support& s = train.supports[b];
    if (!(s.geometry.clearance > 0) || (!asked.bearing.empty() && s.name != asked.bearing)) continue;
    const std::string head = "bearing." + s.name + ".";
    const auto check = [&](const char* name, double limit, const std::string& end, double to_unit) {
      const io::Quantity* q = value(head + name);
      if (!q) return;
      const auto bar = q->more.find("uncertainty");
      if (q->value - (bar != q->more.end() && std::isfinite(bar->second) ? bar->second : 0) > limit)
        sentences.add(s.name, q->value * to_unit, end);
    };
    check("specific_load", white_metal_load,
          fmt::format("load over projected area in MPa; white metal bears {:g} MPa (ISO 7902-3)",
                      white_metal_load * 1e-6),
          1e-6);
    check("max_pressure", white_metal_pressure,
          fmt::format("largest film pressure in MPa; white metal yields at about {:g} MPa at 100 degC (ASTM B23)",
                      white_metal_pressure * 1e-6),
          1e-6);
    if (film::facts(s.film).coefficients) continue;
    if (is_laminar(s.film)) {
      const std::string end = laminar_words(s.geometry, asked.speed);
      const double least = reynolds_number(s, thickest_fluid(s), asked.speed);
      if (value(head + "reynolds_number"))
        check("reynolds_number", laminar_limit(s.geometry), end, 1);
      else if (least > laminar_limit(s.geometry))
        sentences.add(s.name, least, end);
    }
    if (const auto* gas = film::find<film::Gas>(s.film)) {
      const double limit = slip_limit(*gas);
      const auto words = [&](const char* where) {
        return fmt::format("Knudsen number {}; its law of slip holds up to {:g}: see 'slip'", where, limit);
      };
      constexpr const char* thinnest = "where the film is thinnest";
      const double known = b < asked.thinnest.size() ? asked.thinnest[b] : io::no_value;
      const double number = knudsen_number(s, *gas, std::isfinite(known) ? known : s.geometry.clearance);
      if (value(head + "knudsen_number"))
        check("knudsen_number", limit, words(thinnest), 1);
      else if (number > limit)
        sentences.add(s.name, number, words(std::isfinite(known) ? thinnest : "of a film as thick as the clearance"));
    }
  }
  sentences.put(summary);
}

void warn_of_reynolds(io::StudySummary& summary, const std::string& bearing, const film::Geometry& geometry,
                      double reynolds, double speed) {
  Sentences sentences;
  if (reynolds > laminar_limit(geometry)) sentences.add(bearing, reynolds, laminar_words(geometry, speed));
  sentences.put(summary);
}

}  // namespace whirl::study
