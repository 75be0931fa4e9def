#include "whirl/io/checkpoint.hpp"

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::io {
namespace {

constexpr int format = 2;

Group state_of(const std::filesystem::path& path, const Group& whole) {
  if (!whole.has_attribute("checkpoint_format")) throw core::Error(path.string() + " is not a checkpoint");
  if (whole.integer("checkpoint_format") != format)
    throw core::Error(path.string() + " has checkpoint format " + std::to_string(whole.integer("checkpoint_format")) +
                      ", this program reads " + std::to_string(format));
  return whole.group("state");
}

void verify(const std::filesystem::path& path, const Group& whole, std::uint64_t found) {
  if (whole.text("checkpoint_checksum") != std::to_string(found))
    throw core::Error(path.string() + " is damaged: its checksum does not fit its contents");
}

Group load_one(const std::filesystem::path& path) {
  const Group whole = read_hdf5(path, MPI_COMM_SELF);  // shared datasets stay marked
  Group state = state_of(path, whole);
  verify(path, whole, checksum(state));
  return state;
}

Group load_one(const std::filesystem::path& path, MPI_Comm comm) {
  Group whole, state;
  core::agree(comm, [&] {
    whole = read_hdf5(path, comm);
    state = state_of(path, whole);
  });
  const std::uint64_t found = checksum(state, comm);
  core::agree(comm, [&] { verify(path, whole, found); });
  return state;
}

// `one` loads a file.
template <class F>
Checkpoint::Loaded newest(const std::filesystem::path& path, const std::filesystem::path& previous, F&& one) {
  std::string reason;
  try {
    return {one(path), false, ""};
  } catch (const core::Error& e) {
    reason = e.what();
  }
  try {
    return {one(previous), true, reason};
  } catch (const core::Error& e) {
    core::Error neither("no usable checkpoint: " + reason + "; " + e.what());
    if (e.agreed()) neither.mark_agreed();
    throw neither;
  }
}

Group packed(const Group& state, std::uint64_t sum) {
  Group whole;
  whole.set("checkpoint_format", format);
  whole.set("checkpoint_checksum", std::to_string(sum));
  whole.child("state") = state;
  return whole;
}

}  // namespace

std::filesystem::path Checkpoint::previous() const {
  return path_.string() + ".prev";
}

std::filesystem::path Checkpoint::next() const {
  return path_.string() + ".next";
}

// Between these renames only the predecessor has its name, and load() takes that one.
void Checkpoint::rename() const {
  std::error_code why;
  std::filesystem::rename(path_, previous(), why);  // the first save has no predecessor
  std::filesystem::rename(next(), path_, why);
  if (why) throw core::Error("cannot write " + path_.string() + ": " + why.message());
}

void Checkpoint::save(const Group& state) const {
  write_hdf5(next(), packed(state, checksum(state)));
  rename();
}

void Checkpoint::save(const Group& state, MPI_Comm comm) const {
  const bool shared = is_shared(state), first = core::rank_of(comm) == 0;
  if (shared) write_hdf5(next(), packed(state, checksum(state, comm)), comm);
  core::agree(comm, [&] {
    if (first) shared ? rename() : save(state);
  });
}

Checkpoint::Loaded Checkpoint::load() const {
  return newest(path_, previous(), [](const auto& path) { return load_one(path); });
}

Checkpoint::Loaded Checkpoint::load(MPI_Comm comm) const {
  return newest(path_, previous(), [comm](const auto& path) { return load_one(path, comm); });
}

bool Checkpoint::exists() const {
  return std::filesystem::exists(path_) || std::filesystem::exists(previous());
}

void Checkpoint::remove() const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  for (const char* left : beside) std::filesystem::remove(path_.string() + left, ignored);
}

}  // namespace whirl::io
