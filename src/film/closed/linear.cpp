#include "whirl/film/contract/linear.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "whirl/core/curve.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {
namespace {

using EightNumbers = std::array<double, 8>;  // of stiffness, then of damping: xx xy yx yy

EightNumbers entries(const LinearAt& a) {
  return {a.k_xx, a.k_xy, a.k_yx, a.k_yy, a.c_xx, a.c_xy, a.c_yx, a.c_yy};
}

// Coefficients over the speed.
class OverSpeed {
public:
  OverSpeed(const std::vector<LinearAt>& table, bool holds) : holds_(holds) {
    std::vector<double> speeds, values;
    for (const LinearAt& row : table) {
      speeds.push_back(row.speed);
      const EightNumbers of = entries(row);
      values.insert(values.end(), of.begin(), of.end());
    }
    curve_ = core::Curve(std::move(speeds), std::move(values), core::Curve::Between::cubic);
  }

  struct At {
    EightNumbers value{}, slope{};
  };
  // Of one row at all speeds. Throws core::DomainError beyond several, unless the ends hold.
  [[nodiscard]] At operator()(double speed) const {
    At out;
    if (curve_.empty()) return out;
    const double low = curve_.first(), high = curve_.last(), rounding = 1e-9 * high;
    const bool within = !curve_.varies() || (speed >= low - rounding && speed <= high + rounding);
    if (!within && !holds_)
      throw core::DomainError(
          fmt::format("linear film: its coefficients are known from {:.6g} to {:.6g} rad/s, and the speed is {:.6g} "
                      "rad/s; 'extrapolate: hold' keeps those of the nearest end",
                      low, high, speed));
    curve_.at(within ? std::clamp(speed, low, high) : speed, out.value, out.slope);
    return out;
  }

private:
  bool holds_;
  core::Curve curve_;
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
