#include "pieces.hpp"

#include <utility>

#include "study/cycle/cycle_record.hpp"
#include "whirl/core/error.hpp"
#include "whirl/study/stop.hpp"

namespace whirl::study {

// Vectors by rows are datasets of their own.
void members(auto& archive, solve::ReplayLog::Rows& v) {
  archive(v.whole);
  if (v.whole) archive(v.values);
}
void members(auto& archive, solve::ReplayLog::Entry& e) {
  archive(e.kind, e.question, e.state, e.answer.numbers, e.answer.text, e.answer.vectors);
}

namespace {

constexpr double least_seconds = 0.5;  // between two files

constexpr int format = 7;

std::string name_of_rows(std::size_t k) {
  return "vector " + std::to_string(k);
}

void write_log(io::Group& group, const solve::ReplayLog& replay_log) {
  put_packed(group, "entries", replay_log.entries(), "questions and answers");
  std::size_t by_rows = 0;
  for (const auto& e : replay_log.entries())
    for (const solve::ReplayLog::Rows& v : e.answer.vectors)
      if (!v.whole)
        group.put(name_of_rows(++by_rows),
                  io::Dataset{{v.values.size()}, v.values, "1", "of an answer", io::RowRange{v.begin, v.total}});
}

std::vector<solve::ReplayLog::Entry> read_log(const io::Group& group) {
  auto entries = take_packed<std::vector<solve::ReplayLog::Entry>>(group, "entries");
  std::size_t by_rows = 0;
  for (auto& e : entries)
    for (solve::ReplayLog::Rows& v : e.answer.vectors) {
      v.total = v.values.size();
      if (v.whole) continue;
      const io::Dataset& data = group.dataset(name_of_rows(++by_rows));
      const auto& rows = std::get<std::vector<double>>(data.values);
      const io::RowRange share = data.share.value_or(io::RowRange{0, rows.size()});
      v = {!data.share, share.begin, share.total, rows};
    }
  return entries;
}

}  // namespace

Pieces::Pieces(Findings& findings, bool resume, bool save, int layout)
    : findings_(findings), saves_(save), layout_(layout) {
  replay_log_.due = [this] { return due(); };
  replay_log_.changed = [this] { save_if_due(); };
  if (resume && findings_.has_checkpoint()) {
    const io::Group all = findings_.load_checkpoint();
    if (!all.has_attribute("format") || all.integer("format") != format)
      throw core::InputError("the checkpoint is that of another version of the program: begin again with --force");
    state_ = all.group("state");
    pieces_ = all.group("pieces");
    same_layout_ = all.has_attribute("layout") && all.integer("layout") == layout_;
    if (same_layout_) replay_log_.begin(read_log(all.group("replay_log")));
    findings_.add_earlier_seconds(all.real("seconds"));
  }
}

const io::Group& Pieces::get(const std::string& name, const std::function<void(io::Group&)>& work) {
  if (!known(name)) {
    const std::size_t place = replay_log_.place();
    io::Group made;
    work(made);
    pieces_.child(name) = std::move(made);
    replay_log_.forget_from(place);
    save_if_due();
  }
  return pieces_.group(name);
}

void Pieces::keep(const std::string& name, const std::vector<double>& values) {
  pieces_.child(name).put("values", values, "1", "of a piece of work");
}

std::vector<double> Pieces::numbers(const std::string& name, const std::function<std::vector<double>()>& work) {
  return get(name, [&](io::Group& g) { g.put("values", work(), "1", "of a piece of work"); }).reals("values");
}

double Pieces::number(const std::string& name, const std::function<double()>& work) {
  return numbers(name, [&] { return std::vector<double>{work()}; }).front();
}

void Pieces::complete(const std::string& name, io::Bifurcation& b, const std::function<void()>& work) {
  const io::Group& kept = get(name, [&](io::Group& g) {
    work();
    io::StudySummary one;
    one.bifurcations = {b};
    write_summary(g, one);
  });
  io::StudySummary one;
  read_summary(kept, one);
  b = one.bifurcations.front();
}

double Pieces::between() const {
  return std::max(least_seconds, 25 * cost());
}

// Saving takes no more than a twentieth of the time. States come first, or work between them would leave them no time;
// but not before all is repeated that is known of the work behind them.
bool Pieces::due() const {
  return saves_ && findings_.agreed(saves_at_once() || findings_.seconds() - last_saved_ >= between());
}

bool Pieces::state_due() const {
  const double now = findings_.seconds();
  return saves_ && !replay_log_.repeats() &&
         findings_.agreed(saves_at_once() || (now - last_state_ >= least_seconds && now - last_saved_ >= 20 * cost()));
}

void Pieces::save_if_due() {
  if (due()) write();
}

void Pieces::save(io::Group state) {
  state_ = std::move(state);
  pieces_ = {};
  replay_log_.begin();
  write();
  last_state_ = last_saved_;
}

void Pieces::write() {
  const double begin = findings_.seconds();
  io::Group all;
  all.child("state") = state_;
  all.child("pieces") = pieces_;
  write_log(all.child("replay_log"), replay_log_);
  all.set("format", format);
  all.set("layout", layout_);
  all.set("seconds", findings_.seconds());
  all.set("seconds_between_files", between());
  findings_.save_checkpoint(all);
  last_saved_ = findings_.seconds();
  costs_ = {last_saved_ - begin, costs_[0]};
}

}  // namespace whirl::study
