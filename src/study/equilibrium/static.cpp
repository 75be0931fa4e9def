#include "study/equilibrium/static.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/bars/open_bore.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/enforced_motion.hpp"
#include "study/bearing/film_at_rest.hpp"
#include "study/brief.hpp"
#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/pieces.hpp"
#include "study/sense.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

// A field of a pad. Where ranks share a machine, each keeps and writes as many rows, those around the pad.
io::Dataset dataset_of(film::NodalField field, MPI_Comm sharing) {
  io::Dataset data{field.shape, std::move(field.values), field.unit, field.name + " at the nodes of the film mesh"};
  if (sharing == MPI_COMM_NULL || data.shape.size() < 2) return data;
  const auto rank = static_cast<std::size_t>(core::rank_of(sharing)),
             size = static_cast<std::size_t>(core::size_of(sharing));
  const std::size_t total = data.shape.front(), begin = total * rank / size, end = total * (rank + 1) / size;
  const auto& all = std::get<std::vector<double>>(data.values);
  const auto place = [&, row = all.size() / total](std::size_t k) {
    return all.begin() + static_cast<std::ptrdiff_t>(row * k);
  };
  data.values = std::vector(place(begin), place(end));
  data.shape.front() = end - begin;
  data.share = {begin, total};
  return data;
}

// Pressure and thickness of every pad, and where ParaView finds them. Films with states are `shared` like these.
void put_films(Context& context, system::RotorSystem& system, const std::vector<double>& x,
               const std::vector<double>& z, bool shared) {
  auto& group = context.results.group();
  const auto names = names_of_bearings(context.machine);
  for (int b = 0; b < system.n_bearings(); ++b) {
    const auto k = static_cast<std::size_t>(b);
    const auto& support = system.train().supports[k];
    std::vector<film::NodalField> fields;
    core::agree(context.comm, [&] { fields = system.film_fields(b, x.data()); });
    if (fields.empty()) continue;
    const MPI_Comm sharing = shared && system.own_states(b) > 0 ? context.comm : MPI_COMM_NULL;
    auto& pads = group.child("films").child(io::safe_name(names[k]));
    for (film::NodalField& f : fields) {
      const std::string name = f.name;
      pads.child(fmt::format("pad{}", f.pad + 1)).put(name, dataset_of(std::move(f), sharing));
    }
    io::FilmPlace place;
    place.radius = support.geometry.radius;
    place.centre_y = support.elevation;
    place.centre_z = z[static_cast<std::size_t>(support.node - 1)];
    for (const auto& [name, of] : pads.groups()) {
      auto& pad = pads.child(name);
      if (sharing == MPI_COMM_NULL && of.has_dataset("z")) pad.label_each({io::labels_of(of.reals("z"))});
      for (auto& g : io::film_grids(pad, "films/" + io::safe_name(names[k]) + "/" + name, names[k] + " " + name, place))
        context.results.show(std::move(g));
    }
  }
}

