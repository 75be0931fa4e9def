#include "study/bearing/coefficients_at.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/bearing/held_film.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::study {
namespace {

constexpr double beside = 1e-6;  // clearances

// The numbers of one matrix pair, and how many they are.
constexpr std::size_t of_pair = 1 + 2 * 16;
void put(std::vector<double>& out, const film::PortCoefficients& c) {
  out.push_back(static_cast<double>(c.ports));
  for (const auto* of : {&c.stiffness, &c.damping})
    for (const auto& row : *of) out.insert(out.end(), row.begin(), row.end());
}
film::PortCoefficients take(const double*& from) {
  film::PortCoefficients c;
  c.ports = static_cast<std::size_t>(*from++);
  for (auto* of : {&c.stiffness, &c.damping})
    for (auto& row : *of)
      for (double& value : row) value = *from++;
  return c;
}

void write(io::Group& g, const AtSpeed& a) {
  const film::JournalMotion& m = a.place.motion;
  std::vector<double> place(m.position.begin(), m.position.end());
  place.insert(place.end(), {a.place.force[0], a.place.force[1], a.thickness});
  g.put("place", std::move(place), "1", "x, y, slopes; force; least thickness; in SI units");
  g.put("states", a.place.states, "1", "of the film");
  std::vector<double> coefficients, enforced, centre;
  for (const film::PortCoefficients& c : a.coefficients) put(coefficients, c);
  std::vector<std::string> lost;
  for (const auto& frequency : a.enforced)
    for (const EnforcedAt& e : frequency) {
      put(enforced, e.coefficients);
      enforced.insert(enforced.end(), e.tail.begin(), e.tail.end());
      enforced.insert(enforced.end(), e.distortion.begin(), e.distortion.end());
      enforced.push_back(e.apart);
      lost.insert(lost.end(), e.lost.begin(), e.lost.end());
    }
  if (a.centre) put(centre, *a.centre);
  g.put("coefficients", std::move(coefficients), "1", "ports, stiffness, damping of each frequency");
  g.put("enforced", std::move(enforced), "1", "the same, tails, distortions and distance, [frequency][amplitude]");
  g.put("lost", std::move(lost), "why an enforced motion has no values");
  g.put("centre", std::move(centre), "1", "of the film at the centre");
  g.put("most", a.most ? std::vector<double>{a.most->load, a.most->eccentricity} : std::vector<double>{}, "1",
        "load that the film carries, eccentricity");
  g.set("amplitudes", a.enforced.empty() ? 0 : static_cast<int>(a.enforced.front().size()));
  g.set("reason", a.reason);
}

AtSpeed read(const io::Group& g, double speed) {
  AtSpeed a;
  const std::vector<double>& place = g.reals("place");
  a.place.motion.speed = speed;
  std::copy_n(place.begin(), 4, a.place.motion.position.begin());
  a.place.force = {place.at(4), place.at(5)};
  a.thickness = place.at(6);
  a.place.states = g.reals("states");
  const std::vector<double>&coefficients = g.reals("coefficients"), &enforced = g.reals("enforced"),
        &centre = g.reals("centre"), &most = g.reals("most");
  const double* from = coefficients.data();
  for (std::size_t k = 0; k < coefficients.size() / of_pair; ++k) a.coefficients.push_back(take(from));
  const std::vector<std::string>& lost = g.strings("lost");
  const auto amplitudes = static_cast<std::size_t>(g.integer("amplitudes"));
  from = enforced.data();
  for (std::size_t k = 0; 4 * k < lost.size(); ++k) {
    if (k % amplitudes == 0) a.enforced.emplace_back();
    EnforcedAt& e = a.enforced.back().emplace_back();
    e.coefficients = take(from);
    for (double& value : e.tail) value = *from++;
    for (double& value : e.distortion) value = *from++;
    e.apart = *from++;
    std::copy_n(lost.begin() + static_cast<std::ptrdiff_t>(4 * k), 4, e.lost.begin());
  }
  from = centre.data();
  if (!centre.empty()) a.centre = take(from);
  if (!most.empty()) a.most = Capacity{most[0], most.at(1), false};
  a.reason = g.text("reason");
  return a;
}

// Largest difference of two, of the largest entry of their kind.
double apart(const film::PortCoefficients& a, const film::PortCoefficients& b) {
  double out = 0;
  for (const auto of : {&film::PortCoefficients::stiffness, &film::PortCoefficients::damping}) {
    double most = 0, size = 0;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        most = std::max(most, std::abs((a.*of)[i][j] - (b.*of)[i][j]));
        size = std::max(size, std::abs((b.*of)[i][j]));
      }
    if (size > 0) out = std::max(out, most / size);
  }
  return out;
}

}  // namespace

