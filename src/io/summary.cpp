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

Json to_json(const Bifurcation& b) {
  Json j = {{"type", name_of(b.type)},
            {"parameter", b.parameter},
            {"value", number(b.value)},
            {"unit", b.unit},
            {"period_s", number(b.period_s)},
            {"uncertainty", number(b.uncertainty)},
            {"criticality", text_or_null(b.criticality)}};
  if (!b.criticality_by.empty()) j["criticality_by"] = b.criticality_by;
  if (!b.stable_side.empty()) j["stable_side"] = b.stable_side;
  if (!b.born.empty()) j["born"] = b.born;
  if (!b.sentence.empty()) j["sentence"] = b.sentence;
  for (const auto& [name, value] : b.more) j[name] = number(value);
  return j;
}

Bifurcation bifurcation(const Json& j) {
  Bifurcation b;
  for (const auto& [key, v] : j.items()) {
    if (key == "type") {
      const auto it = std::find(bifurcation_names.begin(), bifurcation_names.end(), v.get<std::string>());
      if (it == bifurcation_names.end()) throw core::Error("unknown bifurcation type " + v.dump());
      b.type = static_cast<BifurcationType>(it - bifurcation_names.begin());
    } else if (key == "parameter") {
      v.get_to(b.parameter);
    } else if (key == "value") {
      b.value = number(v);
    } else if (key == "unit") {
      v.get_to(b.unit);
    } else if (key == "period_s") {
      b.period_s = number(v);
    } else if (key == "uncertainty") {
      b.uncertainty = number(v);
    } else if (key == "criticality") {
      b.criticality = v.is_null() ? "" : v.get<std::string>();
    } else if (key == "criticality_by") {
      v.get_to(b.criticality_by);
    } else if (key == "stable_side") {
      v.get_to(b.stable_side);
    } else if (key == "born") {
      v.get_to(b.born);
    } else if (key == "sentence") {
      v.get_to(b.sentence);
    } else {
      b.more[key] = number(v);
    }
  }
  return b;
}

Json to_json(const CodimensionTwo& c) {
  Json j = {{"type", c.type},
            {"parameter", c.parameter},
            {"value", number(c.value.value)},
            {"unit", c.value.unit},
            {"second_parameter", c.second_parameter},
            {"second_value", number(c.second_value.value)},
            {"second_unit", c.second_value.unit},
            {"second_value_uncertainty", number(c.uncertainty)}};
  for (const auto& [name, value] : c.more) j[name] = number(value);
  return j;
}

CodimensionTwo codimension_two(Json j) {
  const auto take = [&j](const char* key) {
    Json value = j.at(key);
    j.erase(key);
    return value;
  };
  CodimensionTwo c;
  c.type = take("type");
  c.parameter = take("parameter");
  c.value = {number(take("value")), take("unit")};
  c.second_parameter = take("second_parameter");
  c.second_value = {number(take("second_value")), take("second_unit")};
  c.uncertainty = number(take("second_value_uncertainty"));
  for (const auto& [key, v] : j.items()) c.more[key] = number(v);
  return c;
}

// The quantities of a peak, by name.
using PeakQuantity = std::pair<const char*, Quantity PeakEntry::*>;
constexpr std::array<PeakQuantity, 5> peak_quantities = {
    PeakQuantity{"speed", &PeakEntry::speed}, PeakQuantity{"semi_major", &PeakEntry::semi_major},
    PeakQuantity{"amplification_factor", &PeakEntry::amplification_factor},
    PeakQuantity{"separation_margin", &PeakEntry::separation_margin},
    PeakQuantity{"required_margin", &PeakEntry::required_margin}};

Json to_json(const PeakEntry& p) {
  Json j = {{"place", p.place}};
  for (const auto& [name, which] : peak_quantities)
    if (!(p.*which).unit.empty()) j[name] = quantity_to_json(p.*which);
  if (!p.stability.empty()) j["stability"] = p.stability;
  if (!p.verdict.empty()) j["verdict"] = p.verdict;
  if (!p.notes.empty()) j["notes"] = p.notes;
  return j;
}

PeakEntry peak(const Json& j) {
  PeakEntry p;
  p.place = j.at("place");
  for (const auto& [name, which] : peak_quantities)
    if (j.contains(name)) p.*which = quantity(j.at(name));
  p.stability = j.value("stability", std::string());
  p.verdict = j.value("verdict", std::string());
  p.notes = j.value("notes", std::vector<std::string>());
  return p;
}

