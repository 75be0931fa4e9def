#include "study/bars/table_bars.hpp"

#include <fmt/core.h>

#include <utility>

namespace whirl::study {

TableBars::TableBars(io::Group& table, std::vector<std::string> names, const MeshLaw& law)
    : table_(table), names_(std::move(names)) {
  for (const std::string& name : names_) bars_.emplace_back(table_.reals(name), law);
}

void TableBars::add(Axis axis, double spacing, const io::Group& there) {
  any_ = true;
  for (std::size_t k = 0; k < names_.size(); ++k)
    bars_[k].add(axis, spacing, there.has_dataset(names_[k]) ? there.reals(names_[k]) : std::vector<double>());
}

void TableBars::write() {
  for (std::size_t k = 0; k < names_.size() && any_; ++k) {
    io::Dataset data = table_.dataset(names_[k]);
    auto& errors = std::get<std::vector<double>>(data.values);
    for (std::size_t i = 0; i < errors.size(); ++i) errors[i] = bars_[k][i].total();
    data.description = fmt::format("estimated error of {} from the film mesh", names_[k]);
    table_.put(names_[k] + "_uncertainty", std::move(data));
  }
}

}  // namespace whirl::study
