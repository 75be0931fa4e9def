#include "results.hpp"

#include <algorithm>

#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/session.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::study {

namespace fs = std::filesystem;

namespace {

std::string checkpoint_name(const std::string& study) {
  return io::safe_name(study) + ".checkpoint.h5";
}

// Those of this run in the file; an earlier one may have had others.
void put_options(io::Group& root, const std::vector<io::LibraryOption>& options) {
  root.erase_group("options");
  if (options.empty()) return;
  std::vector<std::string> names, values, sources;
  for (const auto& o : options) {
    names.push_back(o.name);
    values.push_back(o.value);
    sources.push_back(o.source);
  }
  auto& group = root.child("options");
  group.put("name", std::move(names), "options of PETSc and SLEPc in force");
  group.put("value", std::move(values), "their values; empty: a flag");
  group.put("source", std::move(sources), "where they came from; empty: not known");
}

}  // namespace

Results::Results(MPI_Comm comm, fs::path directory, const std::string& title, const std::string& version, Say say,
                 bool resume)
    : comm_(comm),
      rank_(core::rank_of(comm)),
      directory_(std::move(directory)),
      manifest_(directory_),
      say_(std::move(say)),
      started_run_(std::chrono::steady_clock::now()) {
  started_ = started_run_;
  if (rank_ != 0) say_ = nullptr;
  core::agree(comm_, [&] {
    // Every rank reads the same files; only rank 0 ever writes them.
    if (!resume || !fs::exists(directory_ / "summary.json")) return;
    all_ = io::Summary::read(directory_ / "summary.json");
    earlier_run_seconds_ = all_.wall_seconds;
    if (fs::exists(directory_ / "results.h5")) root_ = io::read_hdf5(directory_ / "results.h5");
    auto& studies = root_.child("studies");
    for (const auto& s : all_.studies) {
      // What delivered nothing is tried again.
      const std::string name = io::safe_name(s.name);
      const bool known = studies.has_group(name) && studies.group(name).has_attribute("delivered");
      if (!known || studies.group(name).integer("delivered") == 0) continue;
      finished_.push_back(s.name);
      // A run killed right after it finished the study leaves this behind.
      if (rank_ == 0) checkpoint(s.name).remove();
    }
  });
  io::describe_results(root_, title, version);
  root_.child("studies");
  all_.title = title;
  all_.version = version;
  all_.ranks = core::size_of(comm);
  all_.options.clear();
  for (const auto& o : core::Session::options_in_force()) all_.options.push_back({o.name, o.value, o.source});
  put_options(root_, all_.options);
}

bool Results::finished(const std::string& name) const {
  return std::find(finished_.begin(), finished_.end(), name) != finished_.end();
}

const io::Group& Results::group_of(const std::string& name) const {
  return root_.group("studies").group(io::safe_name(name));
}

io::Group& Results::group() {
  return root_.child("studies").child(io::safe_name(current_.name));
}

void Results::begin(const std::string& name, const std::string& kind) {
  current_ = {};
  current_.name = name;
  current_.kind = kind;
  started_ = std::chrono::steady_clock::now();
  earlier_seconds_ = 0;
  root_.child("studies").erase_group(io::safe_name(name));
  group().set("kind", kind);
  group().set("title", name);
}

void Results::finish(const std::string& status, bool delivered) {
  current_.status = status;
  current_.wall_seconds = seconds();
  group().set("status", status);
  group().set("delivered", delivered ? 1 : 0);
  if (!delivered) undelivered_.push_back(current_.name + ": " + status);
  all_.set(current_);
  write();
  if (rank_ == 0) checkpoint(current_.name).remove();
  if (say_) say_("", false);
}

void Results::write() {
  all_.wall_seconds =
      earlier_run_seconds_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - started_run_).count();
  core::agree(comm_, [&] {
    if (rank_ != 0) return;
    io::write_hdf5(file("results.h5"), root_);
    all_.write(file("summary.json"));
  });
}

void Results::progress(const std::string& line) {
  if (!say_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_line_ < std::chrono::milliseconds(100)) return;
  last_line_ = now;
  say_(line, true);
}

fs::path Results::file(const std::string& name) {
  manifest_.add(name);
  return directory_ / name;
}

io::Checkpoint Results::checkpoint(const std::string& study) const {
  return io::Checkpoint(directory_ / checkpoint_name(study));
}

void Results::save_checkpoint(const io::Group& state) {
  core::agree(comm_, [&] {
    if (rank_ != 0) return;
    (void)file(checkpoint_name(current_.name));
    checkpoint(current_.name).save(state);
  });
}

bool Results::has_checkpoint() const {
  int there = rank_ == 0 && checkpoint(current_.name).exists();
  MPI_Bcast(&there, 1, MPI_INT, 0, comm_);
  return there != 0;
}

io::Group Results::load_checkpoint() const {
  io::Group state;
  core::agree(comm_, [&] { state = checkpoint(current_.name).load().state; });
  return state;
}

}  // namespace whirl::study
