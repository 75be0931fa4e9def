// What a reader of a sweep wants to know first: which variants are stable, how the values that were asked for change,
// and these values side by side.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <regex>
#include <set>
#include <span>
#include <utility>

#include "study/brief.hpp"
#include "study/sweep/verdict_words.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {
namespace {

// A table this wide fits a line of the screen, so that each has its verdicts beside its numbers.
constexpr std::size_t widest = 96, usual_cell = 16;
constexpr std::size_t most_columns = 24, most_told = 12, most_trends = 3;

struct Shown {
  const io::SweepColumn* column;
  std::string study, value;
  std::string head, name;  ///< as words, without and with the study
  std::string unit;        ///< in which it reads best
  double factor = 1;
  [[nodiscard]] io::Quantity at(std::size_t row) const {
    io::Quantity q{column->values[row], column->unit};
    if (const double bar = column->uncertainties[row]; bar > 0) q.more["uncertainty"] = bar;
    return scaled(q, factor, unit);
  }
};

// The first of some words, and how many more there are.
std::string first_of(std::span<const std::string> words, std::size_t most, const char* between, const char* before) {
  const std::size_t shown = std::min(most, words.size());
  return fmt::format("{}{}", fmt::join(words.first(shown), between),
                     shown < words.size() ? fmt::format("{}and {} more", before, words.size() - shown) : "");
}

class SweepBrief {
public:
  SweepBrief(const io::StudySummary& s, std::span<const io::StudySummary> before) : s_(s) {
    for (const io::VariantSummary& v : s.variants)
      for (const io::StudySummary& study : v.studies) studies_.insert(study.name);
    // The columns begin with the deck as given if the sweep counts it.
    const std::size_t rows = s.columns.empty() ? s.variants.size() : s.columns.front().values.size();
    if (rows > s.variants.size()) {
      names_.emplace_back("as given");
      std::vector<io::StudySummary> own;
      std::ranges::copy_if(before, std::back_inserter(own), [&](const auto& b) { return studies_.contains(b.name); });
      verdicts_.push_back(verdict_of(own));
      rows_.push_back(std::move(own));
    }
    for (const io::VariantSummary& v : s.variants) {
      names_.push_back(v.name);
      verdicts_.push_back(verdict_of(v.studies));
      rows_.push_back(v.studies);
    }
    for (digits_ = 4; digits_ < 12 && !distinct(); ++digits_) {
    }
    for (std::string& name : shown_names_ = names_) name = short_name(name);
    choose();
  }

  [[nodiscard]] io::Brief brief() const {
    io::Brief out{{counted(), stable(), undone()}, {}};
    for (const io::Trend& t : s_.trends)
      if (const Shown* c = shown(t.column); c && out.sentences.size() < 3 + most_trends)
        if (const auto ends = ends_of(t, *c); ends && (t.sign == "+" || t.sign == "-"))
          out.sentences.push_back(fmt::format("{} {} from {} to {}", c->name, course(t.sign), io::reading(ends->first),
                                              io::reading(ends->second)));
    out.tables = variants();
    out.tables.push_back(trends());
    for (io::BriefTable& t : modes()) out.tables.push_back(std::move(t));
    return out;
  }

private:
  [[nodiscard]] std::string short_name(const std::string& name) const { return with_digits(name, digits_); }
  // Whether no two rows have the same short name.
  [[nodiscard]] bool distinct() const {
    std::set<std::string> all;
    return std::ranges::all_of(names_, [&](const std::string& name) { return all.insert(short_name(name)).second; });
  }
  // Names of studies may have dots.
  [[nodiscard]] std::string study_of(const std::string& column) const {
    std::string found = column.substr(0, column.find('.'));
    for (const std::string& name : studies_)
      if (column.starts_with(name + ".") && name.size() > found.size()) found = name;
    return found;
  }

  // A speed in the unit of the study's range, a frequency in Hz.
  void choose_unit(Shown& c) const {
    c.unit = c.column->unit;
    if (c.unit != "rad/s") return;
    constexpr double hertz = 1 / (2 * std::numbers::pi);
    if (c.value.ends_with("frequency")) {
      c.unit = "Hz";
      c.factor = hertz;
      return;
    }
    for (const io::SweepColumn& o : s_.columns)
      if ((o.unit == "rpm" || o.unit == "Hz") && study_of(o.name) == c.study) {
        c.unit = o.unit;
        c.factor = o.unit == "Hz" ? hertz : 60 * hertz;
        return;
      }
  }

