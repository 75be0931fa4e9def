#include "study/motion/motion_record.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/stored_vector.hpp"
#include "whirl/io/table.hpp"
#include "whirl/transient/analysis/spectrum.hpp"

namespace whirl::study {
namespace {

constexpr const char* axis_names[] = {"x", "y"};
// Tones named in the summary; the spectrum holds all.
constexpr int tones_named = 5;

}  // namespace

MotionRecord::MotionRecord(const MotionOptions& options, system::ShownPlaces places, bool forced, Vec like, bool driven)
    : options_(options),
      forced_(forced),
      driven_(driven),
      places_(std::move(places)),
      like_(like),
      period_(2 * std::numbers::pi / options.speed.value),
      exponents_(options.exponents) {}

void MotionRecord::sample(const std::vector<system::PlaceState>& shown, Vec state) {
  const std::vector<double> scaled = entries_here(state);
  last_.clear();
  for (const auto& j : shown) {
    open_.samples.insert(open_.samples.end(), j.position.begin(), j.position.end());
    last_.insert(last_.end(), j.position.begin(), j.position.end());
    last_.insert(last_.end(), j.velocity.begin(), j.velocity.end());
  }
  if (origin_.empty()) origin_ = scaled;
  open_.sum.resize(scaled.size(), 0.0);
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    const double moved = scaled[i] - origin_[i];
    open_.sum[i] += moved;
    open_.squares += moved * moved;
  }
  last_state_ = scaled;
}

void MotionRecord::close(const std::vector<double>& growth, double duration) {
  samples_.insert(samples_.end(), open_.samples.begin(), open_.samples.end());
  sum_.resize(open_.sum.size(), 0.0);
  for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += open_.sum[i];
  squares_ += open_.squares;
  open_ = {};
  points_.push_back(last_state_);
  ends_.insert(ends_.end(), last_.begin(), last_.end());
  section_.close();
  if (!growth.empty()) exponents_.add(growth, duration);
}

transient::Evidence MotionRecord::evidence() const {
  transient::Evidence e;
  e.forced = forced_;
  e.driven = driven_;
  const double count = static_cast<double>(points_.size()) * options_.samples;
  double of_all[] = {0, squares_};  // square of the mean, sum of the squares
  for (const double s : sum_) of_all[0] += (s / count) * (s / count);
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(like_));
  MPI_Allreduce(MPI_IN_PLACE, of_all, 2, MPI_DOUBLE, MPI_SUM, comm);
  e.size = std::sqrt(std::max(0.0, of_all[1] / count - of_all[0]));
  e.return_tolerance = options_.return_tolerance;
  e.grows = grows_;
  // A motion that nothing forces has no angle to return at, but a section.
  const auto& returning = forced_ ? points_ : section_.states();
  if (e.size >= e.rest) e.returns = transient::return_distances(returning, options_.max_period, e.size, comm);
  e.fading = transient::fading_of_returns(returning, options_.max_period, comm);
  e.course = transient::course_of_returns(returning, comm);
  if (options_.exponents > 0) {
    e.exponents = exponents_.values();
    e.uncertainties = exponents_.uncertainties();
    // No mean of integrated growth is better than the integration.
    for (double& u : e.uncertainties) u = std::max(u, 1e2 * options_.tolerance / period_);
  }
  return e;
}

transient::Verdict MotionRecord::verdict() const {
  return transient::classify(evidence());
}

std::vector<double> MotionRecord::signal(std::size_t bearing, std::size_t direction) const {
  std::vector<double> out;
  for (std::size_t k = 2 * bearing + direction; k < samples_.size(); k += 2 * places_.names.size())
    out.push_back(samples_[k]);
  return out;
}

void MotionRecord::write_orbit(io::Group& group) const {
  const std::size_t n = places_.names.size(), all = samples_.size() / (2 * n),
                    kept = std::min(all, static_cast<std::size_t>(options_.orbit * options_.samples));
  const std::vector<std::string>& row = places_.names;
  const auto wide = io::Table::wide;
  io::Table table({{"revolutions", "1", "shaft angle over 2 pi since the record began"},
                   {"time", "s", "since the record began"},
                   wide("x", places_.unit, places_.text, row),
                   wide("y", places_.unit, places_.text, row),
                   wide("x_relative", "1", "x per clearance; zero where there is no clearance", row),
                   wide("y_relative", "1", "y per clearance", row)});
  for (std::size_t k = all - kept; k < all; ++k) {
    std::vector<std::vector<double>> p(4, std::vector<double>(n));
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t d = 0; d < 2; ++d) {
        p[d][b] = samples_[2 * (k * n + b) + d];
        p[2 + d][b] = places_.clearances[b] > 0 ? p[d][b] / places_.clearances[b] : 0.0;
      }
    const double turns = static_cast<double>(k + 1) / options_.samples;
    table.append({{turns}, {turns * period_}, p[0], p[1], p[2], p[3]});
  }
  table.write(group.child("orbit"));
}

