#include "located.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "study/cycle/cycle_record.hpp"

namespace whirl::study {

bool is_followed(const Context& context, const std::string& name) {
  return std::any_of(context.studies.begin(), context.studies.end(),
                     [&](const auto& s) { return s->starts_from() == name; });
}

void write_located(io::Group& group, const std::vector<Located>& all, const SharedRows& like) {
  group.set("count", static_cast<int>(all.size()));
  group.set("restart", 1);
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& g = group.child(fmt::format("{}", k + 1));
    g.set("event", static_cast<int>(all[k].event));
    g.set("real", all[k].critical.real());
    g.set("imag", all[k].critical.imag());
    g.set("sensitivity", all[k].sensitivity);
    write_cycle(g.child("cycle"), all[k].cycle, like);
  }
}

std::vector<Located> read_located(const io::Group& group, const SharedRows& like) {
  std::vector<Located> all;
  for (std::int64_t k = 1; k <= group.integer("count"); ++k) {
    const auto& g = group.group(fmt::format("{}", k));
    all.push_back({static_cast<solve::Event>(g.integer("event")),
                   {g.real("real"), g.real("imag")},
                   read_cycle(g.group("cycle"), like),
                   g.real("sensitivity")});
  }
  return all;
}

}  // namespace whirl::study
