#include "study/bars/error_bar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace whirl::study {
namespace {

constexpr double least_order = 0.5;
constexpr double least_doubt = 0.25;  // of the largest estimate: safety factor 1.25 (Roache 1994)
constexpr double single_factor = 3;   // two meshes alone (Roache 1994)
constexpr double kinks_factor = 3;    // of the largest estimate of first order: meshes that show no order (Roache 1994)
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Estimate {
  double error = 0, doubt = 0, largest = 0;
};

// Order that the two finest steps of halves or doubles show; theory if there are none, or they show more.
double order_of(double value, const std::vector<Sample>& samples, double theory) {
  const auto find = [&](double spacing) {
    for (const Sample& s : samples)
      if (std::abs(s.spacing - spacing) < 1e-9) return s.value;
    return nothing;
  };
  const double coarse = find(2) - value, fine = value - find(0.5);
  if (!(coarse * fine > 0)) return theory;
  return std::clamp(std::log2(coarse / fine), least_order, theory);
}

Estimate estimate(double value, std::vector<Sample> samples, double theory, bool kinks) {
  std::erase_if(samples, [](const Sample& s) { return !std::isfinite(s.value) || s.spacing == 1; });
  if (samples.empty()) return {nothing, nothing, nothing};
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.spacing < b.spacing; });
  const double order = kinks ? 1 : order_of(value, samples, theory);
  const auto error = [&](const Sample& s, double p) { return (value - s.value) / (1 - std::pow(s.spacing, p)); };
  Estimate out;
  // A finer mesh is believed with the order that is seen, a coarser one with that of theory: there the regular law has
  // begun least of all, and a low order seen would blow it up.
  out.error = error(samples.front(), samples.front().spacing < 1 ? order : theory);
  for (const Sample& s : samples) {
    const double e = error(s, s.spacing < 1 || kinks ? order : theory);
    out.doubt = std::max(out.doubt, std::abs(e - out.error));
    out.largest = std::max(out.largest, std::abs(e));
  }
  out.doubt = std::max(out.doubt, least_doubt * out.largest);
  if (samples.size() == 1) out.doubt = (single_factor - 1) * std::abs(out.error);
  return out;
}

}  // namespace

Bar error_bar(double value, const std::vector<Sample>& samples, const MeshLaw& law) {
  Bar bar;
  double error = 0, doubt = 0, with_kinks = 0;
  for (const Axis axis : all_axes) {
    std::vector<Sample> own;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(own),
                 [axis](const Sample& s) { return s.axis == axis; });
    if (own.empty()) continue;
    if (axis == Axis::time) {
      const Estimate e = estimate(value, own, law.time_order, false);
      bar.time_mesh = std::abs(e.error) + e.doubt;
      continue;
    }
    const Estimate e = estimate(value, own, law.film_order, false);
    error += std::abs(e.error);
    doubt += e.doubt;
    if (law.kinks) with_kinks += kinks_factor * estimate(value, own, law.film_order, true).largest;
  }
  bar.film_mesh = error + doubt;
  if (law.kinks) bar.kinks = std::max(0.0, with_kinks - bar.film_mesh);
  return bar;
}

std::map<std::string, double> Bar::parts(bool with_time) const {
  std::map<std::string, double> out{{"uncertainty_film_mesh", film_mesh}, {"uncertainty_location", location}};
  if (with_time) out["uncertainty_time_mesh"] = time_mesh;
  if (kinks > 0) out["uncertainty_kinks"] = kinks;
  return out;
}

void Bars::add(Axis axis, double spacing, const std::vector<double>& values) {
  samples_.resize(values_.size());
  for (std::size_t k = 0; k < values_.size(); ++k)
    samples_[k].push_back({axis, spacing, k < values.size() ? values[k] : nothing});
}

Bar Bars::operator[](std::size_t k) const {
  return error_bar(values_[k], samples_.empty() ? std::vector<Sample>{} : samples_[k], law_);
}

}  // namespace whirl::study
