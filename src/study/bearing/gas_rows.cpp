#include "study/bearing/gas_rows.hpp"

#include <exception>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/bearing/film_at_rest.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::study {

std::span<const GasQuantity> gas_quantities() {
  static const std::vector<GasQuantity> all{
      {"load", "N", "that the film carries", [](const GasPoint& p) { return p.load; }},
      {"attitude", "rad", "from the load to the journal, with the rotation",
       [](const GasPoint& p) { return p.attitude; }},
      {"min_thickness", "m", "of the film", [](const GasPoint& p) { return p.report.min_thickness; }},
      {"max_pressure", "Pa", "in the film and behind orifices",
       [](const GasPoint& p) { return p.report.max_pressure; }},
      {"mass_flow", "kg/s", "through all orifices", [](const GasPoint& p) { return p.report.mass_flow; }},
      {"normal_flow", "l/min", "the same as gas at 0 degC and 101325 Pa",
       [](const GasPoint& p) { return p.normal_flow; }},
      {"drag_torque", "N m", "of the film on the journal", [](const GasPoint& p) { return p.report.drag_torque; }},
      {"power_loss", "W", "drag times speed", [](const GasPoint& p) { return p.report.power_loss; }},
      {"knudsen", "1", "mean free path at the pressure of the ends over the least thickness",
       [](const GasPoint& p) { return p.knudsen; }},
      {"reynolds", "1", "rho Omega R c/mu, rho at the highest pressure", [](const GasPoint& p) { return p.reynolds; }},
      {"squeeze_reynolds", "1", "rho Omega c^2/mu", [](const GasPoint& p) { return p.squeeze_reynolds; }},
      {"taylor", "1", "rho Omega R c/mu sqrt(c/R); vortices above 41", [](const GasPoint& p) { return p.taylor; }},
      {"factorisations", "1", "of Newton's method from the film between parallel plates",
       [](const GasPoint& p) { return static_cast<double>(p.factorisations); }}};
  return all;
}

namespace {

void write(io::Group& g, const GasRow& row) {
  g.put("place", {row.eccentricity, row.place[0], row.place[1]}, "1", "eccentricity in clearances; x, y in m");
  g.put("values", row.values, "1", "of the quantities in SI units");
  g.put("capacity", {row.capacity, row.at_capacity}, "1", "load in N, eccentricity");
  g.set("reason", row.reason);
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < row.fields.size(); ++k) {
    const film::NodalField& f = row.fields[k];
    texts.insert(texts.end(), {f.name, f.unit, std::to_string(f.pad)});
    g.put("field " + std::to_string(k), f.shape, f.values, f.unit, f.name);
  }
  g.put("fields", std::move(texts), "name, unit and pad of each field");
}

GasRow row_from(const io::Group& g, double speed) {
  GasRow row;
  row.speed = speed;
  const std::vector<double>&place = g.reals("place"), &capacity = g.reals("capacity");
  row.eccentricity = place.at(0);
  row.place = {place.at(1), place.at(2)};
  row.values = g.reals("values");
  row.capacity = capacity.at(0);
  row.at_capacity = capacity.at(1);
  row.reason = g.text("reason");
  const std::vector<std::string>& texts = g.strings("fields");
  for (std::size_t k = 0; 3 * k < texts.size(); ++k) {
    const std::string name = "field " + std::to_string(k);
    row.fields.push_back(
        {std::stoi(texts[3 * k + 2]), texts[3 * k], texts[3 * k + 1], g.dataset(name).shape, g.reals(name)});
  }
  return row;
}

}  // namespace

GasRow gas_row(MPI_Comm comm, Pieces& pieces, const std::string& name, double speed, bool fields,
               const std::function<GasPoint()>& compute) {
  const io::Group& kept = pieces.get(name, [&](io::Group& g) {
    GasRow row;
    const auto none = agreed_place(comm, [&] {
      GasPoint p;
      std::exception_ptr no_place;
      const bool answered = has_answer(
          [&] {
            try {
              p = compute();
            } catch (const NoPlace&) {
              no_place = std::current_exception();
              throw;
            }
          },
          &row.reason);
      if (no_place) std::rethrow_exception(no_place);
      if (!answered) return row.values.assign(gas_quantities().size(), io::no_value);
      row.eccentricity = p.eccentricity;
      row.place = p.place;
      for (const GasQuantity& q : gas_quantities()) row.values.push_back(q.of(p));
      if (fields) row.fields = std::move(p.fields);
    });
    if (none) {
      row = {};
      row.values.assign(gas_quantities().size(), io::no_value);
      row.reason = none->what();
      row.capacity = none->most.load;
      row.at_capacity = none->most.eccentricity;
    }
    write(g, row);
  });
  return row_from(kept, speed);
}

std::vector<std::string> reasons_of(const std::vector<GasRow>& rows) {
  std::vector<std::string> out;
  for (const GasRow& row : rows) out.push_back(row.reason);
  return out;
}

}  // namespace whirl::study
