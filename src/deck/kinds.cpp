// Structs that hold one of several kinds, chosen by an option that stands beside those of the kind.
#include <algorithm>

#include "known.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/output.hpp"

namespace whirl::deck {
namespace {

using Member = std::function<void*(void*)>;

// An option with its place in every kind, empty in those that do not have it.
struct Shared {
  Option option;
  std::vector<Member> in;
};

// True if one option can stand for both: the same line of the same type with the same default.
bool same_line(const Option& a, const Option& b) {
  const auto* x = a.codec->spec();
  const auto* y = b.codec->spec();
  const auto words = [](const Option& o) {
    std::vector<std::pair<std::string, double>> all;
    for (const Alias& w : o.aliases) all.emplace_back(w.key, w.factor);
    return all;
  };
  return a.key == b.key && *a.value == *b.value && a.text == b.text && a.source == b.source &&
         a.codec->type() == b.codec->type() && (x ? x->unit + x->letter : "") == (y ? y->unit + y->letter : "") &&
         a.required == b.required && a.continuable == b.continuable && words(a) == words(b) &&
         to_line(a.codec->write(a.preset)) == to_line(b.codec->write(b.preset));
}

// The options of all kinds, each kind's in its own order: what only one has stands before what it shares with others.
std::vector<Shared> shared_options(const std::vector<ChoiceKind>& kinds) {
  std::vector<Shared> all;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::vector<Option>& options = kinds[k].options->options;
    auto behind = static_cast<std::ptrdiff_t>(all.size());  // where the options stand that come later
    for (auto o = options.rbegin(); o != options.rend(); ++o) {
      core::require(o->selector.empty(),
                    "an option of a kind that depends on another choice stands in a struct below it");
      const auto end = all.begin() + behind;
      auto at = std::find_if(all.begin(), end, [&](const Shared& s) { return same_line(s.option, *o); });
      if (at == end) at = all.insert(end, {*o, std::vector<Member>(kinds.size())});
      at->in[k] = o->member;
      at->option.selected.push_back(kinds[k].name);
      behind = at - all.begin();
    }
  }
  return all;
}

}  // namespace

void add_kinds(Structure& s, Option chooser, const std::vector<ChoiceKind>& kinds, const KindAccess& access) {
  std::vector<Choice> choices;
  for (const ChoiceKind& k : kinds) choices.push_back({k.name, k.text});
  chooser.codec = choice_codec(std::move(choices), access.kind, access.hold);
  chooser.member = access.holder;
  chooser.preset = access.holder(s.defaults.get());
  const std::string selector = chooser.key;
  s.options.push_back(std::move(chooser));

  for (Shared& shared : shared_options(kinds)) {
    Option& o = shared.option;
    o.selector = selector;
    o.member = [access, in = std::move(shared.in)](void* whole) -> void* {
      void* holder = access.holder(whole);
      const Member& member = in[access.kind(holder)];
      return member ? member(access.value(holder)) : nullptr;
    };
    if (const void* own = o.member(s.defaults.get())) o.preset = own;
    s.options.push_back(std::move(o));
  }
  for (std::size_t k = 0; k < kinds.size(); ++k)
    for (const Structure::Checker& c : kinds[k].options->checks)
      s.checks.push_back([access, k, c](const void* whole, const Report& r) {
        void* holder = access.holder(const_cast<void*>(whole));
        if (access.kind(holder) == k) c(access.value(holder), r);
      });
}

}  // namespace whirl::deck