// What follows from the films at the state x.
void put_values(const Context& context, system::RotorSystem& system, Vec at, io::StudySummary& summary) {
  const std::vector<double> x = system.gather(at);
  const auto journals = system.journals(x.data());
  const auto films = system.film_responses(x.data(), film::Need::force);
  const auto names = names_of_bearings(context.machine);
  const std::vector<double> thickness = system.observe(at).film_thickness;
  // A film with own states has coefficients that depend on the frequency: those of the shaft's rotation.
  const std::vector<film::PortCoefficients> coefficients = film_coefficients(system, x, system.speed());
  const std::vector<film::FilmReport> reports = system.film_summaries(x.data());
  double total_loss = 0;
  const char* const axis[] = {"x", "y"};
  for (std::size_t b = 0; b < names.size(); ++b) {
    const auto& support = system.train().supports[b];
    const std::string head = "bearing." + names[b] + ".";
    summary.set("load." + names[b], films[b].force[1], "N");
    for (std::size_t d = 0; d < 2; ++d) summary.set(head + "force." + axis[d], films[b].force[d], "N");
    for (std::size_t d = 0; d < 2; ++d) summary.set(head + axis[d], journals[b].position[d], "m");
    if (support.geometry.clearance > 0) {
      for (std::size_t d = 0; d < 2; ++d)
        summary.set(head + "eccentricity." + axis[d], journals[b].position[d] / support.geometry.clearance, "1");
      const film::FilmReport& report = reports[b];
      // Between the nodes of a mesh, too.
      const double thinnest = std::min(report.min_thickness, thickness[b]);
      summary.set(head + "min_thickness", thinnest, "m");
      summary.set(head + "min_thickness_ratio", thinnest / support.geometry.clearance, "1");
      summary.set(head + "minimum_film", support.minimum_film, "m");
      summary.set(head + "max_pressure", report.max_pressure, "Pa");
      if (std::isfinite(report.max_temperature)) {
        summary.set(head + "max_temperature", report.max_temperature, "K");
        summary.set(head + "mean_temperature", report.mean_temperature, "K");
      }
      put_film_numbers(summary, head, support, report, std::hypot(films[b].force[0], films[b].force[1]),
                       system.speed());
      summary.set(head + "side_flow", report.side_flow, "m^3/s");
      // Only pads with a start know it; a film that reforms freely has no inlet.
      if (std::isfinite(report.inlet_flow)) summary.set(head + "inlet_flow", report.inlet_flow, "m^3/s");
      for (std::size_t k = 0; k < report.hole_flows.size(); ++k)
        summary.set(fmt::format("{}hole.{}.flow", head, k + 1), report.hole_flows[k], "m^3/s");
      if (std::isfinite(report.mass_flow)) {
        // Normal volumes are those at 0 degC and 101325 Pa.
        constexpr double normal_air = 1.2929;  // kg/m^3
        summary.set(head + "mass_flow", report.mass_flow, "kg/s");
        summary.set(head + "normal_flow", report.mass_flow / normal_air * 60e3, "l/min");
        summary.set(head + "drag_torque", report.drag_torque, "N m");
      }
      summary.set(head + "power_loss", report.power_loss, "W");
      total_loss += report.power_loss;
    }
    put_matrices(summary, head, coefficients[b]);
    for (std::size_t d = 0; d < 2 && coefficients[b].ports > 2; ++d) {
      summary.set(head + "moment." + axis[d], films[b].force[2 + d], "N m");
      summary.set(head + "tilt." + axis[d], journals[b].tilt[d], "1");
    }
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt p = system.pedestal(static_cast<int>(b), static_cast<int>(d));
      if (p >= 0) summary.set("pedestal." + names[b] + "." + axis[d], x[static_cast<std::size_t>(2 * p)], "m");
    }
  }
  const auto elements = system.elements(x.data());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const std::string head = "element." + system.train().elements[e].name + ".";
    for (std::size_t d = 0; d < 2; ++d) {
      summary.set(head + "force." + axis[d], elements[e].force[d], "N");
      summary.set(head + axis[d], elements[e].motion[d], "m");
      if (elements[e].freedoms > 2) summary.set(head + "moment." + axis[d], elements[e].force[2 + d], "N m");
    }
  }
  summary.set("power_loss", total_loss, "W");
}

// The same on other film meshes, for the error bars.
void put_bars(const Context& context, const Layout& layout, const system::RotorSystem& system, double speed,
              const std::vector<double>& x) {
  SummaryBars bars(context.results.summary(), law_of(context.machine, context.layout));
  Pieces pieces(context.results, context.resume);
  bars.add(layout, pieces, film_meshes(context.machine, context.layout), [&](const FilmMesh& mesh, auto& there) {
    system::RotorSystem other(system.comm(), with_film_mesh(system::train_of(context.machine), mesh.factor), speed);
    const core::Vector at = resampled(other, system, x);
    other.set_forcing(false);
    if (solve::find_equilibrium(other, at.get(), {}).converged) put_values(context, other, at.get(), there);
  });
  bars.write(1e-9);
}

