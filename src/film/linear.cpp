#include <limits>

#include "film/kinds.hpp"

namespace whirl::film {
namespace {

// force = -K (x, y) - C (x', y').
class LinearFilm final : public Model {
public:
  explicit LinearFilm(const Options& options) : stiffness_(options.stiffness), damping_(options.damping) {}

  void evaluate(const Motion& motion, Need need, Response& response) override {
    response = {};
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
  Summary summary(const Motion&) override { return {.min_thickness = std::numeric_limits<double>::infinity()}; }
  std::vector<Field> fields(const Motion&) override { return {}; }
  [[nodiscard]] bool linear() const override { return true; }

private:
  std::array<double, 4> stiffness_, damping_;
};

}  // namespace

std::unique_ptr<Model> make_linear(const Options& options) {
  return std::make_unique<LinearFilm>(options);
}

}  // namespace whirl::film
