#include "study/motion/section_record.hpp"

#include <algorithm>

#include "study/stored_vector.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

void SectionRecord::add(double time, const std::vector<system::PlaceState>& shown, std::vector<double> scaled) {
  Crossing c{time, {}, std::move(scaled)};
  for (const auto& p : shown) {
    c.shown.insert(c.shown.end(), p.position.begin(), p.position.end());
    c.shown.insert(c.shown.end(), p.velocity.begin(), p.velocity.end());
  }
  open_.push_back(std::move(c));
}

void SectionRecord::close() {
  for (Crossing& c : open_) {
    times_.push_back(c.time);
    shown_.insert(shown_.end(), c.shown.begin(), c.shown.end());
    states_.push_back(std::move(c.state));
  }
  open_.clear();
}

std::vector<std::array<double, 2>> SectionRecord::points(std::size_t place, std::size_t places) const {
  std::vector<std::array<double, 2>> out;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    const std::size_t at = 4 * (k * places + place);
    out.push_back({shown_[at], shown_[at + 1]});
  }
  return out;
}

std::array<double, 2> SectionRecord::interval(int k) const {
  const auto step = static_cast<std::size_t>(k);
  if (times_.size() <= step) return {0, 0};
  double sum = 0, low = 0, high = 0;
  for (std::size_t i = 0; i + step < times_.size(); ++i) {
    const double t = times_[i + step] - times_[i];
    low = i == 0 ? t : std::min(low, t);
    high = i == 0 ? t : std::max(high, t);
    sum += t;
  }
  return {sum / static_cast<double>(times_.size() - step), (high - low) / 2};
}

void SectionRecord::write(io::Group& group, const system::ShownPlaces& places, const std::string& text) const {
  const std::size_t n = places.names.size();
  const std::vector<std::string>& row = places.names;
  const auto wide = io::Table::wide;
  io::Table table({{"time", "s", "since the record began"},
                   wide("x", places.unit, places.text, row),
                   wide("y", places.unit, places.text, row),
                   wide("vx", places.rate_unit, "its rate", row),
                   wide("vy", places.rate_unit, "its rate", row)});
  for (std::size_t k = 0; k < times_.size(); ++k) {
    std::vector<std::vector<double>> p(4, std::vector<double>(n));
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t i = 0; i < 4; ++i) p[i][b] = shown_[4 * (k * n + b) + i];
    table.append({{times_[k]}, p[0], p[1], p[2], p[3]});
  }
  auto& g = group.child("section");
  table.write(g);
  g.set("plane", text);
}

void SectionRecord::save(io::Group& group, bool shared, Vec like) const {
  group.put("times", times_, "s", "of crossings");
  group.put("shown", shown_, "SI", "what is shown there");
  const auto rows = static_cast<Eigen::Index>(entries_here(like).size());
  Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(states_.size()));
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(states_[static_cast<std::size_t>(k)].data(), rows);
  put_columns(group, "states", columns, shared ? like : nullptr, "1", "scaled states there");
}

void SectionRecord::load(const io::Group& group, Vec like) {
  times_ = group.reals("times");
  shown_ = group.reals("shown");
  states_.clear();
  const Eigen::MatrixXd columns = take_columns(group, "states", like);
  for (const auto& column : columns.colwise()) states_.emplace_back(column.begin(), column.end());
  open_.clear();
}

}  // namespace whirl::study
