#include "branch_state.hpp"

#include "study/packed.hpp"
#include "study/stored_vector.hpp"

namespace whirl::study {

namespace {

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
  put_packed(group, "facts", memory, "what the next steps go by");
  if (memory.before.u) {
    put_unknowns(group, "u", memory.before.u.get(), shared);
    put_unknowns(group, "tangent", memory.before.tangent.get(), shared);
  }
  if (memory.held) put_unknowns(group, "held_u", memory.held_u.get(), shared);
}

solve::BranchMemory read_memory(const io::Group& group, Vec like) {
  auto memory = take_packed<solve::BranchMemory>(group, "facts");
  if (group.has_dataset("u")) {
    memory.before.u = unknowns_of(group, "u", like);
    memory.before.tangent = unknowns_of(group, "tangent", like);
  }
  if (memory.held) memory.held_u = unknowns_of(group, "held_u", like);
  return memory;
}

void write_restart(io::Group& group, const solve::ResumePoint& at, Vec u, Vec tangent) {
  put_packed(group, "point", at.point, "the last one");
  put_unknowns(group, "u", u, false);
  put_unknowns(group, "tangent", tangent, false);
  group.set("next_step", at.next_step);
  write_memory(group.child("memory"), *at.memory, false);
}

solve::Restart read_restart(const io::Group& group, Vec like) {
  return {unknowns_of(group, "u", like), unknowns_of(group, "tangent", like), group.real("next_step"),
          take_packed<solve::BranchPoint>(group, "point"), read_memory(group.group("memory"), like)};
}

}  // namespace whirl::study