void MotionRecord::write_points(io::Group& group) const {
  const std::size_t n = places_.names.size();
  const std::vector<std::string>& row = places_.names;
  const auto wide = io::Table::wide;
  io::Table table({{"revolution", "1", "at whose end, shaft angle zero"},
                   wide("x", places_.unit, places_.text, row),
                   wide("y", places_.unit, places_.text, row),
                   wide("velocity_x", places_.rate_unit, "rate of x", row),
                   wide("velocity_y", places_.rate_unit, "rate of y", row),
                   wide("x_relative", "1", "x per clearance; zero where there is no clearance", row),
                   wide("y_relative", "1", "y per clearance", row)});
  for (std::size_t k = 0; k < points_.size(); ++k) {
    std::vector<std::vector<double>> p(6, std::vector<double>(n));
    for (std::size_t b = 0; b < n; ++b) {
      for (std::size_t i = 0; i < 4; ++i) p[i][b] = ends_[4 * (k * n + b) + i];
      for (std::size_t d = 0; d < 2; ++d)
        p[4 + d][b] = places_.clearances[b] > 0 ? p[d][b] / places_.clearances[b] : 0.0;
    }
    table.append({{static_cast<double>(k + 1)}, p[0], p[1], p[2], p[3], p[4], p[5]});
  }
  table.write(group.child("poincare"));
}

void MotionRecord::write_spectrum(io::Group& group, io::StudySummary& summary) const {
  const std::size_t n = places_.names.size();
  const auto e = evidence();
  const int named = e.size < e.rest ? 0 : tones_named;
  const auto window = options_.window;
  std::vector<std::vector<transient::Spectrum>> all;
  for (std::size_t b = 0; b < n; ++b) {
    all.emplace_back();
    for (std::size_t d = 0; d < 2; ++d) {
      const std::vector<double> s = signal(b, d);
      all.back().push_back(transient::amplitude_spectrum(s, period_ / options_.samples, window));
      const auto [low, high] = std::minmax_element(s.begin(), s.end());
      summary.set(fmt::format("peak_to_peak.{}.{}", places_.names[b], axis_names[d]), *high - *low, places_.unit);
      int k = 0;
      for (const auto& tone : transient::tones(all.back().back(), named)) {
        const std::string head = fmt::format("tone.{}.{}.{}.", places_.names[b], axis_names[d], ++k);
        summary.set(head + "frequency", tone.frequency, "Hz");
        summary.set(head + "order", tone.frequency * period_, "1");
        summary.set(head + "amplitude", tone.amplitude, places_.unit);
      }
    }
  }
  std::vector<double> frequency, order, x, y;
  for (std::size_t k = 0; k < all[0][0].amplitude.size(); ++k) {
    frequency.push_back(static_cast<double>(k) * all[0][0].resolution);
    order.push_back(frequency.back() * period_);
    for (std::size_t b = 0; b < n; ++b) {
      x.push_back(all[b][0].amplitude[k]);
      y.push_back(all[b][1].amplitude[k]);
    }
  }
  auto& g = group.child("spectrum");
  const io::Shape shape{frequency.size(), n};
  g.put("frequency", frequency, "Hz", "of the lines");
  g.put("order", order, "1", "frequency per running speed");
  g.put("x", shape, x, places_.unit, "amplitude 0-peak of x [line][bearing]");
  g.put("y", shape, y, places_.unit, "amplitude 0-peak of y [line][bearing]");
  g.label_each({places_.names});
  write_full_spectrum(group, window);
}

void MotionRecord::write_full_spectrum(io::Group& group, transient::Window window) const {
  const std::size_t n = places_.names.size();
  std::vector<transient::FullSpectrum> all;
  for (std::size_t b = 0; b < n; ++b)
    all.push_back(transient::full_spectrum(signal(b, 0), signal(b, 1), period_ / options_.samples, window));
  std::vector<double> frequency, order, amplitude;
  for (std::size_t k = 0; k < all[0].amplitude.size(); ++k) {
    frequency.push_back((all[0].first + static_cast<double>(k)) * all[0].resolution);
    order.push_back(frequency.back() * period_);
    for (const transient::FullSpectrum& s : all) amplitude.push_back(s.amplitude[k]);
  }
  auto& g = group.child("full_spectrum");
  const io::Shape shape{frequency.size(), n};
  g.put("frequency", frequency, "Hz", "of the lines; positive turns from x to y, as the shaft does");
  g.put("order", order, "1", "frequency per running speed");
  g.put("amplitude", shape, amplitude, places_.unit, "radius 0-peak of the circle of this frequency [line][bearing]");
  g.label_each({places_.names});
}

