#include "branch_state.hpp"

#include "study/cycle/cycle_record.hpp"
#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {

namespace {

// Events as rows of numbers.
constexpr std::size_t numbers_of_event = 13;

void put_events(io::Group& group, const std::string& name, const std::vector<solve::LocatedEvent>& events) {
  std::vector<double> flat;
  for (const auto& e : events)
    flat.insert(flat.end(), {static_cast<double>(e.event), e.parameter, e.bracket, e.sensitivity, e.critical.real(),
                             e.critical.imag(), e.located ? 1.0 : 0.0, e.refined ? 1.0 : 0.0, e.quadratic,
                             static_cast<double>(e.unstable_before), static_cast<double>(e.unstable_after), e.slope,
                             static_cast<double>(e.after)});
  group.put(name, std::move(flat), "1", "events of the last step");
}

std::vector<solve::LocatedEvent> events_of(const io::Group& group, const std::string& name) {
  std::vector<solve::LocatedEvent> events;
  const auto& flat = group.reals(name);
  for (std::size_t k = 0; k + numbers_of_event <= flat.size(); k += numbers_of_event) {
    const double* v = &flat[k];
    events.push_back({static_cast<solve::Event>(static_cast<int>(v[0])),
                      v[1],
                      v[2],
                      v[3],
                      {v[4], v[5]},
                      v[6] != 0,
                      v[7] != 0,
                      v[8],
                      static_cast<int>(v[9]),
                      static_cast<int>(v[10]),
                      v[11],
                      static_cast<int>(v[12])});
  }
  return events;
}

void put_unknowns(io::Group& group, const std::string& name, Vec v, bool shared) {
  put_vector(group, name, v, shared, "scaled, in global order");
}

core::Vector unknowns_of(const io::Group& group, const std::string& name, Vec like) {
  core::Vector v = core::duplicate(like);
  take_vector(group, name, v.get());
  return v;
}

}  // namespace

void write_memory(io::Group& group, const solve::BranchMemory& memory, bool shared) {
  if (memory.before.u) {
    write_point(group.child("before"), memory.before.point);
    put_unknowns(group, "u", memory.before.u.get(), shared);
    put_unknowns(group, "tangent", memory.before.tangent.get(), shared);
  }
  if (memory.earlier) write_point(group.child("earlier"), *memory.earlier);
  group.set("visited", memory.visited ? 1 : 0);
  std::vector<double> folds;
  for (const auto& [parameter, reach] : memory.folds) folds.insert(folds.end(), {parameter, reach});
  group.put("folds", std::move(folds), "1", "folds of the last step, and how far it reaches from there");
  put_events(group, "met", memory.met);
  group.put("warm", memory.warm, "1", "what helps with the next solution");
  group.set("born", memory.born ? 1 : 0);
  std::vector<double> ranges;
  for (const auto& [low, high] : memory.ranges) ranges.insert(ranges.end(), {low, high});
  group.put("ranges", std::move(ranges), "1", "of the axes of the branch's pictures so far");
  group.put("between", memory.between, "1", "parameters of the points within the last step");
  if (!memory.held) return;
  put_events(group, "held", {*memory.held});
  put_unknowns(group, "held_u", memory.held_u.get(), shared);
}

solve::BranchMemory read_memory(const io::Group& group, Vec like) {
  solve::BranchMemory memory;
  if (group.has_group("before"))
    memory.before = {unknowns_of(group, "u", like), unknowns_of(group, "tangent", like),
                     read_point(group.group("before"))};
  if (group.has_group("earlier")) memory.earlier = read_point(group.group("earlier"));
  memory.visited = group.integer("visited") != 0;
  const auto& folds = group.reals("folds");
  for (std::size_t k = 0; k + 1 < folds.size(); k += 2) memory.folds.emplace_back(folds[k], folds[k + 1]);
  memory.met = events_of(group, "met");
  memory.warm = group.reals("warm");
  memory.born = group.integer("born") != 0;
  const auto& ranges = group.reals("ranges");
  for (std::size_t k = 0; k + 1 < ranges.size(); k += 2) memory.ranges.emplace_back(ranges[k], ranges[k + 1]);
  memory.between = group.reals("between");
  if (group.has_dataset("held")) {
    memory.held = events_of(group, "held").front();
    memory.held_u = unknowns_of(group, "held_u", like);
  }
  return memory;
}

void write_restart(io::Group& group, const solve::ResumePoint& at, Vec u, Vec tangent) {
  write_point(group.child("point"), at.point);
  put_unknowns(group, "u", u, false);
  put_unknowns(group, "tangent", tangent, false);
  group.set("next_step", at.next_step);
  write_memory(group.child("memory"), *at.memory, false);
}

solve::Restart read_restart(const io::Group& group, Vec like) {
  return {unknowns_of(group, "u", like), unknowns_of(group, "tangent", like), group.real("next_step"),
          read_point(group.group("point")), read_memory(group.group("memory"), like)};
}

}  // namespace whirl::study