// Throws core::NotConverged with what the film carries, of a rotor whose whole weight is on one.
[[noreturn]] void tell_capacity(const Context& context, const system::Train& train, const deck::Quantity& speed,
                                const core::NotConverged& error) {
  const rotor::Options& r = train.rotor;
  const double load = system::load_of_rigid(train);
  const bool downwards = train.gravity_x == 0 && train.loads.empty();
  if (!downwards || r.type != rotor::Options::Type::rigid || train.supports.size() != 1 || !(load > 0)) throw error;
  Capacity most;
  core::agree(context.comm, [&] {
    if (!has_answer([&] { most = FilmAtRest(train.supports.front(), speed.value).capacity({0, -load}); })) most = {};
  });
  if (!(most.load > 0)) throw error;
  throw core::NotConverged(fmt::format("no equilibrium under {:.6g} N at {:.6g} {}: {}. {}", load,
                                       deck::from_si(speed.value, speed.unit), speed.unit, error.what(),
                                       in_words(most)));
}

// e/c of its parts, with the bar that theirs leave it.
io::Quantity eccentricity_of(const io::Quantity& x, const io::Quantity& y) {
  io::Quantity e{std::hypot(x.value, y.value), "1"};
  const double bar = (std::abs(x.value) * x.bar() + std::abs(y.value) * y.bar()) / e.value;
  if (bar > 0) e.more["uncertainty"] = bar;
  return e;
}

// "thinnest film 36.90 +- 0.16 um in B1, largest load 213.4 kN on B3, power loss 241 kW".
std::string extremes(const Values& v) {
  std::string words;
  const auto say = [&](const char* what, const io::Quantity& q, const std::string& where) {
    if (std::isfinite(q.value))
      words += fmt::format("{}{} {}{}", words.empty() ? "" : ", ", what, io::reading(q), where);
  };
  const std::vector<std::string> films = v.between("bearing.", ".min_thickness"), loads = v.between("load.", "");
  const auto film =
      std::ranges::min_element(films, {}, [&](const auto& b) { return v["bearing." + b + ".min_thickness"].value; });
  const auto load = std::ranges::max_element(loads, {}, [&](const auto& b) { return v["load." + b].value; });
  if (film != films.end()) say("thinnest film", v["bearing." + *film + ".min_thickness"], " in " + *film);
  if (load != loads.end() && v["load." + *load].value > 0) say("largest load", v["load." + *load], " on " + *load);
  if (const auto loss = v.get("power_loss"); loss && *loss > 0) say("power loss", v["power_loss"], "");
  return words;
}

}  // namespace

