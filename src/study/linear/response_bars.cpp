#include "study/linear/response_bars.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/brief.hpp"
#include "study/linear/peak_list.hpp"
#include "study/linear/separation.hpp"

namespace whirl::study {
namespace {

constexpr double apart = 5e-3, together = 4e-3;  // of the speed

// Of a single resonance g = 1/f^2 is a parabola over the speed, with g''/g = 2 (2 Q/s)^2 at its foot, however far apart
// the three speeds stand on its flanks. No quality: no top, the curve bends upwards there.
struct Top {
  double speed, height, quality;
};

Top top_of(double centre, const std::array<double, 3>& f) {
  std::array<double, 3> g{};
  for (std::size_t i = 0; i < 3; ++i) g[i] = 1 / (f[i] * f[i]);
  const double h = apart * centre, slope = (g[2] - g[0]) / (2 * h), curvature = (g[0] - 2 * g[1] + g[2]) / (h * h),
               foot = g[1] - slope * slope / (2 * curvature);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const double place = centre - slope / curvature;
  if (!(curvature > 0)) return {place, infinite, 0};
  // Of a resonance that is far narrower than the three speeds stand apart nothing is left at the foot.
  if (!(foot > 0)) return {place, infinite, infinite};
  return {place, 1 / std::sqrt(foot), centre / 2 * std::sqrt(curvature / foot / 2)};
}

class Tops {
public:
  explicit Tops(const std::vector<NamedPeak>& peaks) {
    for (const NamedPeak& p : peaks)
      if (of(p.speed) == centres_.size()) centres_.push_back(p.speed);
  }
  [[nodiscard]] std::vector<double> speeds() const {
    std::vector<double> out;
    for (const double c : centres_) out.insert(out.end(), {c * (1 - apart), c, c * (1 + apart)});
    return out;
  }
  [[nodiscard]] Top of(const NamedPeak& peak, const MeshResponse& r) const {
    const std::size_t k = of(peak.speed);
    std::array<double, 3> f{};
    for (std::size_t i = 0; i < 3; ++i) f[i] = r.height[3 * k + i][peak.place];
    return top_of(centres_[k], f);
  }

private:
  [[nodiscard]] std::size_t of(double speed) const {
    const auto at =
        std::find_if(centres_.begin(), centres_.end(), [&](double c) { return std::abs(c - speed) < together * c; });
    return static_cast<std::size_t>(at - centres_.begin());
  }
  std::vector<double> centres_;
};

// What refining leaves of a value of one of the peaks; nothing of values at the operating speed. A margin is a
// difference of speeds over one of them; the required one moves with 1/(AF - 1.5).
double location_of(const std::vector<NamedPeak>& peaks, const std::string& name, double value) {
  const auto p = std::find_if(peaks.begin(), peaks.end(), [&](const NamedPeak& q) { return name.starts_with(q.head); });
  if (p == peaks.end()) return 0;
  if (name.ends_with("separation_margin")) return value == 0 ? 0 : p->errors.speed * (1 + value);
  if (name.ends_with("required_margin")) {
    const double af = p->amplification;
    return af < 2.5 || std::isinf(af) ? 0 : 0.17 * p->errors.factor * af / ((af - 1.5) * (af - 1.5));
  }
  return std::abs(value) * (name.ends_with("speed")                  ? p->errors.speed
                            : name.ends_with("amplification_factor") ? p->errors.factor
                            : name.ends_with(prominence)             ? height_tolerance * p->height / value
                                                                     : p->errors.height);
}

// Films in closed form have no mesh: what the refinement of the peaks leaves is all.
void put_locations(io::StudySummary& summary, const std::vector<NamedPeak>& peaks) {
  for (auto& [name, q] : summary.values)
    for (const NamedPeak& p : peaks)
      if (name.starts_with(p.head) && !name.ends_with(".node"))
        q.more["uncertainty"] = q.more["uncertainty_location"] = location_of(peaks, name, q.value);
}

}  // namespace

void put_response_bars(io::StudySummary& summary, const std::vector<FilmMesh>& meshes, const MeshLaw& law,
                       std::vector<NamedPeak>& peaks, const PutPeak& put, const SolveOnMesh& solve) {
  if (!law.estimated) return;
  if (meshes.empty()) return put_locations(summary, peaks);
  const Tops tops(peaks);
  std::vector<double> speeds = tops.speeds();
  for (const NamedPeak& p : peaks) speeds.insert(speeds.end(), p.saddles.begin(), p.saddles.end());
  SummaryBars bars(summary, law);
  // Without the response about the peaks on this mesh all bars are unknown; the response itself stays.
  MeshResponse here;
  const bool known = has_answer([&] { here = solve({}, speeds, "bars"); });
  if (!known) summary.warnings.emplace_back("the response beside its peaks could not be computed: no error bars");
  for (std::size_t i = 0; i < meshes.size(); ++i)
    bars.add(meshes[i].axis, meshes[i].spacing, [&](io::StudySummary& there) {
      if (!known) return;
      const MeshResponse moved = solve(meshes[i], speeds, fmt::format("bars {}", i + 1));
      there = moved.operating;
      std::size_t saddle = tops.speeds().size();
      for (NamedPeak& p : peaks) {
        const std::size_t first = std::exchange(saddle, saddle + p.saddles.size());
        const Top a = tops.of(p, here), b = tops.of(p, moved);
        if (!(b.quality > 0)) {
          p.vanishes = true;
          continue;
        }
        // A peak too narrow for a height is one on every mesh. Of another one nothing is known where the three speeds
        // do not see it on both meshes.
        double height = p.height, factor = p.amplification;
        if (std::isfinite(p.height)) {
          const bool told = std::isfinite(a.height) && std::isfinite(b.height);
          height = told ? p.height + b.height - a.height : io::no_value;
          factor = told ? p.amplification * b.quality / a.quality : io::no_value;
        }
        put(there, p.head, p.speed + b.speed - a.speed, height, factor);
        double lowest = 0;
        for (std::size_t k = first; k < saddle; ++k) lowest = std::max(lowest, moved.height[k][p.place]);
        if (saddle > first) there.set(p.head + prominence, height - lowest, "m");
      }
    });
  bars.write([&](const std::string& name, double value) { return location_of(peaks, name, value); });
}

void take_bars(const io::StudySummary& summary, const NamedPeak& peak, std::string doubt, io::PeakEntry& entry) {
  const Values values(summary);
  for (const PeakValue& v : peak_values())
    if (io::Quantity q = values[peak.head + v.name]; !q.unit.empty()) entry.*v.member = std::move(q);
  entry.verdict = margin_verdict(entry.amplification_factor, entry.separation_margin, entry.required_margin);
  if (doubt.empty() && peak.vanishes) doubt = "on another mesh the response has no peak there";
  const io::Quantity height = values[peak.head + prominence];
  const auto bar = height.more.find("uncertainty");
  if (doubt.empty() && bar != height.more.end() && !(height.value > bar->second))
    doubt = fmt::format("it stands {:.2g} um above the response beside it, with a bar of {}", 1e6 * height.value,
                        std::isfinite(bar->second) ? fmt::format("{:.2g} um", 1e6 * bar->second) : "unknown size");
  if (doubt.empty()) return;
  entry.notes.push_back("undetermined: " + doubt);
  entry.verdict = "undetermined";
}

void warn_of_shaft_mesh(io::StudySummary& summary, const rotor::Options& rotor, const std::vector<NamedPeak>& named,
                        const std::vector<int>& nodes, double operating_rounding) {
  // The error that the mesh of the shaft leaves in a value, relative to it; zero of one that is but rounding.
  const auto by_shaft = [&](const std::string& name, double rounding) {
    for (const auto& [of, q] : summary.values)
      if (const auto error = q.more.find("uncertainty_shaft_mesh"); of == name && error != q.more.end())
        return std::abs(q.value) > rounding ? error->second / std::abs(q.value) : 0;
    return 0.0;
  };
  double of_speeds = 0, of_heights = 0, of_operating = 0;
  for (const NamedPeak& p : named) {
    of_speeds = std::max(of_speeds, by_shaft(p.head + "speed", 0));
    of_heights = std::max(of_heights, by_shaft(p.head + "semi_major", 0));
  }
  for (const int node : nodes)
    of_operating =
        std::max(of_operating, by_shaft(fmt::format("operating.node.{}.semi_major", node), operating_rounding));
  warn_of_shaft_mesh(summary, rotor,
                     {{"the speeds of these peaks", of_speeds, most_of_frequency},
                      {"the heights of these peaks", of_heights, most_of_amplitude},
                      {"the amplitudes at operating speed", of_operating, most_of_amplitude}});
}

}  // namespace whirl::study