void MotionRecord::write_exponents(io::Group& group, io::StudySummary& summary) const {
  if (options_.exponents == 0) return;
  const auto e = evidence();
  std::vector<double> running;
  for (std::size_t spans = 1; spans <= exponents_.spans(); ++spans)
    for (const double v : exponents_.values(spans)) running.push_back(v);
  for (std::size_t k = 0; k < e.exponents.size(); ++k) {
    const std::string head = fmt::format("lyapunov.{}", k + 1);
    summary.set(head, e.exponents[k], "1/s");
    summary.set(head + ".uncertainty", e.uncertainties[k], "1/s");
    summary.set(head + ".per_revolution", e.exponents[k] * period_, "1");
  }
  // Below chaos it is the number of frequencies, which the verdict knows better.
  const double dimension = transient::kaplan_yorke_dimension(e.exponents);
  if (verdict().kind == transient::MotionKind::chaotic && std::isfinite(dimension))
    summary.set("dimension.kaplan_yorke", dimension, "1");
  auto& g = group.child("exponents");
  g.put("value", e.exponents, "1/s", "Lyapunov exponents, the largest first");
  g.put("uncertainty", e.uncertainties, "1/s", "half the interval that holds it with 99 % probability");
  g.put("running", {exponents_.spans(), e.exponents.size()}, running, "1/s", "mean up to each revolution");
  g.label_each({io::numbered(e.exponents.size(), "exponent")});
}

void MotionRecord::write(io::Group& group, io::StudySummary& summary) const {
  const auto e = evidence();
  const auto v = verdict();
  summary.set("motion." + v.name, 1, "1");
  group.set("motion", v.name);
  group.set("evidence", v.reason);
  group.set("samples", options_.samples);
  if (v.period > 0) summary.set("period", v.period, "1");
  write_section(group, summary, v);
  write_rotation(group, summary, v);
  write_short_time(group);
  summary.set("size", e.size, "1");
  for (std::size_t k = 0; k < e.returns.size(); ++k) summary.set(fmt::format("return.{}", k + 1), e.returns[k], "1");
  write_exponents(group, summary);
  write_spectrum(group, summary);
  write_orbit(group);
  write_points(group);
}

void MotionRecord::save(io::Group& group, bool shared) const {
  group.put("samples", samples_, places_.unit, "what is shown");
  group.put("ends", ends_, "SI", "what is shown at the ends of revolutions");
  const auto put = [&](const char* name, const std::vector<double>& entries, const char* what) {
    core::Vector v = core::duplicate(like_);
    core::check(VecSet(v.get(), 0.0));
    if (!points_.empty()) std::copy(entries.begin(), entries.end(), core::WriteArray(v.get()).data());
    put_vector(group, name, v.get(), shared, what);
  };
  put("origin", origin_, "the first scaled state");
  put("sum", sum_, "of scaled states less the origin");
  double squares = squares_;
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(like_));
  MPI_Allreduce(MPI_IN_PLACE, &squares, 1, MPI_DOUBLE, MPI_SUM, comm);
  group.set("squares", squares);
  Eigen::MatrixXd points(static_cast<Eigen::Index>(sum_.size()), static_cast<Eigen::Index>(points_.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = Eigen::Map<const Eigen::VectorXd>(points_[static_cast<std::size_t>(k)].data(), points.rows());
  put_columns(group, "points", points, shared ? like_ : nullptr, "1", "scaled states at the ends of revolutions");
  group.put("growth", exponents_.growth(), "1", "of deviations");
  group.put("durations", exponents_.durations(), "s", "of revolutions");
  section_.save(group.child("section"), shared, like_);
}

void MotionRecord::load(const io::Group& group) {
  samples_ = group.reals("samples");
  ends_ = group.reals("ends");
  points_.clear();
  const Eigen::MatrixXd points = take_columns(group, "points", like_);
  for (const auto& column : points.colwise()) points_.emplace_back(column.begin(), column.end());
  const auto take = [&](const char* name) {
    core::Vector v = core::duplicate(like_);
    take_vector(group, name, v.get());
    return entries_here(v.get());
  };
  origin_ = points_.empty() ? std::vector<double>() : take("origin");
  sum_ = take("sum");
  // One rank's for all.
  squares_ = core::rank_of(PetscObjectComm(reinterpret_cast<PetscObject>(like_))) == 0 ? group.real("squares") : 0.0;
  exponents_ = transient::Exponents(options_.exponents);
  const auto &growth = group.reals("growth"), &durations = group.reals("durations");
  for (std::size_t i = 0; i < durations.size(); ++i)
    exponents_.add({growth.begin() + static_cast<std::ptrdiff_t>(i) * options_.exponents,
                    growth.begin() + static_cast<std::ptrdiff_t>(i + 1) * options_.exponents},
                   durations[i]);
  section_.load(group.group("section"), like_);
}

}  // namespace whirl::study
