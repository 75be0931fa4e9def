// What a curve of bifurcations needs to go on after an interruption.

#include "study/branch_state.hpp"
#include "study/cycle/cycle_record.hpp"
#include "study/locus/locus_follower.hpp"

namespace whirl::study {

void write_rows(io::Group& group, const std::vector<Row>& rows) {
  std::vector<double> flat;
  for (const Row& r : rows)
    flat.insert(flat.end(), {r.first, r.second, r.period, r.angle, r.amplitude, static_cast<double>(r.others_unstable),
                             r.mesh_wave});
  group.put("rows", {rows.size(), 7}, std::move(flat), "SI", "points of the curve");
}

std::vector<Row> read_rows(const io::Group& group) {
  std::vector<Row> rows;
  const auto& flat = group.reals("rows");
  for (std::size_t k = 0; k + 6 < flat.size(); k += 7)
    rows.push_back(
        {flat[k], flat[k + 1], flat[k + 2], flat[k + 3], flat[k + 4], static_cast<int>(flat[k + 5]), flat[k + 6]});
  return rows;
}

std::optional<io::Group> LocusFollower::interrupted() const {
  const io::Group& state = pieces_->state();
  if (!context_.resume || !state.has_group("restart") || (state.integer("second_way") != 0) != second_way_)
    return std::nullopt;
  return state;
}

solve::Restart LocusFollower::restore(const io::Group& state, Vec like) {
  rows_ = read_rows(state.group("rows"));
  start_ = read_rows(state.group("start")).front();
  last_ = rows_.empty() ? start_ : rows_.back();
  inner_sign_ = state.real("inner_sign");
  length_ = state.real("length");
  spread_.read(state.group("spread"));
  zeros_ = static_cast<int>(state.integer("zeros"));
  seed_.sensitivity = state.real("sensitivity");
  const auto& generalised = state.reals("generalised");
  generalised_.clear();
  for (std::size_t k = 0; k + 2 < generalised.size(); k += 3)
    generalised_.push_back({generalised[k], generalised[k + 1], generalised[k + 2]});
  read_summary(state.group("summary"), context_.results.summary());
  return read_restart(state.group("restart"), like);
}

void LocusFollower::save(const solve::ResumePoint& at, Vec whole, Vec tangent) {
  if (!pieces_->state_due()) return;
  io::Group state;
  write_cycle(state.child("cycle"), point_at(whole).cycle);
  state.set("second", at.point.parameter * second_scale_);
  state.set("second_way", second_way_ ? 1 : 0);
  if (second_way_) {
    write_rows(state.child("done"), done_);
    done_spread_.write(state.child("done_spread"));
    state.set("done_reason", done_end_.reason);
    state.set("done_completed", done_end_.completed ? 1 : 0);
    state.set("done_points", done_end_.points);
    state.set("done_parameter", done_end_.parameter);
  }
  write_rows(state.child("rows"), rows_);
  write_rows(state.child("start"), {start_});
  state.set("inner_sign", inner_sign_);
  state.set("length", length_);
  spread_.write(state.child("spread"));
  state.set("zeros", zeros_);
  state.set("sensitivity", seed_.sensitivity);
  std::vector<double> generalised;
  for (const auto& [first, second, reach] : generalised_) generalised.insert(generalised.end(), {first, second, reach});
  state.put("generalised", generalised, "1", "generalised points that are confirmed, and how far around");
  write_summary(state.child("summary"), context_.results.summary());
  write_restart(state.child("restart"), at, whole, tangent);
  pieces_->save(std::move(state));
}

}  // namespace whirl::study
