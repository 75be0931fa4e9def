#include "response_bars.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "film_mesh.hpp"
#include "findings.hpp"
#include "summary_bars.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr double apart = 5e-3, together = 4e-3;  // of the speed

// Of a single resonance g = 1/f^2 is a parabola over the speed, with g''/g = 2 (2 Q/s)^2 at its foot, however far apart
// the three speeds stand on its flanks.
struct Top {
  double speed, height, quality;
};

Top top_of(double centre, const std::array<double, 3>& f) {
  std::array<double, 3> g{};
  for (std::size_t i = 0; i < 3; ++i) g[i] = 1 / (f[i] * f[i]);
  const double h = apart * centre, slope = (g[2] - g[0]) / (2 * h), curvature = (g[0] - 2 * g[1] + g[2]) / (h * h),
               foot = g[1] - slope * slope / (2 * curvature);
  return {centre - slope / curvature, 1 / std::sqrt(foot), centre / 2 * std::sqrt(std::max(0.0, curvature / foot / 2))};
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
    for (std::size_t i = 0; i < 3; ++i) f[i] = r.height[3 * k + i][peak.node];
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

}  // namespace

void put_response_bars(const Context& context, const std::vector<NamedPeak>& peaks, const PutPeak& put,
                       const SolveOnMesh& solve) {
  const std::vector<FilmMesh> meshes = film_meshes(context.machine);
  if (meshes.empty()) return;
  const Tops tops(peaks);
  const std::vector<double> speeds = tops.speeds();
  const MeshResponse here = solve({1, 1}, speeds, "bars");
  SummaryBars bars(context.results.summary(), law_of(context.machine));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    io::StudySummary there;
    try {
      const MeshResponse moved = solve(meshes[i].factor, speeds, fmt::format("bars {}", i + 1));
      there = moved.operating;
      for (const NamedPeak& p : peaks) {
        const Top a = tops.of(p, here), b = tops.of(p, moved);
        put(there, p.head, p.speed + b.speed - a.speed, p.height + b.height - a.height,
            p.amplification * b.quality / a.quality);
      }
    } catch (const core::NotConverged&) {
      there = {};
    } catch (const core::DomainError&) {
      there = {};
    } catch (const core::InputError&) {  // grooves that leave nothing of a coarser mesh
      there = {};
    }
    bars.add(meshes[i].axis, meshes[i].spacing, there);
  }
  bars.write(peak_tolerance);
}

}  // namespace whirl::study
