#include "whirl/io/checkpoint.hpp"

#include "whirl/core/error.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::io {
namespace {

constexpr int format = 2;

Group load_one(const std::filesystem::path& path) {
  Group whole = read_hdf5(path);
  if (!whole.has_attribute("checkpoint_format")) throw core::Error(path.string() + " is not a checkpoint");
  if (whole.integer("checkpoint_format") != format)
    throw core::Error(path.string() + " has checkpoint format " + std::to_string(whole.integer("checkpoint_format")) +
                      ", this program reads " + std::to_string(format));
  Group state = whole.group("state");
  if (whole.text("checkpoint_checksum") != std::to_string(checksum(state)))
    throw core::Error(path.string() + " is damaged: its checksum does not fit its contents");
  return state;
}

}  // namespace

std::filesystem::path Checkpoint::previous() const {
  return path_.string() + ".prev";
}

void Checkpoint::save(const Group& state) const {
  Group whole;
  whole.set("checkpoint_format", format);
  whole.set("checkpoint_checksum", std::to_string(checksum(state)));
  whole.child("state") = state;
  const std::filesystem::path next = path_.string() + ".next";
  write_hdf5(next, whole);
  // Between these renames only the predecessor has its name, and load() takes that one.
  std::error_code why;
  std::filesystem::rename(path_, previous(), why);  // the first save has no predecessor
  std::filesystem::rename(next, path_, why);
  if (why) throw core::Error("cannot write " + path_.string() + ": " + why.message());
}

Checkpoint::Loaded Checkpoint::load() const {
  std::string reason;
  try {
    return {load_one(path_), false, ""};
  } catch (const core::Error& e) {
    reason = e.what();
  }
  try {
    return {load_one(previous()), true, reason};
  } catch (const core::Error& e) {
    throw core::Error("no usable checkpoint: " + reason + "; " + e.what());
  }
}

bool Checkpoint::exists() const {
  return std::filesystem::exists(path_) || std::filesystem::exists(previous());
}

void Checkpoint::remove() const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  std::filesystem::remove(previous(), ignored);
}

}  // namespace whirl::io