Json to_json(const Service& s) {
  Json facts = Json::array();
  for (const ServiceFact& f : s.facts) {
    Json j = {{"what", f.what}};
    if (!f.place.empty()) j["place"] = f.place;
    if (!f.value.unit.empty()) j.update(quantity_to_json(f.value));
    if (!f.mark.empty()) j["mark"] = f.mark;
    j["study"] = text_or_null(f.study);
    facts.push_back(std::move(j));
  }
  Json j = quantity_to_json(s.speed);
  j["facts"] = std::move(facts);
  return j;
}

Service service(const Json& j) {
  Service s;
  s.speed = {number(j.at("value")), j.at("unit")};
  for (const Json& f : j.at("facts")) {
    ServiceFact& fact = s.facts.emplace_back();
    fact.what = f.at("what");
    fact.place = f.value("place", std::string());
    if (f.contains("value"))
      fact.value = {number(f.at("value")), f.at("unit"),
                    others(f, {"what", "place", "value", "unit", "mark", "study"})};
    fact.mark = f.value("mark", std::string());
    fact.study = f.at("study").is_null() ? "" : f.at("study").get<std::string>();
  }
  return s;
}

Json numbers(const std::vector<double>& all) {
  Json j = Json::array();
  for (const double x : all) j.push_back(number(x));
  return j;
}

std::vector<double> numbers(const Json& j) {
  std::vector<double> all;
  for (const Json& x : j) all.push_back(number(x));
  return all;
}

Json to_json(const StudySummary& s);
StudySummary study(const Json& j);

void put_sweep(Json& j, const StudySummary& s) {
  for (const VariantSummary& v : s.variants) {
    Json changes = Json::object(), studies = Json::array();
    for (const auto& [path, value] : v.changes) changes[path] = value;
    for (const StudySummary& one : v.studies) studies.push_back(to_json(one));
    j["variants"].push_back({{"name", v.name}, {"changes", std::move(changes)}, {"studies", std::move(studies)}});
  }
  for (const SweepColumn& c : s.columns)
    j["columns"].push_back({{"name", c.name},
                            {"unit", c.unit},
                            {"values", numbers(c.values)},
                            {"uncertainties", numbers(c.uncertainties)}});
  for (const Trend& t : s.trends)
    j["trends"].push_back({{"column", t.column},
                           {"quantity", t.quantity},
                           {"unit", t.unit},
                           {"beside", t.beside},
                           {"sign", t.sign},
                           {"variants", t.variants},
                           {"at", numbers(t.at)},
                           {"difference", numbers(t.difference)},
                           {"uncertainty", numbers(t.uncertainty)}});
}

void take_sweep(const Json& j, StudySummary& s) {
  for (const Json& v : j.value("variants", Json::array())) {
    VariantSummary& variant = s.variants.emplace_back();
    variant.name = v.at("name");
    for (const auto& [path, value] : v.at("changes").items()) variant.changes.emplace_back(path, value);
    for (const Json& one : v.at("studies")) variant.studies.push_back(study(one));
  }
  for (const Json& c : j.value("columns", Json::array()))
    s.columns.push_back({c.at("name"), c.at("unit"), numbers(c.at("values")), numbers(c.at("uncertainties"))});
  for (const Json& t : j.value("trends", Json::array()))
    s.trends.push_back({t.at("column"), t.at("quantity"), t.at("unit"), t.at("beside"), t.at("sign"), t.at("variants"),
                        numbers(t.at("at")), numbers(t.at("difference")), numbers(t.at("uncertainty"))});
}

Json to_json(const StudySummary& s) {
  Json values = Json::object();
  for (const auto& [name, q] : s.values) values[name] = quantity_to_json(q);
  Json bifurcations = Json::array(), modes = Json::array();
  for (const Bifurcation& b : s.bifurcations) bifurcations.push_back(to_json(b));
  for (const ModeEntry& m : s.modes) {
    modes.push_back({{"speed", number(m.speed)},
                     {"speed_unit", m.speed_unit},
                     {"real", number(m.real)},
                     {"imag", number(m.imag)},
                     {"log_decrement", number(m.log_decrement)},
                     {"whirl", text_or_null(m.whirl)}});
    if (!m.stability.empty()) modes.back()["stability"] = m.stability;
    if (!m.whirl_rule.empty()) modes.back()["whirl_rule"] = m.whirl_rule;
    for (const auto& [key, value] : m.more) modes.back()[key] = number(value);
  }
  Json j = {{"name", s.name},
            {"kind", s.kind},
            {"status", s.status},
            {"wall_seconds", number(s.wall_seconds)},
            {"values", std::move(values)},
            {"bifurcations", std::move(bifurcations)},
            {"modes", std::move(modes)},
            {"points", s.points}};
  if (!s.layout.empty()) j["layout"] = s.layout;
  if (!s.ways.empty()) j["ways"] = s.ways;
  if (!s.stability.empty()) j["stability"] = s.stability;
  for (const StabilityRange& r : s.ranges)
    j["ranges"].push_back(
        {{"from", number(r.from)}, {"to", number(r.to)}, {"unit", r.unit}, {"stability", r.stability}});
  if (!s.warnings.empty()) j["warnings"] = s.warnings;
  for (const PeakEntry& p : s.peaks) j["peaks"].push_back(to_json(p));
  for (const Column& c : s.curve) {
    Json column = Json::array();
    for (const double v : c.values) column.push_back(number(v));
    j["curve"][c.name] = {{"unit", c.unit}, {"values", std::move(column)}};
  }
  for (const CodimensionTwo& c : s.codimension_two) j["codimension_two"].push_back(to_json(c));
  for (const Suspicion& x : s.suspected)
    j["suspected"].push_back({{"from", number(x.from)}, {"to", number(x.to)}, {"unit", x.unit}, {"reason", x.reason}});
  put_sweep(j, s);
  if (!s.brief.sentences.empty() || !s.brief.tables.empty()) j["brief"] = brief_to_json(s.brief);
  return j;
}

