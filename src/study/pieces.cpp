#include "pieces.hpp"

#include <algorithm>

#include "study/cycle/cycle_record.hpp"

namespace whirl::study {

Pieces::Pieces(Findings& findings, bool resume, bool save) : findings_(findings), saves_(save) {
  if (resume && findings_.has_checkpoint()) {
    const io::Group all = findings_.load_checkpoint();
    state_ = all.group("state");
    pieces_ = all.group("pieces");
    findings_.add_earlier_seconds(all.real("seconds"));
  }
}

const io::Group& Pieces::get(const std::string& name, const std::function<void(io::Group&)>& work) {
  if (!known(name)) {
    io::Group made;
    work(made);
    pieces_.child(name) = std::move(made);
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

solve::Stability Pieces::stability(const std::string& name, const std::function<solve::Stability()>& work) {
  return read_stability(get(name, [&](io::Group& g) { write_stability(g, work()); }));
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

bool Pieces::due() const {
  // Saving takes no more than a twentieth of the time.
  return saves_ && findings_.agreed(findings_.seconds() - last_saved_ >= std::max(0.5, 20 * cost_));
}

void Pieces::save_if_due() {
  if (due()) write();
}

void Pieces::save(io::Group state) {
  state_ = std::move(state);
  pieces_ = {};
  write();
}

void Pieces::write() {
  io::Group all;
  all.child("state") = state_;
  all.child("pieces") = pieces_;
  all.set("seconds", findings_.seconds());
  const double begin = findings_.seconds();
  findings_.save_checkpoint(all);
  last_saved_ = findings_.seconds();
  cost_ = last_saved_ - begin;
}

}  // namespace whirl::study
