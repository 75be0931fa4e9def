// Film on rigid pads that conserves its mass in time: what the gap holds is the state.
#include <algorithm>
#include <array>
#include <limits>

#include "film/sheet/content_pad.hpp"
#include "film/sheet/report.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/algebra/direct_inverse.hpp"
#include "whirl/film/sheet/thickness.hpp"

namespace whirl::film {
namespace {

class ContentFilm final : public Film {
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
  [[nodiscard]] std::vector<StateField> state_fields() const override {
    return {{"content", "m", geometry_.clearance, 0, static_cast<int>(states_)}};
  }
  [[nodiscard]] std::span<const Port> ports() const override {
    return std::span(all_ports).first(options_.tilt ? 4 : 2);
  }
  [[nodiscard]] bool whole_steps() const override { return true; }
  void unloaded(const JournalMotion& /*motion*/, std::span<double> states) const override {
    std::fill(states.begin(), states.end(), 0.0);
  }

  // At whole columns; all pads have the same number of states in each.
  [[nodiscard]] int cut(int near) const override {
    const int column = solvers_.front()->column();
    return (near + column / 2) / column * column;
  }
  [[nodiscard]] Share share(int begin, int end) const override { return lay_out(begin, end).share; }
  [[nodiscard]] std::unique_ptr<StateInverse> inverse(MPI_Comm comm, const Share& share) const override {
    return make_direct_inverse(comm, share);
  }

  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override {
    if (at_hand_.share.begin != share.begin || at_hand_.share.end != share.end)
      at_hand_ = lay_out(share.begin, share.end);
    core::require(states.size() == share.seen.size() && rates.size() == states.size(), "what a share of a film sees");
    const bool tangents = need == Need::tangents;
    const auto rows = static_cast<std::size_t>(share.rows());
    response.journal = {};
    response.journal.min_thickness = std::numeric_limits<double>::infinity();
    response.residual.resize(rows);
    response.d_states.resize(tangents ? share.d_states.size() : 0);
    response.d_rates.resize(tangents ? share.d_rates.size() : 0);
    response.d_speed.resize(tangents ? rows : 0);
    response.resize(tangents, std::ssize(ports()), share.rows());
    for (std::size_t n = 0; n < pads_.size(); ++n)
      solvers_[n]->evaluate(motion, at_hand_.pads[n], states, rates, need, response);
  }

  void resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                std::span<double> to) const override {
    const auto* mesh = dynamic_cast<const ContentFilm*>(&other);
    core::require(mesh != nullptr && from.size() == mesh->states_ && mesh->pads_.size() == pads_.size(),
                  "states of another film that conserves its mass");
    for (std::size_t n = 0; n < pads_.size(); ++n)
      solvers_[n]->resample(motion, *mesh->solvers_[n], mesh->of(n, from),
                            to.subspan(first_[n], solvers_[n]->states()));
  }

  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) override {
    std::array<double, 4> position = motion.position;
    if (!options_.tilt) position[2] = position[3] = 0.0;
    return minimum_thickness(geometry_, position);
  }
  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override {
    return summarise(pads_, options_, lubricant_, motion, reports(motion, states));
  }
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override {
    return fields_of(pads_, options_, motion, 0.0, reports(motion, states));
  }

private:
  struct Layout {
    Share share;
    std::vector<PadShare> pads;
  };
  // States held come first among those seen, then the columns beside them, pad by pad.
  [[nodiscard]] Layout lay_out(int begin, int end) const {
    const int line = solvers_.front()->column();
    core::require(begin % line == 0 && end % line == 0, "a film that is cut at whole columns");
    Layout out{{begin, end, {}, {}, {}}, {}};
    for (int k = begin; k < end; ++k) out.share.seen.push_back(k);
    for (std::size_t n = 0; n < pads_.size(); ++n) {
      const int first = static_cast<int>(first_[n]) / line, columns = static_cast<int>(solvers_[n]->states()) / line;
      PadShare pad;
      pad.begin = std::clamp(begin / line - first, 0, columns);
      pad.end = std::clamp(end / line - first, 0, columns);
      pad.row = (first + pad.begin) * line - begin;
      pad.seen.assign(static_cast<std::size_t>(columns), -1);
      for (int c = pad.begin; c < pad.end; ++c)
        pad.seen[static_cast<std::size_t>(c)] = pad.row + (c - pad.begin) * line;
      if (pad.begin < pad.end)
        for (int c = 0; c < columns; ++c) {
          const bool beside = solvers_[n]->sees(pad.begin, c) || solvers_[n]->sees(pad.end - 1, c);
          if (!beside || pad.seen[static_cast<std::size_t>(c)] >= 0) continue;
          pad.seen[static_cast<std::size_t>(c)] = static_cast<int>(out.share.seen.size());
          for (int j = 0; j < line; ++j) out.share.seen.push_back((first + c) * line + j);
        }
      out.pads.push_back(std::move(pad));
    }
    for (int place = 0; place < ContentPad::places; ++place)
      for (std::size_t n = 0; n < pads_.size(); ++n) solvers_[n]->add_places(place, out.pads[n], out.share.d_states);
    if (begin < end) out.share.d_rates.add({0, 0, end - begin});
    return out;
  }
  [[nodiscard]] std::span<const double> of(std::size_t pad, std::span<const double> all) const {
    return all.subspan(first_[pad], solvers_[pad]->states());
  }
  std::vector<PadReport> reports(const JournalMotion& motion, std::span<const double> states) {
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
  Layout at_hand_;  // of the share that was evaluated last
};

}  // namespace

std::unique_ptr<Film> make_content(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant) {
  return std::make_unique<ContentFilm>(geometry, options, lubricant);
}

}  // namespace whirl::film
