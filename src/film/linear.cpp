#include "whirl/film/linear.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/film/describe.hpp"
#include "whirl/film/film.hpp"

namespace whirl::film {
namespace {

using Eight = std::array<double, 8>;  // of stiffness, then of damping: xx xy yx yy

Eight entries(const LinearAt& a) {
  return {a.k_xx, a.k_xy, a.k_yx, a.k_yy, a.c_xx, a.c_xy, a.c_yx, a.c_yy};
}

// Slope at a row between intervals of lengths h and slopes d, zero where these turn: the curve does not overshoot.
double slope_between(double h0, double h1, double d0, double d1) {
  if (!(d0 * d1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

// The same at an end, of a parabola through three rows.
double slope_at_end(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (!(slope * d0 > 0)) return 0;
  return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

// Coefficients over the speed: cubic between the rows, with a continuous slope. Source: Fritsch and Butland (1984),
// SIAM J. Sci. Stat. Comput. 5, 300.
class OverSpeed {
public:
  OverSpeed(const std::vector<LinearAt>& table, bool holds) : holds_(holds) {
    for (const LinearAt& row : table) {
      if (!speed_.empty() && !(row.speed > speed_.back()))
        throw core::InputError("film: the speeds of the coefficients of a linear film rise");
      speed_.push_back(row.speed);
      value_.push_back(entries(row));
    }
    const std::size_t n = speed_.size();
    slope_.assign(n, Eight{});
    const auto h = [&](std::size_t k) { return speed_[k + 1] - speed_[k]; };
    for (std::size_t e = 0; e < 8 && n > 1; ++e) {
      const auto d = [&](std::size_t k) { return (value_[k + 1][e] - value_[k][e]) / h(k); };
      if (n == 2) {
        slope_[0][e] = slope_[1][e] = d(0);
        continue;
      }
      slope_[0][e] = slope_at_end(h(0), h(1), d(0), d(1));
      slope_[n - 1][e] = slope_at_end(h(n - 2), h(n - 3), d(n - 2), d(n - 3));
      for (std::size_t k = 1; k + 1 < n; ++k) slope_[k][e] = slope_between(h(k - 1), h(k), d(k - 1), d(k));
    }
  }

  struct At {
    Eight value{}, slope{};
  };
  // Of one row at all speeds. Throws core::DomainError beyond several, unless the ends hold.
  [[nodiscard]] At operator()(double speed) const {
    if (speed_.empty()) return {};
    if (speed_.size() == 1) return {value_.front(), {}};
    const double low = speed_.front(), high = speed_.back(), rounding = 1e-9 * high;
    const bool within = speed >= low - rounding && speed <= high + rounding;
    if (!within && holds_) return {speed < low ? value_.front() : value_.back(), {}};
    if (!within)
      throw core::DomainError(
          fmt::format("linear film: its coefficients are known from {:.6g} to {:.6g} rad/s, and the speed is {:.6g} "
                      "rad/s; 'extrapolate: hold' keeps those of the nearest end",
                      low, high, speed));
    const double x = std::clamp(speed, low, high);
    const auto above = std::upper_bound(speed_.begin() + 1, speed_.end() - 1, x);
    const auto k = static_cast<std::size_t>(above - speed_.begin()) - 1;
    const double h = speed_[k + 1] - speed_[k], t = (x - speed_[k]) / h, u = 1 - t;
    At out;
    for (std::size_t e = 0; e < 8; ++e) {
      const double rise = value_[k + 1][e] - value_[k][e], first = slope_[k][e], last = slope_[k + 1][e];
      out.value[e] = value_[k][e] + rise * t * t * (3 - 2 * t) + h * t * u * (first * u - last * t);
      out.slope[e] = rise * 6 * t * u / h + first * u * (1 - 3 * t) - last * t * (2 - 3 * t);
    }
    return out;
  }

private:
  bool holds_;
  std::vector<double> speed_;
  std::vector<Eight> value_, slope_;
};

// force = -K (x, y) - C (x', y').
class LinearFilm final : public Film {
public:
  explicit LinearFilm(const Linear& options)
      : stiffness_(options.stiffness),
        damping_(options.damping),
        over_speed_(options.table, options.extrapolate == Linear::Beyond::hold) {}

  void evaluate(const JournalMotion& motion, const Share& /*share*/, std::span<const double> /*states*/,
                std::span<const double> /*rates*/, Need need, StateResponse& all) override {
    Response& response = all.without_states();
    response.min_thickness = std::numeric_limits<double>::infinity();
    const OverSpeed::At at = over_speed_(motion.speed);
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) {
        const std::size_t e = 2 * i + j;
        const double k = stiffness_[e] + at.value[e], c = damping_[e] + at.value[4 + e];
        response.force[i] -= k * motion.position[j] + c * motion.velocity[j];
        if (need == Need::force) continue;
        response.d_position[i][j] = -k;
        response.d_velocity[i][j] = -c;
        response.d_speed[i] -= at.slope[e] * motion.position[j] + at.slope[4 + e] * motion.velocity[j];
      }
    }
  }
  FilmReport summary(const JournalMotion&, std::span<const double>) override {
    return {.min_thickness = std::numeric_limits<double>::infinity()};
  }
  std::vector<NodalField> fields(const JournalMotion&, std::span<const double>) override { return {}; }
  [[nodiscard]] double least_thickness(const JournalMotion&, std::span<const double>) override {
    return std::numeric_limits<double>::infinity();
  }

private:
  std::array<double, 4> stiffness_, damping_;
  OverSpeed over_speed_;
};

}  // namespace

std::span<const deck::Name<Linear::Beyond>> names(Linear::Beyond) {
  static constexpr deck::Name<Linear::Beyond> table[] = {
      {Linear::Beyond::none, "none", "there are none: a study ends there"},
      {Linear::Beyond::hold, "hold", "those of the nearest end of the table"}};
  return table;
}

void describe(deck::Description<LinearAt>& d) {
  using P = LinearAt;
  d.add("speed", &P::speed, "rad/s", deck::non_negative, "of the shaft").required();
  d.add("k_xx", &P::k_xx, "N/m", deck::any, "stiffness, force along x by a motion along x").required();
  d.add("k_xy", &P::k_xy, "N/m", deck::any, "force along x by a motion along y");
  d.add("k_yx", &P::k_yx, "N/m", deck::any, "force along y by a motion along x");
  d.add("k_yy", &P::k_yy, "N/m", deck::any, "force along y by a motion along y").required();
  d.add("c_xx", &P::c_xx, "N s/m", deck::any, "damping, likewise").alias("b_xx");
  d.add("c_xy", &P::c_xy, "N s/m", deck::any, "likewise").alias("b_xy");
  d.add("c_yx", &P::c_yx, "N s/m", deck::any, "likewise").alias("b_yx");
  d.add("c_yy", &P::c_yy, "N s/m", deck::any, "likewise").alias("b_yy");
}

void describe(deck::Description<Linear>& d) {
  d.add("stiffness", &Linear::stiffness, "N/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable();
  d.add("damping", &Linear::damping, "N s/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable();
  d.table("table", &Linear::table,
          "coefficients over the speed, which add to those; cubic between the rows without overshooting",
          "Fritsch and Butland 1984");
  d.add("extrapolate", &Linear::extrapolate, "coefficients at speeds beyond the table");
  d.check([](const Linear& o, const deck::Report& r) {
    for (std::size_t i = 1; i < o.table.size(); ++i)
      if (!(o.table[i].speed > o.table[i - 1].speed))
        return r.fail("table", fmt::format("speeds rise: row {} does not", i + 1));
  });
}

Facts facts_of(const Linear& options, const Geometry& /*geometry*/) {
  Facts f{.coefficients = true};
  if (options.table.size() > 1) f.known_speeds = {options.table.front().speed, options.table.back().speed};
  f.holds_beyond = options.extrapolate == Linear::Beyond::hold;
  return f;
}

std::unique_ptr<Film> make(const Geometry& /*geometry*/, const Linear& options, const Lubricant& /*lubricant*/) {
  return std::make_unique<LinearFilm>(options);
}

}  // namespace whirl::film