  [[nodiscard]] Shown shown_of(const io::SweepColumn& column) const {
    Shown c{&column, study_of(column.name), {}, {}, {}, {}};
    c.value = column.name.substr(std::min(column.name.size(), c.study.size() + 1));
    // Of modes at one speed, which is that of every row.
    static const std::regex at_speed(R"(^at\.[0-9.e+-]+\.(?=first_forward\.))");
    c.head = in_short(speeds_of(c.study) > 1 ? c.value : std::regex_replace(c.value, at_speed, ""), speed_unit_of(c));
    c.head = node_of(c) + c.head;
    c.name = studies_.size() > 1 ? c.study + ": " + c.head : c.head;
    choose_unit(c);
    return c;
  }

  // Of the names `speed.2000.VALUE` of a study of one film.
  [[nodiscard]] std::string speed_unit_of(const Shown& c) const {
    const auto speed = std::ranges::find_if(s_.columns, [&](const io::SweepColumn& o) {
      return o.name.starts_with(c.study + ".speed.") && o.name.ends_with(".speed");
    });
    return speed == s_.columns.end() ? "" : speed->unit;
  }

  // "node 67 ": the place of a peak of a response that has the same one in every row.
  [[nodiscard]] std::string node_of(const Shown& c) const {
    if (!c.value.starts_with("peak.")) return {};
    const std::string name = c.study + "." + c.value.substr(0, c.value.rfind('.')) + ".node";
    const auto node = std::ranges::find(s_.columns, name, &io::SweepColumn::name);
    if (node == s_.columns.end()) return {};
    std::set<double> places;
    std::ranges::copy_if(node->values, std::inserter(places, places.end()), [](double x) { return std::isfinite(x); });
    return places.size() == 1 ? fmt::format("node {:.0f} ", *places.begin()) : "";
  }

  // A bifurcation that is the threshold of every row stands once.
  [[nodiscard]] bool is_threshold(const Shown& c) const {
    if (c.value == "threshold") return false;
    for (const Shown& t : chosen_) {
      if (t.value != "threshold" || t.study != c.study) continue;
      bool same = true;
      for (std::size_t i = 0; i < names_.size(); ++i) {
        const double a = t.at(i).value, b = c.at(i).value;
        same = same && std::abs(a - b) <= 1e-9 * std::abs(a);
      }
      if (same) return true;
    }
    return false;
  }

  // At how many speeds of its list a study has the first forward mode.
  [[nodiscard]] std::ptrdiff_t speeds_of(const std::string& study) const {
    return std::ranges::count_if(s_.columns, [&](const io::SweepColumn& c) {
      return c.name.starts_with(study + ".at.") && c.name.ends_with(".first_forward.frequency");
    });
  }

  void choose() {
    const auto known = [](const io::SweepColumn& c) {
      return std::ranges::any_of(c.values, [](double x) { return !std::isnan(x); });
    };
    std::vector<Shown> rest, other;
    for (const io::SweepColumn& column : s_.columns) {
      if (!known(column)) continue;
      Shown c = shown_of(column);
      (c.value == "threshold" ? chosen_ : answers(c.value) ? rest : other).push_back(std::move(c));
    }
    for (Shown& c : rest)
      if (!is_threshold(c)) chosen_.push_back(std::move(c));
    if (chosen_.empty()) chosen_ = std::move(other);
    // Study by study, in the order in which they are met.
    std::vector<std::string> order;
    for (const Shown& c : chosen_)
      if (std::ranges::find(order, c.study) == order.end()) order.push_back(c.study);
    std::ranges::stable_sort(chosen_, {}, [&](const Shown& c) { return std::ranges::find(order, c.study); });
    left_out_ = chosen_.size() > most_columns ? chosen_.size() - most_columns : 0;
    chosen_.resize(chosen_.size() - left_out_);
  }

  [[nodiscard]] const Shown* shown(const std::string& column) const {
    const auto at = std::ranges::find_if(chosen_, [&](const Shown& c) { return c.column->name == column; });
    return at == chosen_.end() ? nullptr : &*at;
  }

  static const char* course(const std::string& sign) {
    return sign == "+"              ? "rises"
           : sign == "-"            ? "falls"
           : sign == "0"            ? "does not change"
           : sign == "mixed"        ? "rises and falls"
           : sign == "undetermined" ? "not known: the bars contain zero"
           : sign == "no bar"       ? "not known: no bar"
                                    : "not comparable";
  }
  static std::string words_of(const std::string& quantity, const std::string& sweep) {
    if (quantity == "at") return sweep;
    std::string words = quantity.substr(quantity.rfind('.') + 1);
    std::ranges::replace(words, '_', ' ');
    return words;
  }

