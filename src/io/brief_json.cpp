#include "io/json.hpp"

namespace whirl::io {

Json brief_to_json(const Brief& b) {
  Json tables = Json::array();
  for (const BriefTable& t : b.tables) {
    Json columns = Json::array(), rows = Json::array();
    for (const BriefColumn& c : t.columns)
      columns.push_back({{"name", c.name}, {"unit", c.unit}, {"shown", c.shown}, {"factor", c.factor}});
    for (const auto& row : t.rows) {
      Json cells = Json::array();
      for (const BriefCell& c : row) {
        cells.push_back(c.is_number() ? quantity_to_json(c.quantity) : text_or_null(c.text));
        if (c.is_number()) cells.back()["text"] = c.text;
      }
      rows.push_back(std::move(cells));
    }
    Json table = {{"caption", t.caption}, {"columns", std::move(columns)}, {"rows", std::move(rows)}};
    if (!t.note.empty()) table["note"] = t.note;
    tables.push_back(std::move(table));
  }
  Json j = {{"sentences", b.sentences}, {"tables", std::move(tables)}};
  if (b.tells_stability) j["tells_stability"] = true;
  return j;
}

namespace {

BriefCell brief_cell(const Json& j) {
  if (j.is_null()) return {};
  if (j.is_string()) return {j.get<std::string>()};
  BriefCell cell(Quantity{number(j.at("value")), j.at("unit"), others(j, {"value", "unit", "text"})});
  cell.text = j.at("text");
  return cell;
}

}  // namespace

Brief brief_of(const Json& j) {
  Brief b;
  b.sentences = j.at("sentences");
  b.tells_stability = j.value("tells_stability", false);
  for (const Json& t : j.at("tables")) {
    BriefTable& table = b.tables.emplace_back();
    table.caption = t.at("caption");
    table.note = t.value("note", std::string());
    for (const Json& c : t.at("columns"))
      table.columns.push_back({c.at("name"), c.at("unit"), c.at("shown"), number(c.at("factor"))});
    for (const Json& r : t.at("rows")) {
      auto& row = table.rows.emplace_back();
      for (const Json& c : r) row.push_back(brief_cell(c));
    }
  }
  return b;
}

}  // namespace whirl::io