StudyResult Static::run(Context& context) {
  const Layout layout = plan(context, Sharing::meshes);
  system::RotorSystem system(layout.space, system::train_of(context.machine), options.speed.value);
  Walker walker(system);
  Vec at = nullptr;
  try {
    at = walker.at(options.speed.value);
  } catch (const core::NotConverged& error) {
    tell_capacity(context, system.train(), options.speed, error);
  }
  const std::vector<double> x = system.gather(at);
  const auto journals = system.journals(x.data());
  OpenBores bores(context.machine);
  for (std::size_t b = 0; b < journals.size(); ++b)
    bores.see(b, journals[b].position[0], journals[b].position[1], options.speed.value);
  const auto films = system.film_responses(x.data(), film::Need::force);
  const auto names = names_of_bearings(context.machine);
  auto& summary = context.results.summary();
  auto& group = context.results.group();

  const std::string where =
      fmt::format("at {:.6g} {}", deck::from_si(options.speed.value, options.speed.unit), options.speed.unit);
  FilmLimit(system.places()).warn(system.observe(at).film_thickness, "at rest", summary);
  bores.warn(summary, "");
  put_values(context, system, at, summary);
  std::string reason;
  const std::optional<Growth> growth = growth_at(system, at, &reason);
  // Equilibria know of no loss factor.
  if (context.machine.rotor.loss_factor == 0) {
    group.set("unstable_count", growth ? growth->known_count() : -1);
    group.set("stability", growth ? growth->verdict() : "undetermined");
  }
  if (growth)
    warn_of(*growth, where, "The machine does not stay where these results show it", summary);
  else
    summary.warnings.push_back(fmt::format("{} it is not known whether the equilibrium is stable: {}", where, reason));
  // Of all that the summary holds so far: what follows has no mesh.
  put_bars(context, layout, system, options.speed.value, x);
  warn_of_lifted(summary);
  const auto& rotor = system.train().rotor;
  summary.set("mass.total", rotor::total_mass(rotor), "kg");
  for (std::size_t i = 0; i + 1 < context.machine.bearings.size(); ++i) {
    const auto &a = context.machine.bearings[i], &b = context.machine.bearings[i + 1];
    if (a.node >= b.node) continue;
    summary.set("mass." + a.name + "_" + b.name, rotor::mass_between(rotor, a.node, b.node), "kg");
    summary.set("slenderness." + a.name + "_" + b.name, rotor::slenderness(rotor, a.node, b.node), "1");
  }
  summary.set("length.total", rotor::node_positions(rotor).back(), "m");
  std::vector<double> px, py, load;
  for (std::size_t b = 0; b < names.size(); ++b) {
    for (std::size_t d = 0; d < 2 && film::facts(system.train().supports[b].film).tilts; ++d)
      summary.set(fmt::format("bearing.{}.slope.{}", names[b], d == 0 ? "x" : "y"), system.axis(static_cast<int>(b))[d],
                  "1");
    px.push_back(journals[b].position[0]);
    py.push_back(journals[b].position[1]);
    load.push_back(films[b].force[1]);
  }

  const std::vector<double> shaft = system.shaft(x.data(), 0, true), z = rotor::node_positions(rotor);
  auto& nodes = group.child("nodes");
  nodes.put("z", z, "m", "axial position of the shaft's nodes");
  const auto put_freedom = [&](std::size_t freedom, const char* name, const char* unit, const char* description) {
    std::vector<double> along;
    for (std::size_t k = 0; k < z.size(); ++k) along.push_back(shaft[4 * k + freedom]);
    nodes.put(name, along, unit, description);
  };
  put_freedom(0, "x", "m", "horizontal position of the shaft");
  put_freedom(1, "y", "m", "vertical position of the shaft, positive up (sag line)");
  put_freedom(2, "slope_x", "1", "dx/dz of the shaft");
  put_freedom(3, "slope_y", "1", "dy/dz of the shaft");
  put_bearings(group, context.machine);
  auto& bearings = group.child("bearings");
  bearings.put("x", px, "m", "journal relative to the bearing centre");
  bearings.put("y", py, "m", "journal relative to the bearing centre");
  bearings.put("load", load, "N", "journal on bearing, positive down");
  std::vector<double> bz;
  for (const auto& s : system.train().supports) bz.push_back(z[static_cast<std::size_t>(s.node - 1)]);
  bearings.put("z", bz, "m", "axial position");
  group.set("speed", options.speed.value);
  if (options.fields) put_films(context, system, x, z, layout.shared);
  summary.points = 1;
  return context.results.finish("completed", true);
}

namespace {

constexpr const char* pairs[] = {"xx", "xy", "yx", "yy"};

// Of films that follow the slope of the shaft the coefficients beside those of forces and displacements.
std::vector<io::BriefTable> with_slopes(const Values& v) {
  struct Block {
    const char *caption, *row, *column, *unit, *rate;
  };
  constexpr Block blocks[] = {{"Forces by the slope of the journal", "", "slope_", "N", "N s"},
                              {"Moments by the displacement of the journal", "slope_", "", "N", "N s"},
                              {"Moments by the slope of the journal", "slope_", "slope_", "N m", "N m s"}};
  std::vector<io::BriefTable> out;
  for (const Block& block : blocks) {
    io::BriefTable table{block.caption,
                         {{"bearing"}},
                         {},
                         "x' = dx/dz and y' = dy/dz: slopes of the journal, and the moments that do work with them"};
    const char *of_row = *block.row ? "'" : "", *of_column = *block.column ? "'" : "";
    for (const char* letter : {"K", "C"})
      for (const char* pair : pairs)
        table.columns.push_back({fmt::format("{} {}{} {}{}", letter, pair[0], of_row, pair[1], of_column),
                                 *letter == 'K' ? block.unit : block.rate});
    for (const std::string& b : v.between("bearing.", ".K.x.slope_x")) {
      auto& row = table.rows.emplace_back();
      row.emplace_back(b);
      for (const char* letter : {"K", "C"})
        for (const char* pair : pairs)
          row.emplace_back(
              v[fmt::format("bearing.{}.{}.{}{}.{}{}", b, letter, block.row, pair[0], block.column, pair[1])]);
    }
    out.push_back(std::move(table));
  }
  return out;
}

}  // namespace

