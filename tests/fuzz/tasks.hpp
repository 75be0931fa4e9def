#pragma once
// The smallest list of choices that a deck can have: tasks, of which there is one kind.

#include <memory>
#include <string_view>
#include <vector>

#include "whirl/deck/description.hpp"

namespace whirl::fuzz {

struct Task {
  virtual ~Task() = default;
  [[nodiscard]] virtual std::string_view kind() const = 0;
};
struct WaitOptions {
  double time = 1;
};
inline void describe(deck::Description<WaitOptions>& d) {
  d.add("time", &WaitOptions::time, "s", deck::positive, "how long to wait");
}
struct Wait : Task {
  WaitOptions options;
  [[nodiscard]] std::string_view kind() const override { return "wait"; }
};

inline const std::vector<deck::Kind<Task>>& kinds_of_tasks() {
  static const std::vector<deck::Kind<Task>> kinds{{"wait", "waits", &deck::structure_of<WaitOptions>(),
                                                    [] { return std::make_unique<Wait>(); },
                                                    [](Task& t) -> void* { return &static_cast<Wait&>(t).options; }}};
  return kinds;
}

}  // namespace whirl::fuzz