  [[nodiscard]] std::optional<std::pair<io::Quantity, io::Quantity>> ends_of(const io::Trend& t, const Shown& c) const {
    const auto at = [&](const std::string& name) {
      return static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
    };
    const std::size_t a = at(t.variants.front()), b = at(t.variants.back());
    if (t.difference.empty() || a >= names_.size() || b >= names_.size()) return std::nullopt;
    const std::pair ends{c.at(a), c.at(b)};
    return std::isfinite(ends.first.value) && std::isfinite(ends.second.value) ? std::optional(ends) : std::nullopt;
  }

  [[nodiscard]] std::string counted() const {
    std::vector<std::string> over;
    for (const io::Trend& t : s_.trends)
      if (const std::string words = words_of(t.quantity, s_.name); std::ranges::find(over, words) == over.end())
        over.push_back(words);
    if (over.empty()) return {};
    return fmt::format("{} variant{} over {}", s_.variants.size(), s_.variants.size() == 1 ? "" : "s",
                       fmt::join(over, ", "));
  }

  [[nodiscard]] std::string stable() const {
    std::vector<std::string> unstable;
    bool all = !verdicts_.empty();
    for (std::size_t i = 0; i < verdicts_.size(); ++i) {
      all = all && verdicts_[i].found == StabilityWord::stable;
      if (verdicts_[i].found >= StabilityWord::in_part) unstable.push_back(shown_names_[i]);
    }
    if (unstable.empty()) return all ? "all are stable where their studies looked" : "";
    return "unstable, at least in part: " + first_of(unstable, 6, ", ", " ");
  }

  // "x0.8: balanced: ended at 7000 rpm: contact".
  [[nodiscard]] std::string undone() const {
    std::vector<std::string> words;
    for (const io::VariantSummary& v : s_.variants)
      for (const io::StudySummary& study : v.studies)
        if (study.status != "completed")
          words.push_back(fmt::format("{}, {}: {}", short_name(v.name), study.name, study.status));
    return words.empty() ? "" : "not completed: " + first_of(words, 3, "; ", "; ");
  }

  // Below the numbers: what is not stable, in words.
  [[nodiscard]] std::string note() const {
    std::vector<std::string> told;
    bool marked = false;
    for (std::size_t i = 0; i < verdicts_.size(); ++i) {
      if (verdicts_[i].found <= StabilityWord::undamped) continue;
      marked = true;
      if (verdicts_[i].words != "unstable" && verdicts_[i].words != name_of(verdicts_[i].found))
        told.push_back(shown_names_[i] + ": " + verdicts_[i].words);
    }
    std::vector<std::string> text;
    const bool peaks =
        std::ranges::any_of(chosen_, [](const Shown& c) { return c.value.find("peak.") != std::string::npos; });
    if (marked && peaks)
      text.emplace_back("About an unstable equilibrium peaks, margins and factors describe no real motion");
    if (!told.empty()) text.push_back(first_of(told, most_told, "; ", "; "));
    if (left_out_ > 0) text.push_back(fmt::format("{} more values stand in the table of all values", left_out_));
    return fmt::format("{}", fmt::join(text, "; "));
  }

  // What the study itself says of a row. A single study that says nothing has the word of the row.
  [[nodiscard]] std::string verdict(std::size_t row, const std::string& study) const {
    StabilityWord found = studies_.size() > 1 ? StabilityWord::nothing : verdicts_[row].found;
    const auto at = std::ranges::find(rows_[row], study, &io::StudySummary::name);
    if (at != rows_[row].end())
      if (const StabilityWord own = verdict_of(*at).found; own != StabilityWord::nothing) found = own;
    return found == StabilityWord::nothing ? "" : name_of(found);
  }