StudySummary study(const Json& j) {
  StudySummary s;
  s.name = j.at("name");
  s.kind = j.at("kind");
  s.status = j.at("status");
  s.wall_seconds = number(j.at("wall_seconds"));
  for (const auto& [name, q] : j.at("values").items()) s.values.emplace_back(name, quantity(q));
  for (const Json& b : j.at("bifurcations")) s.bifurcations.push_back(bifurcation(b));
  for (const Json& c : j.value("codimension_two", Json::array())) s.codimension_two.push_back(codimension_two(c));
  for (const Json& x : j.value("suspected", Json::array()))
    s.suspected.push_back({number(x.at("from")), number(x.at("to")), x.at("unit"), x.at("reason")});
  for (const Json& m : j.at("modes"))
    s.modes.push_back(
        {number(m.at("speed")), number(m.at("real")), number(m.at("imag")), number(m.at("log_decrement")),
         m.at("whirl").is_null() ? "" : m.at("whirl").get<std::string>(), m.value("speed_unit", std::string()),
         others(m, {"speed", "speed_unit", "real", "imag", "log_decrement", "whirl", "stability", "whirl_rule"}),
         m.value("stability", std::string()), m.value("whirl_rule", std::string())});
  s.layout = j.value("layout", std::string());
  s.ways = j.value("ways", std::string());
  s.stability = j.value("stability", std::string());
  for (const Json& r : j.value("ranges", Json::array()))
    s.ranges.push_back({number(r.at("from")), number(r.at("to")), r.at("unit"), r.at("stability")});
  s.warnings = j.value("warnings", std::vector<std::string>());
  for (const Json& p : j.value("peaks", Json::array())) s.peaks.push_back(peak(p));
  const Json curve = j.value("curve", Json::object());
  for (const auto& [name, c] : curve.items()) {
    Column column{name, c.at("unit"), {}};
    for (const Json& v : c.at("values")) column.values.push_back(number(v));
    s.curve.push_back(std::move(column));
  }
  s.points = j.at("points");
  take_sweep(j, s);
  if (j.contains("brief")) s.brief = brief_of(j.at("brief"));
  return s;
}

}  // namespace

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
  Json list = Json::array();
  for (const StudySummary& s : studies) list.push_back(io::to_json(s));
  Json given = Json::array();
  for (const LibraryOption& o : options)
    given.push_back({{"name", o.name}, {"value", o.value}, {"source", text_or_null(o.source)}});
  Json j = {{"title", title},
            {"version", version},
            {"ranks", ranks},
            {"wall_seconds", number(wall_seconds)},
            {"options", std::move(given)}};
  if (!warnings.empty()) j["warnings"] = warnings;
  if (!service.speed.unit.empty()) j["service_speed"] = io::to_json(service);
  j["studies"] = std::move(list);
  // Texts come from users' decks; a byte that is not UTF-8 must not cost the results.
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void Summary::write(const std::filesystem::path& path) const {
  replace_file(path, to_json());
}

Summary Summary::from_json(const std::string& text) {
  try {
    const Json j = Json::parse(text);
    Summary s;
    s.title = j.at("title");
    s.version = j.at("version");
    s.ranks = j.at("ranks");
    s.wall_seconds = number(j.at("wall_seconds"));
    for (const Json& o : j.value("options", Json::array()))
      s.options.push_back(
          {o.at("name"), o.at("value"), o.at("source").is_null() ? "" : o.at("source").get<std::string>()});
    s.warnings = j.value("warnings", std::vector<std::string>());
    if (j.contains("service_speed")) s.service = io::service(j.at("service_speed"));
    for (const Json& one : j.at("studies")) s.studies.push_back(study(one));
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
