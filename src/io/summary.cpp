#include "whirl/io/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

#include "io/atomic_file.hpp"
#include "io/json.hpp"
#include "whirl/core/error.hpp"

namespace whirl::io {
namespace {

constexpr std::array<const char*, 6> bifurcation_names = {"fold", "hopf",           "cyclic_fold",
                                                          "flip", "neimark_sacker", "branch_point"};

}  // namespace

void members(auto& json, Quantity& q) {
  json("value", q.value);
  json("unit", q.unit);
  json.rest(q.more);
}

void members(auto& json, Bifurcation& b) {
  json.word("type", b.type, bifurcation_names);
  json("parameter", b.parameter);
  json("value", b.value);
  json("unit", b.unit);
  json("period_s", b.period_s);
  json("uncertainty", b.uncertainty);
  json.or_null("criticality", b.criticality);
  json.if_any("criticality_by", b.criticality_by);
  json.if_any("stable_side", b.stable_side);
  json.if_any("born", b.born);
  json.if_any("sentence", b.sentence);
  json.rest(b.more);
}

void members(auto& json, CodimensionTwo& c) {
  json("type", c.type);
  json("parameter", c.parameter);
  json("value", c.value.value);
  json("unit", c.value.unit);
  json("second_parameter", c.second_parameter);
  json("second_value", c.second_value.value);
  json("second_unit", c.second_value.unit);
  json("second_value_uncertainty", c.uncertainty);
  json.rest(c.more);
}

void members(auto& json, PeakEntry& p) {
  json("place", p.place);
  const auto quantity = [&json](const char* key, Quantity& q) {
    if (json.has(key, !q.unit.empty())) json(key, q);
  };
  quantity("speed", p.speed);
  quantity("semi_major", p.semi_major);
  quantity("amplification_factor", p.amplification_factor);
  quantity("separation_margin", p.separation_margin);
  quantity("required_margin", p.required_margin);
  json.if_any("stability", p.stability);
  json.if_any("verdict", p.verdict);
  json.if_any("notes", p.notes);
}

void members(auto& json, ServiceFact& f) {
  json("what", f.what);
  json.if_any("place", f.place);
  if (json.has("value", !f.value.unit.empty())) members(json, f.value);
  json.if_any("mark", f.mark);
  json.or_null("study", f.study);
}

void members(auto& json, Service& s) {
  members(json, s.speed);
  json("facts", s.facts);
}

void members(auto& json, ModeEntry& m) {
  json("speed", m.speed);
  json("speed_unit", m.speed_unit);
  json("real", m.real);
  json("imag", m.imag);
  json("log_decrement", m.log_decrement);
  json.or_null("whirl", m.whirl);
  json.if_any("stability", m.stability);
  json.if_any("whirl_rule", m.whirl_rule);
  json.rest(m.more);
}

void members(auto& json, StabilityRange& r) {
  json("from", r.from);
  json("to", r.to);
  json("unit", r.unit);
  json("stability", r.stability);
}

void members(auto& json, Suspicion& s) {
  json("from", s.from);
  json("to", s.to);
  json("unit", s.unit);
  json("reason", s.reason);
}

// Its name is its key.
void members(auto& json, Column& c) {
  json("unit", c.unit);
  json("values", c.values);
}

void members(auto& json, StudySummary& s);

void members(auto& json, VariantSummary& v) {
  json("name", v.name);
  json("changes", v.changes);
  json("studies", v.studies);
}

void members(auto& json, SweepColumn& c) {
  json("name", c.name);
  json("unit", c.unit);
  json("values", c.values);
  json("uncertainties", c.uncertainties);
}

void members(auto& json, Trend& t) {
  json("column", t.column);
  json("quantity", t.quantity);
  json("unit", t.unit);
  json("beside", t.beside);
  json("sign", t.sign);
  json("variants", t.variants);
  json("at", t.at);
  json("difference", t.difference);
  json("uncertainty", t.uncertainty);
}

void members(auto& json, BriefColumn& c) {
  json("name", c.name);
  json("unit", c.unit);
  json("shown", c.shown);
  json("factor", c.factor);
}

void members(auto& json, BriefTable& t) {
  json("caption", t.caption);
  json("columns", t.columns);
  json("rows", t.rows);
  json.if_any("note", t.note);
}

void members(auto& json, Brief& b) {
  json("sentences", b.sentences);
  json("tables", b.tables);
  if (json.has("tells_stability", b.tells_stability)) json("tells_stability", b.tells_stability);
}

void members(auto& json, StudySummary& s) {
  json("name", s.name);
  json("kind", s.kind);
  json("status", s.status);
  json("wall_seconds", s.wall_seconds);
  json("values", s.values);
  json("bifurcations", s.bifurcations);
  json("modes", s.modes);
  json("points", s.points);
  json.if_any("layout", s.layout);
  json.if_any("ways", s.ways);
  json.if_any("stability", s.stability);
  json.if_any("ranges", s.ranges);
  json.if_any("warnings", s.warnings);
  json.if_any("peaks", s.peaks);
  json.if_any_by_name("curve", s.curve);
  json.if_any("codimension_two", s.codimension_two);
  json.if_any("suspected", s.suspected);
  json.if_any("variants", s.variants);
  json.if_any("columns", s.columns);
  json.if_any("trends", s.trends);
  if (json.has("brief", !s.brief.sentences.empty() || !s.brief.tables.empty())) json("brief", s.brief);
}

void members(auto& json, LibraryOption& o) {
  json("name", o.name);
  json("value", o.value);
  json.or_null("source", o.source);
}

void members(auto& json, Summary& s) {
  json("title", s.title);
  json("version", s.version);
  json("ranks", s.ranks);
  json("wall_seconds", s.wall_seconds);
  if (json.has("options", true)) json("options", s.options);
  json.if_any("warnings", s.warnings);
  if (json.has("service_speed", !s.service.speed.unit.empty())) json("service_speed", s.service);
  json("studies", s.studies);
}

// A number with the text that a person reads, or a word.
Json JsonWriter::value_of(const BriefCell& cell) {
  if (!cell.is_number()) return cell.text.empty() ? Json(nullptr) : Json(cell.text);
  Json out = value_of(cell.quantity);
  out["text"] = cell.text;
  return out;
}

void JsonReader::read(const Json& j, BriefCell& cell) {
  if (j.is_null()) return;
  if (j.is_string()) return read(j, cell.text);
  Json number = j;
  number.erase("text");
  read(number, cell.quantity);
  read(j.at("text"), cell.text);
}

double Quantity::bar() const {
  const auto at = more.find("uncertainty");
  return at != more.end() && std::isfinite(at->second) ? at->second : 0;
}

const char* name_of(BifurcationType type) {
  return bifurcation_names[static_cast<std::size_t>(type)];
}

void StudySummary::set(const std::string& key, double value, const std::string& unit,
                       std::map<std::string, double> more) {
  for (auto& [known, quantity] : values)
    if (known == key) {
      quantity = {value, unit, std::move(more)};
      return;
    }
  values.emplace_back(key, Quantity{value, unit, std::move(more)});
}

void Summary::set(StudySummary study) {
  for (StudySummary& s : studies)
    if (s.name == study.name) {
      s = std::move(study);
      return;
    }
  studies.push_back(std::move(study));
}

std::string Summary::to_json() const {
  // Texts come from users' decks; a byte that is not UTF-8 must not cost the results.
  return JsonWriter::value_of(*this).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void Summary::write(const std::filesystem::path& path) const {
  replace_file(path, to_json());
}

Summary Summary::from_json(const std::string& text) {
  try {
    Summary s;
    JsonReader::read(Json::parse(text), s);
    return s;
  } catch (const Json::exception& e) {
    throw core::Error(std::string("not a summary of a run: ") + e.what());
  }
}

Summary Summary::read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw core::Error("cannot read " + path.string());
  try {
    return from_json({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()});
  } catch (const core::Error& e) {
    throw core::Error("cannot read " + path.string() + ": " + e.what());
  }
}

}  // namespace whirl::io