io::Brief Static::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::BriefTable places{
      fmt::format("Journals at rest at {}",
                  io::reading({deck::from_si(options.speed.value, options.speed.unit), options.speed.unit})),
      {{"bearing"},
       {"load", "N"},
       {"x", "m"},
       {"y", "m"},
       {"|e|/c", "1"},
       {"thinnest film", "m"},
       {"largest pressure", "Pa"},
       {"highest temperature", "degC"},
       {"side flow", "m^3/s"},
       {"flow", "kg/s"},
       {"normal flow", "l/min"},
       {"power loss", "W"}},
      {},
      "load of the journal on the bearing, positive down; place of the journal relative to the bearing centre"};
  io::BriefTable matrices{"Stiffness K and damping C of the films",
                          {{"bearing"}},
                          {},
                          "K = -dF/dx, C = -dF/d(dx/dt) of the force on the journal; where they depend on the "
                          "frequency, at that of the speed"};
  for (const char* letter : {"K", "C"})
    for (const char* pair : pairs)
      matrices.columns.push_back({std::string(letter) + " " + pair, *letter == 'K' ? "N/m" : "N s/m"});
  bool has_gas = false;
  for (const std::string& b : v.between("load.", "")) {
    const std::string head = "bearing." + b + ".";
    const io::Quantity x = v[head + "eccentricity.x"], y = v[head + "eccentricity.y"];
    const io::Quantity gas = v[head + "mass_flow"];
    const bool liquid = std::isnan(gas.value);  // gas has one temperature, and its volumes depend on the pressure
    has_gas = has_gas || !liquid;
    places.rows.push_back(
        {b, v["load." + b], v[head + "x"], v[head + "y"], eccentricity_of(x, y), v[head + "min_thickness"],
         v[head + "max_pressure"], liquid ? in_celsius(v[head + "max_temperature"]) : io::BriefCell(),
         liquid ? v[head + "side_flow"] : io::BriefCell(), gas, v[head + "normal_flow"], v[head + "power_loss"]});
    std::vector<io::BriefCell>& row = matrices.rows.emplace_back(1, b);
    for (const char* letter : {"K.", "C."})
      for (const char* pair : pairs) row.emplace_back(v[head + letter + pair]);
  }
  io::BriefTable elements{"Elements that carry static load",
                          {{"element"}, {"force x", "N"}, {"force y", "N"}, {"x", "m"}, {"y", "m"}},
                          {},
                          "force of the shaft on the element; motion of its node, relative to its other end"};
  if (!v.between("bearing.", ".eccentricity.x").empty()) places.note += "; c: assembled clearance";
  if (has_gas) places.note += "; pressure: absolute, in the film and behind orifices; normal: at 0 degC and 101325 Pa";
  double total = 0;
  for (const std::string& b : v.between("load.", "")) total += std::abs(v["load." + b].value);
  for (const std::string& e : v.between("element.", ".force.x")) {
    const std::string head = "element." + e + ".";
    constexpr double rounding = 1e-9;  // what carries no static load has forces of rounding
    if (std::hypot(v[head + "force.x"].value, v[head + "force.y"].value) <= rounding * total) continue;
    elements.rows.push_back({e, v[head + "force.x"], v[head + "force.y"], v[head + "x"], v[head + "y"]});
  }
  io::Brief brief{{extremes(v)}, {std::move(places), std::move(elements), std::move(matrices)}};
  for (io::BriefTable& t : with_slopes(v)) brief.tables.push_back(std::move(t));
  return brief;
}

}  // namespace whirl::study
