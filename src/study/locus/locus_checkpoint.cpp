// What a curve of bifurcations needs to go on after an interruption.

#include "study/cycle/cycle_record.hpp"
#include "study/locus/locus_follower.hpp"
#include "study/packed.hpp"

namespace whirl::study {

solve::Restart LocusFollower::restore(Vec like) {
  const io::Group& state = pieces_->state();
  unpack(state.reals("follower"), *this);
  last_ = rows_.empty() ? start_ : rows_.back();
  read_summary(state.group("summary"), context_.results.summary());
  return read_restart(state.group("restart"), like);
}

void LocusFollower::save(const solve::ResumePoint& at, Vec whole, Vec tangent) {
  if (!pieces_->state_due()) return;
  io::Group state;
  write_cycle(state.child("cycle"), point_at(whole).cycle);
  state.set("second", at.point.parameter * second_scale_);
  put_packed(state, "follower", *this, "what was found so far");
  write_summary(state.child("summary"), context_.results.summary());
  write_restart(state.child("restart"), at, whole, tangent);
  pieces_->save(std::move(state));
}

}  // namespace whirl::study
