#include "study/bars/error_bar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::study {
namespace {

constexpr double least_order = 0.5;
constexpr double least_doubt = 0.25;  // of the largest estimate: safety factor 1.25 (Roache 1994)
constexpr double single_factor = 3;   // two meshes alone (Roache 1994)
constexpr double confidence = 0.95;   // of what scatters
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Estimate {
  double error = 0, doubt = 0;
};

// Order that steps of halves or doubles show, the lowest where two pairs of steps do; theory if there are none, or they
// show more: then two meshes agree by chance.
double order_of(double value, const std::vector<Sample>& samples, double theory) {
  const auto find = [&](double spacing) {
    for (const Sample& s : samples)
      if (std::abs(s.spacing - spacing) < 1e-9) return s.value;
    return nothing;
  };
  const auto shown = [&](double coarse, double fine) {
    return coarse * fine > 0 ? std::clamp(std::log2(coarse / fine), least_order, theory) : theory;
  };
  const double half = find(0.5), fine = value - half;
  return std::min(shown(find(2) - value, fine), shown(fine, half - find(0.25)));
}

Estimate estimate(double value, std::vector<Sample> samples, double theory) {
  if (samples.empty()) return {nothing, nothing};
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.spacing < b.spacing; });
  const double order = order_of(value, samples, theory);
  const auto error = [&](const Sample& s, double p) { return (value - s.value) / (1 - std::pow(s.spacing, p)); };
  Estimate out;
  double largest = 0;
  // A finer mesh is believed with the order that is seen, a coarser one with that of theory: there the regular law has
  // begun least of all, and a low order seen would blow it up.
  out.error = error(samples.front(), samples.front().spacing < 1 ? order : theory);
  for (const Sample& s : samples) {
    const double e = error(s, s.spacing < 1 ? order : theory);
    out.doubt = std::max(out.doubt, std::abs(e - out.error));
    largest = std::max(largest, std::abs(e));
  }
  out.doubt = std::max(out.doubt, least_doubt * largest);
  if (samples.size() == 1) out.doubt = (single_factor - 1) * std::abs(out.error);
  return out;
}

// Q(0) + C h^p through the numbers on all meshes of a direction.
struct Regression {
  double slope = 0, left = 0;        // C; what it leaves at the mesh in use
  double of_slope = 0, unknown = 0;  // variances of C and of Q(0)
  int freedoms = 0;
  [[nodiscard]] bool leans() const {
    return std::abs(slope) > student_quantile(confidence, freedoms) * std::sqrt(of_slope);
  }
  [[nodiscard]] double length() const {
    return std::abs(slope + left) + student_quantile(confidence, freedoms) * std::sqrt(unknown);
  }
};

// Order zero: no slope. At least one number more than the line has parameters. Kinks are errors of first order, of a
// factor that is chance: the scatter falls with the spacing, so that weights are its inverse square.
Regression line_through(double value, std::vector<Sample> samples, double order) {
  samples.push_back({Axis::around, 1, value});
  double sum = 0, mean_x = 0, mean_y = 0;
  const auto weight = [](const Sample& s) { return 1 / (s.spacing * s.spacing); };
  for (const Sample& s : samples) {
    sum += weight(s);
    mean_x += weight(s) * std::pow(s.spacing, order);
    mean_y += weight(s) * s.value;
  }
  mean_x /= sum, mean_y /= sum;
  double xx = 0, xy = 0;
  for (const Sample& s : samples) {
    const double x = std::pow(s.spacing, order) - mean_x;
    xx += weight(s) * x * x, xy += weight(s) * x * (s.value - mean_y);
  }
  Regression out;
  out.slope = order > 0 ? xy / xx : 0;
  const auto left = [&](const Sample& s) {
    return s.value - mean_y - out.slope * (std::pow(s.spacing, order) - mean_x);
  };
  double squares = 0;
  for (const Sample& s : samples) squares += weight(s) * left(s) * left(s);
  out.left = left(samples.back());
  out.freedoms = static_cast<int>(samples.size()) - (order > 0 ? 2 : 1);
  const double variance = squares / out.freedoms;
  out.of_slope = order > 0 ? variance / xx : 0;
  out.unknown = variance / sum + mean_x * mean_x * out.of_slope;
  return out;
}