void AtSpeed::fill(std::size_t ports, std::size_t frequencies, std::size_t amplitudes) {
  film::PortCoefficients none;
  none.ports = ports;
  for (auto* of : {&none.stiffness, &none.damping})
    for (auto& row : *of) row.fill(io::no_value);
  coefficients.assign(frequencies, none);
  EnforcedAt lost;
  lost.coefficients = none;
  lost.tail.fill(io::no_value);
  lost.distortion.fill(io::no_value);
  lost.lost.fill(reason);
  lost.apart = io::no_value;
  enforced.clear();
  if (amplitudes > 0) enforced.assign(frequencies, std::vector<EnforcedAt>(amplitudes, lost));
}

AtSpeed coefficients_at(film::Film& film, const DynamicCoefficientsOptions& options, const system::Support& support,
                        double speed, const JournalPlace* last) {
  const double c = support.geometry.clearance;
  film::JournalMotion motion;
  motion.speed = speed;
  const bool loaded = !options.load.values.empty();
  const double e = options.eccentricity.value_or(0.0), angle = options.attitude.value_or(0.0);
  const auto at = [&](double eccentricity) {
    motion.position = {eccentricity * c * std::cos(angle), eccentricity * c * std::sin(angle), 0, 0};
  };
  if (loaded) {
    FilmAtRest carrier(support, speed);
    // Where the film does not come to rest at the last place, the search begins by itself.
    if (last) (void)has_answer([&] { carrier.hold({last->motion.position[0], last->motion.position[1]}); });
    carrier.carry(load_along(options.load));
    motion = carrier.motion();
  } else {
    at(e);
  }
  AtSpeed now;
  now.place = rest_at(film, motion, last ? last->states : std::vector<double>());
  const auto first = [&](const JournalPlace& place) {
    return film::FrequencyCoefficients(film, place.motion, place.states).at(options.all_frequencies().front() * speed);
  };
  if (!loaded && e == 0) {
    at(beside);
    JournalPlace there;
    std::optional<film::PortCoefficients> near;
    if (has_answer([&] {
          there = rest_at(film, motion, now.place.states);
          near = first(there);
        })) {
      constexpr double same = 0.01;
      if (const film::PortCoefficients own = first(now.place); apart(own, *near) > same) {
        now.centre = own;
        now.place = std::move(there);
      }
    }
  }
  now.thickness = film.least_thickness(now.place.motion, now.place.states);
  film::FrequencyCoefficients by_frequency(film, now.place.motion, now.place.states);
  for (const double ratio : options.all_frequencies()) {
    const double omega = ratio * speed;
    now.coefficients.push_back(by_frequency.at(omega));
    if (!options.amplitudes.empty())
      now.enforced.push_back(
          enforced_at(film, support.geometry, now.place, omega, options.amplitudes, now.coefficients.back()));
  }
  return now;
}

std::string of_the_centre(const AtSpeed& at) {
  const film::PortCoefficients &c = *at.centre, &near = at.coefficients.front();
  return fmt::format(
      "at the centre the film is whole, beside it a part is ruptured: the coefficients are those of a small load, at "
      "an "
      "eccentricity of {:.0e}, with k_xy = {:.5g} N/m and damping xx = {:.5g} N s/m; at the centre itself these are "
      "{:.5g} and {:.5g}",
      beside, near.stiffness[0][1], near.damping[0][0], c.stiffness[0][1], c.damping[0][0]);
}

AtSpeed at_speed(MPI_Comm comm, Pieces& pieces, const std::string& name, double speed,
                 const std::function<AtSpeed()>& compute) {
  const io::Group& kept = pieces.get(name, [&](io::Group& g) {
    AtSpeed out;
    std::string reason;
    const auto none = agreed_place(comm, [&] {
      std::exception_ptr no_place;
      const bool answered = has_answer(
          [&] {
            try {
              out = compute();
            } catch (const NoPlace&) {
              no_place = std::current_exception();
              throw;
            }
          },
          &reason);
      if (no_place) std::rethrow_exception(no_place);
      if (!answered) out = {};
    });
    if (none) {
      out = {};
      reason = none->what();
      out.most = none->most;
    }
    out.reason = reason;
    if (!out.found()) out.place.motion.position.fill(io::no_value);
    write(g, out);
  });
  return read(kept, speed);
}

}  // namespace whirl::study
