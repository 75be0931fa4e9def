#include "whirl/study/sweep/sweep.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>

#include "study/findings.hpp"
#include "study/job_queue.hpp"
#include "study/run_studies.hpp"
#include "study/sweep/sweep_table.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/checkpoint.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/stop.hpp"

namespace whirl::study {
namespace {

namespace fs = std::filesystem;

// Results of the studies of one variant, kept in its checkpoint as soon as a study is finished.
class VariantStore final : public Store {
public:
  VariantStore(MPI_Comm comm, fs::path path, fs::path running)
      : comm_(comm), path_(std::move(path)), running_path_(std::move(running)) {
    root_.child("studies");
  }

  void restore() {
    core::agree(comm_, [&] {
      const io::Checkpoint saved(path_);
      if (!saved.exists()) return;
      io::Checkpoint::Loaded loaded = saved.load();
      set(std::move(loaded.state));
      // Others read the newest file.
      if (loaded.from_previous && core::rank_of(comm_) == 0) io::Checkpoint(path_).save(state());
    });
  }
  // Leaves the results in the checkpoint, which has them, but for what says how each study ended.
  void leave() {
    for (const auto& [name, group] : studies().groups()) {
      io::Group& kept = root_.child("studies").child(name);
      io::Group brief;
      brief.set("delivered", kept.integer("delivered"));
      kept = std::move(brief);
    }
  }
  // All that there is, and back.
  [[nodiscard]] io::Group state() const {
    io::Group s = root_;
    io::Summary text;
    text.studies = summaries_;
    s.put("summary", std::vector<std::string>{text.to_json()}, "of the studies");
    s.set("running", running_);
    return s;
  }
  void set(io::Group state) {
    summaries_ = io::Summary::from_json(state.strings("summary").front()).studies;
    running_ = state.text("running");
    root_ = {};
    root_.child("studies") = std::move(state.child("studies"));
  }

  [[nodiscard]] bool finished(const std::string& name) const override {
    // What delivered nothing is tried again.
    return studies().has_group(io::safe_name(name)) && studies().group(io::safe_name(name)).integer("delivered") != 0;
  }
  // One study after another uses the same file; what it holds of another study than the one that begins is stale.
  [[nodiscard]] fs::path checkpoint_path(const std::string& study) override {
    core::agree(comm_, [&] {
      if (study == running_) return;
      running_ = study;
      if (core::rank_of(comm_) != 0) return;
      io::Checkpoint(running_path_).remove();
      io::Checkpoint(path_).save(state());
    });
    return running_path_;
  }
  void add(StudyResult result) override {
    const std::string name = result.summary.name;
    running_.clear();
    // Others than those who share the machine want it.
    io::make_whole(result.group, comm_);
    root_.child("studies").child(io::safe_name(name)) = std::move(result.group);
    std::erase_if(summaries_, [&](const auto& s) { return s.name == name; });
    summaries_.push_back(std::move(result.summary));
    core::agree(comm_, [&] {
      if (core::rank_of(comm_) != 0) return;
      io::Checkpoint(path_).save(state());
      io::Checkpoint(running_path_).remove();
    });
    checkpoint_written();
  }
  [[nodiscard]] const io::Group& studies() const override { return root_.group("studies"); }
  [[nodiscard]] std::span<const io::StudySummary> summaries() const override { return summaries_; }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] const fs::path& running_path() const { return running_path_; }

private:
  MPI_Comm comm_;
  fs::path path_, running_path_;
  std::string running_;  // the study that has begun
  io::Group root_;
  std::vector<io::StudySummary> summaries_;
};

}  // namespace

// The numbers of a variant do not depend on who computes it: groups of ranks take the next one as soon as they are
// free.
StudyResult Sweep::run(Context& context) {
  const std::size_t n = variants_.size();
  auto& results = context.results;
  JobQueue queue(context.comm, options.ranks, n);
  std::vector<std::unique_ptr<VariantStore>> stores;
  for (std::size_t k = 0; k < n; ++k)
    stores.push_back(std::make_unique<VariantStore>(queue.group(),
                                                    context.checkpoint_of(fmt::format("variant {}", k + 1)),
                                                    context.checkpoint_of(fmt::format("variant {} running", k + 1))));
  std::vector<int> mine(n, -1), owner(n, -1);
  std::exception_ptr caught;
  try {
    queue.run([&](std::size_t k) {
      const Variant& v = variants_[k];
      const Say say = [&](const std::string& line, bool transient) {
        if (!line.empty())
          results.say(fmt::format("{}: variant {} of {}, '{}': {}", results.summary().name, k + 1, n, v.name, line),
                      transient);
      };
      if (context.resume) stores[k]->restore();
      run_studies(queue.group(), *v.deck, results.shows_progress() ? say : Say(), context.resume, *stores[k]);
      stores[k]->leave();
      mine[k] = core::rank_of(context.comm);
    });
  } catch (...) {
    caught = std::current_exception();
    // One rank of several that share a variant: the others wait for it inside their work.
    if (core::size_of(queue.group()) > 1 && !core::is_agreed(caught)) throw;
  }
  core::agree(context.comm, [&] {
    if (caught) std::rethrow_exception(caught);
  });
  MPI_Allreduce(mine.data(), owner.data(), static_cast<int>(n), MPI_INT, MPI_MAX, context.comm);
  for (std::size_t k = 0; k < n; ++k) {
    const std::string bytes = from_owner(context.comm, owner[k], [&] { return io::to_bytes(stores[k]->state()); });
    core::agree(context.comm, [&] {
      if (mine[k] != owner[k]) stores[k]->set(io::from_bytes(bytes));
    });
    results.leave_behind(stores[k]->path());
    results.leave_behind(stores[k]->running_path());
  }

  std::vector<SweepRow> rows;
  std::size_t failed = 0, asked = 0;
  const std::vector<std::string> given = unusual(context.machine, context.layout.bars);
  if (options.as_given) {
    SweepRow row{"as given", {}, {}, given};
    for (const auto& s : context.summaries)
      if (s.kind != key && std::any_of(variants_.front().deck->studies.begin(), variants_.front().deck->studies.end(),
                                       [&](const auto& one) { return s.name == one->name(); }))
        row.studies.push_back(s);
    rows.push_back(std::move(row));
  }
  auto& folder = results.group().child("variants");
  for (std::size_t k = 0; k < n; ++k) {
    const auto summaries = stores[k]->summaries();
    rows.push_back({variants_[k].name,
                    variants_[k].coordinates,
                    {summaries.begin(), summaries.end()},
                    unusual(variants_[k].deck->machine, variants_[k].deck->bars)});
    io::Group& group = folder.child(io::safe_name(variants_[k].name));
    io::leave_in_file(group, stores[k]->path(), "state/studies");
    group.set("title", variants_[k].name);
    group.set("order", static_cast<int>(k + 1));
    for (const auto& [path, value] : variants_[k].changes) group.set("set " + path, value);
    for (const auto& s : summaries) {
      ++asked;
      failed += stores[k]->studies().group(io::safe_name(s.name)).integer("delivered") == 0;
    }
    results.summary().variants.push_back(
        {variants_[k].name, variants_[k].changes, {summaries.begin(), summaries.end()}});
  }
  put_table(results, rows, given);
  results.summary().points = static_cast<long>(n);
  return results.finish(failed == 0 ? "completed" : fmt::format("{} of {} studies delivered nothing", failed, asked),
                        failed < asked);
}

}  // namespace whirl::study
