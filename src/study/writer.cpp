#include "writer.hpp"

#include <algorithm>

#include "service.hpp"
#include "study/columns.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/session.hpp"
#include "whirl/io/checkpoint.hpp"
#include "whirl/io/csv.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::study {

namespace fs = std::filesystem;

namespace {

// Those of this run in the file; an earlier one may have had others.
void put_options(io::Group& root, const std::vector<io::LibraryOption>& options) {
  root.erase_group("options");
  if (options.empty()) return;
  using O = io::LibraryOption;
  auto& group = root.child("options");
  group.put("name", column(options, &O::name), "options of PETSc and SLEPc in force");
  group.put("value", column(options, &O::value), "their values; empty: a flag");
  group.put("source", column(options, &O::source), "where they came from; empty: not known");
}

}  // namespace

Writer::Writer(MPI_Comm comm, const Deck& deck, const RunOptions& options)
    : comm_(comm),
      rank_(core::rank_of(comm)),
      directory_(options.directory),
      manifest_(directory_),
      started_(std::chrono::steady_clock::now()),
      ended_(options.ended),
      service_speed_(deck.machine.service_speed),
      films_(std::ranges::any_of(deck.machine.bearings, [](const auto& b) { return b.geometry.has_value(); })) {
  core::agree(comm_, [&] {
    // Every rank reads the same files, of arrays that were shared its rows. They are written together.
    if (!options.resume || !fs::exists(directory_ / "summary.json")) return;
    all_ = io::Summary::read(directory_ / "summary.json");
    earlier_seconds_ = all_.wall_seconds;
    if (fs::exists(directory_ / "results.h5")) root_ = io::read_hdf5(directory_ / "results.h5", comm_, "variants");
    auto& studies = root_.child("studies");
    for (const auto& s : all_.studies) {
      // What delivered nothing is tried again.
      const std::string name = io::safe_name(s.name);
      const bool known = studies.has_group(name) && studies.group(name).has_attribute("delivered");
      if (!known || studies.group(name).integer("delivered") == 0) continue;
      finished_.push_back(s.name);
      // A run killed right after it finished the study leaves this behind.
      if (rank_ == 0) io::Checkpoint(directory_ / (name + io::Checkpoint::ending)).remove();
    }
  });
  io::describe_results(root_, deck.machine.title, options.version);
  root_.child("studies");
  all_.title = deck.machine.title;
  all_.version = options.version;
  all_.warnings = unusual(deck.machine, deck.bars);
  all_.ranks = core::size_of(comm);
  all_.options.clear();
  for (const auto& o : core::Session::options_in_force()) all_.options.push_back({o.name, o.value, o.source});
  put_options(root_, all_.options);
  for (const std::string& name : finished_) tell(name);
}

bool Writer::finished(const std::string& name) const {
  return std::find(finished_.begin(), finished_.end(), name) != finished_.end();
}

fs::path Writer::file(const std::string& name) {
  if (rank_ == 0) manifest_.add(name);
  return directory_ / name;
}

fs::path Writer::checkpoint_path(const std::string& study) {
  fs::path path;
  core::agree(comm_, [&] { path = file(io::safe_name(study) + io::Checkpoint::ending); });
  return path;
}

void Writer::add(StudyResult result) {
  const std::string name = result.summary.name, file = io::safe_name(name);
  if (!result.delivered) undelivered_.push_back(name + ": " + result.summary.status);
  root_.child("studies").child(file) = std::move(result.group);
  all_.set(std::move(result.summary));
  for (auto& grid : result.grids) {
    const std::string head = "/studies/" + file + "/";
    grid.coordinates.insert(0, head);
    for (auto& field : grid.fields) field.dataset.insert(0, head);
  }
  // The study counts as finished as soon as the files of the run are written: what belongs to it goes first.
  core::agree(comm_, [&] {
    if (rank_ != 0) return;
    // Films unwrapped lie across the machine: they are a scene of their own.
    std::vector<io::StructuredGrid>& round = result.grids;
    std::vector<io::StructuredGrid> flat;
    std::erase_if(round, [&](io::StructuredGrid& g) {
      const bool unwrapped = g.name.ends_with(io::unwrapped);
      if (unwrapped) flat.push_back(std::move(g));
      return unwrapped;
    });
    if (!round.empty()) io::write_xdmf(this->file(file + ".xdmf"), "results.h5", round);
    if (!flat.empty()) io::write_xdmf(this->file(file + ".unwrapped.xdmf"), "results.h5", flat);
    io::each_csv_table(root_.group("studies").group(file), [&](const io::CsvFile& table) {
      io::write_csv(this->file("csv/" + io::plain_name(name) + "/" + table.file), table);
    });
  });
  write();
  core::agree(comm_, [&] {
    if (rank_ != 0) return;
    io::Checkpoint(directory_ / (file + io::Checkpoint::ending)).remove();
    for (const auto& part : result.checkpoints) io::Checkpoint(part).remove();
  });
  tell(name);
}

void Writer::end() {
  core::agree(comm_, [&] {
    if (rank_ == 0) manifest_.remove_checkpoints();
  });
}

void Writer::tell(const std::string& name) const {
  if (rank_ != 0 || !ended_) return;
  for (const io::StudySummary& s : all_.studies)
    if (s.name == name) ended_(s);
}

void Writer::write() {
  all_.wall_seconds =
      earlier_seconds_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  if (service_speed_) all_.service = service_of(*service_speed_, all_.studies, studies(), films_);
  fs::path results;
  core::agree(comm_, [&] { results = file("results.h5"); });
  io::write_hdf5(results, root_, comm_);
  io::moved_to(root_, results);
  core::agree(comm_, [&] {
    if (rank_ == 0) all_.write(file("summary.json"));
  });
}

}  // namespace whirl::study
