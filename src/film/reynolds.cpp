// Reynolds' equation pad by pad: chooses the solver of each pad and adds the pads up.
#include <limits>
#include <numbers>
#include <string>

#include "film/kinds.hpp"
#include "film/pad.hpp"
#include "film/report.hpp"
#include "film/turning_frame.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

void demand(bool condition, const char* what) {
  if (!condition) throw core::InputError(std::string("film: ") + what);
}

}  // namespace

void check_pads(const Geometry& g, const Options& o, const Lubricant& l) {
  demand(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  const double limit = (g.type == Geometry::Bore::lemon_bore ? 1.0 : 2.0) * std::numbers::pi;
  const bool closed = g.type == Geometry::Bore::cylindrical;
  demand(closed || (g.arc > 0.0 && g.arc <= limit), "the arc must be positive and its pads must not overlap");
  demand(closed || o.grooves.empty(), "only a cylindrical bore has grooves");
  demand(o.inlet.type == Inlet::Type::free || (closed && o.grooves.empty()),
         "only a cylindrical bore without grooves has an inlet");
  demand(o.cavitation != Options::Cavitation::mass_conserving || !closed || !o.grooves.empty() ||
             o.inlet.type != Inlet::Type::free,
         "a film that conserves its mass must be fed: a cylindrical bore needs 'grooves' or an 'inlet'");
  demand(o.edge_fill == 1.0 || !closed || o.inlet.type != Inlet::Type::free,
         "'edge_fill' is of the edges of pads and inlets: a groove is full");
  demand(g.preload < 1.0, "the preload must be below 1");
  demand(g.type == Geometry::Bore::lemon_bore || g.offset == 0.0, "only a lemon bore has an offset");
  demand(o.cells[0] >= 3 && o.cells[1] >= 2, "at least 3 x 2 cells per pad");
  demand(l.viscosity > 0.0, "the viscosity must be positive");
  demand(l.density >= 0.0 && (l.density > 0.0 || o.turbulence == Options::Turbulence::laminar),
         "a turbulent film needs a positive density");
}

namespace {

class ReynoldsFilm final : public Model {
public:
  ReynoldsFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : options_(options), lubricant_(lubricant), pads_(make_pads(geometry, options.inlet)) {
    const bool modal = !options.tilt && (options.cavitation == Options::Cavitation::half_sommerfeld ||
                                         options.cavitation == Options::Cavitation::none);
    for (const Pad& pad : pads_) {
      solvers_.push_back(modal && !pad.closed ? make_modal_pad(pad, options, lubricant)
                                              : make_banded_pad(pad, options, lubricant));
    }
  }

  void evaluate(const Motion& motion, Need need, Response& response) override {
    response = {};
    response.min_thickness = std::numeric_limits<double>::infinity();
    if (turns()) {
      const TurningFrame frame(motion, pads_.front().clearance);
      solvers_.front()->add(frame.motion(), need, response);
      return frame.turn_back(need, response);
    }
    for (auto& solver : solvers_) solver->add(motion, need, response);
  }

  Summary summary(const Motion& motion) override {
    return summarise(pads_, options_, lubricant_, seen(motion), reports(motion));
  }
  std::vector<Field> fields(const Motion& motion) override {
    const double turn = turns() ? TurningFrame(motion, pads_.front().clearance).angle() : 0.0;
    return fields_of(pads_, options_, seen(motion), turn, reports(motion));
  }

private:
  [[nodiscard]] bool turns() const { return options_.inlet.type == Inlet::Type::maximum_gap; }
  // The motion seen by the pads.
  [[nodiscard]] Motion seen(const Motion& motion) const {
    return turns() ? TurningFrame(motion, pads_.front().clearance).motion() : motion;
  }
  std::vector<PadReport> reports(const Motion& given) {
    const Motion motion = seen(given);
    std::vector<PadReport> out;
    for (auto& solver : solvers_)
      out.push_back({solver->pressure(motion), solver->fill(motion), solver->flows(motion)});
    return out;
  }

  Options options_;
  Lubricant lubricant_;
  std::vector<Pad> pads_;
  std::vector<std::unique_ptr<PadSolver>> solvers_;
};

}  // namespace

std::unique_ptr<Model> make_reynolds(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  check_pads(geometry, options, lubricant);
  return std::make_unique<ReynoldsFilm>(geometry, options, lubricant);
}

}  // namespace whirl::film
