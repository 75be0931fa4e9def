#include "study/bearing/gas_rows.hpp"

#include <utility>

#include "study/bearing/film_at_rest.hpp"

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

GasRow gas_row(MPI_Comm comm, Pieces& pieces, const std::string& name, double speed, bool fields,
               const std::function<GasPoint()>& compute) {
  GasRow row = pieces.value(name, [&] {
    GasRow out;
    const WithoutFilm none = agreed_film(comm, [&] {
      GasPoint p = compute();
      out.eccentricity = p.eccentricity;
      out.place = p.place;
      for (const GasQuantity& q : gas_quantities()) out.values.push_back(q.of(p));
      if (fields) out.fields = std::move(p.fields);
    });
    if (none.reason.empty()) return out;
    out = {};
    out.values.assign(gas_quantities().size(), io::no_value);
    out.reason = none.reason;
    if (none.most) {
      out.capacity = none.most->load;
      out.at_capacity = none.most->eccentricity;
    }
    return out;
  });
  row.speed = speed;
  return row;
}

std::vector<std::string> reasons_of(const std::vector<GasRow>& rows) {
  std::vector<std::string> out;
  for (const GasRow& row : rows) out.push_back(row.reason);
  return out;
}

}  // namespace whirl::study