  [[nodiscard]] std::vector<io::BriefTable> variants() const {
    std::size_t first = 7;
    for (const std::string& name : shown_names_) first = std::max(first, name.size());
    std::vector<io::BriefTable> out;
    std::size_t width = widest;
    std::string study;
    for (const Shown& c : chosen_) {
      const std::size_t own = 2 + std::max(usual_cell, c.head.size() + (c.unit == "1" ? 0 : c.unit.size() + 3));
      if (c.study != study || width + own > widest) {
        auto& t = out.emplace_back();
        t.caption =
            "Variants" + (studies_.size() > 1 ? ": " + c.study : "") + (c.study == study ? ", further values" : "");
        study = c.study;
        t.columns = {{"variant"}, {"verdict"}};
        for (std::size_t i = 0; i < names_.size(); ++i) t.rows.push_back({shown_names_[i], verdict(i, c.study)});
        width = 4 + first + 2 + usual_cell;
      }
      width += own;
      out.back().columns.push_back({c.head, c.unit});
      for (std::size_t i = 0; i < names_.size(); ++i) out.back().rows[i].emplace_back(c.at(i));
    }
    if (!out.empty()) out.front().note = note();
    return out;
  }

  [[nodiscard]] io::BriefTable trends() const {
    io::BriefTable t{
        "Trends",
        {{"value"}, {"over"}, {"from"}, {"to"}, {"course"}, {"change"}},
        {},
        "change: from the first variant to the last; it rises or falls where no bar of a difference between "
        "neighbours contains zero"};
    for (const io::Trend& trend : s_.trends) {
      const Shown* c = shown(trend.column);
      if (!c || trend.difference.empty()) continue;
      auto& row = t.rows.emplace_back();
      row.emplace_back(c->name);
      row.emplace_back(words_of(trend.quantity, s_.name) +
                       (trend.beside.empty() ? "" : "; " + short_name(trend.beside)));
      row.emplace_back(io::reading({trend.at.front(), trend.unit}));
      row.emplace_back(io::reading({trend.at.back(), trend.unit}));
      row.emplace_back(course(trend.sign));
      const auto ends = ends_of(trend, *c);
      io::Quantity change;
      if (ends) change = {ends->second.value - ends->first.value, c->unit};
      if (ends && ends->first.bar() > 0 && ends->second.bar() > 0)
        change.more["uncertainty"] = ends->first.bar() + ends->second.bar();
      row.emplace_back(change);
    }
    return t;
  }

  // Of modes at one speed the frequencies side by side, where a line has the room.
  [[nodiscard]] std::vector<io::BriefTable> modes() const {
    constexpr std::size_t most_rows = 6, most_modes = 10;
    std::vector<io::BriefTable> out;
    if (names_.size() > most_rows) return out;
    for (const std::string& study : studies_) {
      io::BriefTable t{fmt::format("{}: frequencies of the modes", study), {{"place"}}, {}, "by rising frequency"};
      const auto reduced = [](const io::StudySummary& s) {
        return std::ranges::any_of(s.values, [](const auto& v) { return v.first == "reduction.largest_error"; });
      };
      if (std::ranges::any_of(rows_, [&](const auto& row) { return std::ranges::any_of(row, reduced); }))
        t.note += "; the bars leave out the reduction of the shaft";
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        t.columns.push_back({shown_names_[i], "Hz"});
        const auto at = std::ranges::find(rows_[i], study, &io::StudySummary::name);
        if (at == rows_[i].end() || at->kind != "modes") continue;
        const auto& modes = at->modes;
        if (modes.empty() || modes.front().speed != modes.back().speed) continue;
        for (std::size_t k = 0; k < std::min(most_modes, modes.size()); ++k) {
          if (t.rows.size() <= k) t.rows.push_back({std::to_string(k + 1)});
          t.rows[k].resize(i + 1);
          io::Quantity f{modes[k].imag, "rad/s"};
          if (const auto bar = modes[k].more.find("imag_uncertainty"); bar != modes[k].more.end())
            f.more["uncertainty"] = bar->second;
          t.rows[k].emplace_back(scaled(f, 1 / (2 * std::numbers::pi), "Hz"));
        }
      }
      for (auto& row : t.rows) row.resize(t.columns.size());
      if (!t.rows.empty()) out.push_back(std::move(t));
    }
    return out;
  }

  const io::StudySummary& s_;
  std::set<std::string> studies_;
  std::vector<std::string> names_, shown_names_;  // of the rows, as stored and as short as they differ
  int digits_ = 4;
  std::vector<VariantVerdict> verdicts_;
  std::vector<std::vector<io::StudySummary>> rows_;
  std::vector<Shown> chosen_;
  std::size_t left_out_ = 0;
};

}  // namespace

io::Brief Sweep::brief(const StudyResult& result, std::span<const io::StudySummary> before) const {
  if (result.summary.variants.empty()) return {};
  return SweepBrief(result.summary, before).brief();
}

}  // namespace whirl::study
