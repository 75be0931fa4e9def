#pragma once
// A film with states whose steady equations are solved inside:
//
//     F(w, w') = f(w, w', s, r w'),   g(w, w', s, r w') = 0
//
// with r the rates of the states while nothing changes that the film remembers (Film::carried_rates). With lambda
// = (dg/ds)^-T df/ds of each force
//
//     dF/dw = df/dw - lambda . dg/dw,   dF/dw' = df/dw' + df/ds' r - lambda . (dg/dw' + dg/ds' r)
//
// A film that remembers nothing (r = 0) is asked for ds/dw = -(dg/ds)^-1 dg/dw instead, which predicts its states at
// motions near by: dF/dw = df/dw + df/ds ds/dw.

#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include "film/use/steady.hpp"

namespace whirl::film {

class Condensed final : public Film {
public:
  /// Of a film with states.
  explicit Condensed(std::unique_ptr<Film> film);
  [[nodiscard]] std::span<const Port> ports() const override { return film_->ports(); }
  using Film::evaluate;
  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override;
  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override;
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override;
  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> states) override;
  void start_from(const Film& other) override;
  /// Factorisations so far.
  [[nodiscard]] long factorisations() const { return steady_.factorisations(); }

private:
  // Motions that were solved with tangents, the oldest overwritten first. The points of a cycle come back in every step
  // of Newton's method, each time nearer to where they were.
  struct Known {
    JournalMotion motion;
    std::vector<double> states;
    Eigen::MatrixXf slopes;  // ds/dw as Steady::slopes()
    Response response;
  };
  void solve(const JournalMotion& motion, Need need);
  [[nodiscard]] bool follow(const JournalMotion& motion, Need need);
  [[nodiscard]] bool start_anew(const JournalMotion& motion, Need need);
  [[nodiscard]] bool attempt(const JournalMotion& motion, Need need, std::vector<double> states,
                             double error = Steady::unknown);
  [[nodiscard]] bool predict(const JournalMotion& motion, Need need);
  void remember(const Eigen::MatrixXd& slopes, const Response& response);
  // The nearest motion that is known, and how its states change from there.
  struct Near {
    const Known* known = nullptr;
    Eigen::VectorXd by, moved;  // change of w in the order of the slopes; of the states
    double size = Steady::unknown;
  };
  [[nodiscard]] Near nearest(const JournalMotion& motion) const;
  [[nodiscard]] bool extrapolate(const JournalMotion& motion, Response& response) const;
  [[nodiscard]] std::vector<double> carried(const std::array<double, 4>& by) const;

  std::unique_ptr<Film> film_;
  PortColumns carried_rates_;
  Steady steady_;
  // The last motion whose states were found, and whether steady_ still stands there.
  std::optional<JournalMotion> found_;
  std::vector<double> states_;
  bool there_ = false;
  std::vector<Known> known_;
  std::size_t oldest_ = 0;
  Eigen::VectorXd moves_;      // what a change of each w does to the states, in typical ones, at the motion last known
  std::exception_ptr reason_;  // why the last attempt failed
};

}  // namespace whirl::film
