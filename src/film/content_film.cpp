// Film on rigid pads that conserves its mass in time: what the gap holds is the state.
#include <algorithm>
#include <limits>

#include "film/content_pad.hpp"
#include "film/report.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

class ContentFilm final : public StateModel {
public:
  ContentFilm(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant)
      : geometry_(geometry), options_(options), lubricant_(lubricant), pads_(make_pads(geometry, options.inlet)) {
    if (options.inlet.type == Inlet::Type::maximum_gap)
      throw core::InputError("film: a film with dynamic states cannot follow an inlet at the maximum gap");
    if (!(options.bulk_modulus > 0.0)) throw core::InputError("film: the bulk modulus must be positive");
    for (const Pad& pad : pads_) {
      first_.push_back(states_);
      solvers_.push_back(std::make_unique<ContentPad>(pad, options, lubricant));
      states_ += solvers_.back()->states();
    }
  }

  [[nodiscard]] std::size_t states() const override { return states_; }
  [[nodiscard]] int row_entries() const override { return 6; }
  [[nodiscard]] double state_scale() const override { return geometry_.clearance; }
  [[nodiscard]] bool whole_steps() const override { return true; }
  void unloaded(const Motion& /*motion*/, std::span<double> states) const override {
    std::fill(states.begin(), states.end(), 0.0);
  }

  void evaluate_lines(const Motion& motion, Lines /*part*/, std::span<const double> states,
                      std::span<const double> rates, Need need, StateResponse& response) override {
    response.journal = {};
    response.journal.min_thickness = std::numeric_limits<double>::infinity();
    response.residual.clear();
    response.d_states.clear();
    response.d_rates.clear();
    response.d_position.clear();
    response.d_velocity.clear();
    response.d_speed.clear();
    response.force_d_rates.clear();
    response.force_d_states.assign(need == Need::tangents ? states_ : 0, {});
    for (std::size_t n = 0; n < pads_.size(); ++n)
      solvers_[n]->append(motion, of(n, states), of(n, rates), static_cast<int>(first_[n]), need, response);
  }

  void resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                std::span<double> to) const override {
    const auto* mesh = dynamic_cast<const ContentFilm*>(&other);
    core::require(mesh != nullptr && from.size() == mesh->states_ && mesh->pads_.size() == pads_.size(),
                  "states of another film that conserves its mass");
    for (std::size_t n = 0; n < pads_.size(); ++n)
      solvers_[n]->resample(motion, *mesh->solvers_[n], mesh->of(n, from),
                            to.subspan(first_[n], solvers_[n]->states()));
  }

  [[nodiscard]] double least_thickness(const Motion& motion, std::span<const double> /*states*/) const override {
    std::array<double, 4> position = motion.position;
    if (!options_.tilt) position[2] = position[3] = 0.0;
    return minimum_thickness(geometry_, position);
  }
  Summary summary(const Motion& motion, std::span<const double> states) override {
    return summarise(pads_, options_, lubricant_, motion, reports(motion, states));
  }
  std::vector<Field> fields(const Motion& motion, std::span<const double> states) override {
    return fields_of(pads_, options_, motion, 0.0, reports(motion, states));
  }

private:
  [[nodiscard]] std::span<const double> of(std::size_t pad, std::span<const double> all) const {
    return all.subspan(first_[pad], solvers_[pad]->states());
  }
  std::vector<PadReport> reports(const Motion& motion, std::span<const double> states) {
    std::vector<PadReport> out;
    for (std::size_t n = 0; n < pads_.size(); ++n) out.push_back(solvers_[n]->report(motion, of(n, states)));
    return out;
  }

  Geometry geometry_;
  Reynolds options_;
  Lubricant lubricant_;
  std::vector<Pad> pads_;
  std::vector<std::unique_ptr<ContentPad>> solvers_;
  std::vector<std::size_t> first_;  // state of each pad
  std::size_t states_ = 0;
};

}  // namespace

std::unique_ptr<StateModel> make_content(const Geometry& geometry, const Reynolds& options,
                                         const Lubricant& lubricant) {
  return std::make_unique<ContentFilm>(geometry, options, lubricant);
}

}  // namespace whirl::film