Regression best_line(double value, const std::vector<Sample>& samples, double theory) {
  const bool agree = std::all_of(samples.begin(), samples.end(), [&](const Sample& s) { return s.value == value; });
  if (samples.empty() || (samples.size() < 2 && !agree)) return {nothing, nothing, nothing, nothing, 1};
  const Regression none = line_through(value, samples, 0);
  if (samples.size() < 2) return none;
  const Regression first = line_through(value, samples, 1), other = line_through(value, samples, theory);
  if (!first.leans() || !other.leans()) return first.leans() ? first : other.leans() ? other : none;
  return first.length() > other.length() ? first : other;
}

}  // namespace

// P(|t| < x) = A: Abramowitz and Stegun (1964), 26.7.3 and 26.7.4, with the angle atan(x/sqrt(freedoms)).
double student_quantile(double probability, int freedoms) {
  const auto within = [freedoms](double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const bool odd = freedoms % 2 != 0;
    double sum = 0, term = odd ? s * c : s;
    for (int k = odd ? 1 : 0; k + 2 <= freedoms; k += 2) {
      sum += term;
      term *= c * c * (k + 1) / (k + 2);
    }
    return odd ? 2 / std::numbers::pi * (angle + sum) : sum;
  };
  double low = 0, high = std::numbers::pi / 2;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (within(middle) < probability ? low : high) = middle;
  }
  return std::sqrt(freedoms) * std::tan(low);
}

Bar error_bar(double value, const std::vector<Sample>& samples, const MeshLaw& law) {
  Bar bar;
  if (!law.estimated) bar.film_mesh = unknown;
  double unknown_squares = 0, by_freedom = 0;
  for (const Axis axis : all_axes) {
    std::vector<Sample> own;
    bool any = false;
    for (const Sample& s : samples) {
      if (s.axis != axis) continue;
      any = true;
      if (std::isfinite(s.value) && s.spacing != 1) own.push_back(s);
    }
    if (!any) continue;
    if (of_film(axis) && law.kinks) {
      const Regression line = best_line(value, own, law.film_order);
      bar.film_mesh += std::abs(line.slope);
      bar.kinks += std::abs(line.left);
      unknown_squares += line.unknown;
      by_freedom += line.unknown * line.unknown / line.freedoms;
      continue;
    }
    const double order = of_film(axis) ? law.film_order : axis == Axis::time ? law.time_order : law.shaft_order;
    const Estimate e = estimate(value, own, order);
    (of_film(axis)        ? bar.film_mesh
     : axis == Axis::time ? bar.time_mesh
                          : bar.shaft_mesh) += std::abs(e.error) + e.doubt;
    if (!of_film(axis) || !law.feeds_move) continue;
    double low = value, high = value;
    for (const Sample& s : own) low = std::min(low, s.value), high = std::max(high, s.value);
    bar.film_mesh += high - low;
  }
  if (unknown_squares > 0) {
    const double freedoms = unknown_squares * unknown_squares / by_freedom;
    bar.kinks += student_quantile(confidence, static_cast<int>(freedoms * (1 + 1e-12))) * std::sqrt(unknown_squares);
  }
  return bar;
}

std::map<std::string, double> Bar::parts(bool with_time) const {
  std::map<std::string, double> out{{"uncertainty_film_mesh", film_mesh}, {"uncertainty_location", location}};
  if (with_time) out["uncertainty_time_mesh"] = time_mesh;
  if (kinks > 0) out["uncertainty_kinks"] = kinks;
  if (shaft_mesh != 0) out["uncertainty_shaft_mesh"] = shaft_mesh;
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
