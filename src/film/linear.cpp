#include <limits>

#include "whirl/film/describe.hpp"
#include "whirl/film/film.hpp"

namespace whirl::film {
namespace {

// force = -K (x, y) - C (x', y').
class LinearFilm final : public Film {
public:
  explicit LinearFilm(const Linear& options) : stiffness_(options.stiffness), damping_(options.damping) {}

  void evaluate(const JournalMotion& motion, const Share& /*share*/, std::span<const double> /*states*/,
                std::span<const double> /*rates*/, Need need, StateResponse& all) override {
    Response& response = all.without_states();
    response.min_thickness = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) {
        response.force[i] -= stiffness_[2 * i + j] * motion.position[j] + damping_[2 * i + j] * motion.velocity[j];
        if (need == Need::force) continue;
        response.d_position[i][j] = -stiffness_[2 * i + j];
        response.d_velocity[i][j] = -damping_[2 * i + j];
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
};

}  // namespace

void describe(deck::Description<Linear>& d) {
  d.add("stiffness", &Linear::stiffness, "N/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable();
  d.add("damping", &Linear::damping, "N s/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable();
}

Facts facts_of(const Linear& /*options*/, const Geometry& /*geometry*/) {
  return {.coefficients = true};
}

std::unique_ptr<Film> make(const Geometry& /*geometry*/, const Linear& options, const Lubricant& /*lubricant*/) {
  return std::make_unique<LinearFilm>(options);
}

}  // namespace whirl::film
