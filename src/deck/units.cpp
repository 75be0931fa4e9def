#include "whirl/deck/units.hpp"

#include <fmt/core.h>
#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/deck/node.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

struct FreeUnit {
  void operator()(ut_unit* u) const { ut_free(u); }
};
using UnitPtr = std::unique_ptr<ut_unit, FreeUnit>;

struct FreeSystem {
  void operator()(ut_system* s) const { ut_free_system(s); }
};

// The unit database with the names that engineers write and UDUNITS does not know. Read once, never changed after.
ut_system* unit_system() {
  static const std::unique_ptr<ut_system, FreeSystem> system = [] {
    ut_set_error_message_handler(ut_ignore);
    std::unique_ptr<ut_system, FreeSystem> s(ut_read_xml(nullptr));
    if (!s) throw core::Error("the unit database of UDUNITS-2 cannot be read");
    const std::array<std::array<const char*, 2>, 6> aliases{{{"deg", "degree"},
                                                             {"rev", "revolution"},
                                                             {"cP", "1e-3 Pa s"},
                                                             {"RPM", "rpm"},
                                                             {"inch", "in"},
                                                             {"micron", "1e-6 m"}}};
    for (const auto& [name, definition] : aliases) {
      const UnitPtr u(ut_parse(s.get(), definition, UT_UTF8));
      core::require(u != nullptr, "an alias of a unit does not parse");
      (void)ut_map_name_to_unit(name, UT_ASCII, u.get());
    }
    return s;
  }();
  return system.get();
}

// What UDUNITS says about a unit: powers of the basic units (the radian is one of them, so speeds differ from
// frequencies), and the value in coherent SI of 0 and 1.
struct Unit {
  std::map<std::string, int> powers;
  double scale = 1;
  double offset = 0;
};

struct UnitParts {
  std::map<std::string, int> powers;
  UnitPtr coherent;
};

ut_status visit_basic(const ut_unit* unit, void* arg) {
  auto& s = *static_cast<UnitParts*>(arg);
  const char* symbol = ut_get_symbol(unit, UT_ASCII);
  s.powers[symbol ? symbol : ut_get_name(unit, UT_ASCII)] = 1;
  s.coherent.reset(ut_clone(unit));
  return UT_SUCCESS;
}

ut_status visit_product(const ut_unit*, int count, const ut_unit* const* basic, const int* powers, void* arg) {
  auto& s = *static_cast<UnitParts*>(arg);
  s.coherent.reset(ut_get_dimensionless_unit_one(unit_system()));
  for (int i = 0; i < count; ++i) {
    const char* symbol = ut_get_symbol(basic[i], UT_ASCII);
    s.powers[symbol ? symbol : ut_get_name(basic[i], UT_ASCII)] = powers[i];
    const UnitPtr power(ut_raise(basic[i], powers[i]));
    s.coherent.reset(ut_multiply(s.coherent.get(), power.get()));
  }
  return UT_SUCCESS;
}

ut_status visit_galilean(const ut_unit*, double, const ut_unit* underlying, double, void* arg);
ut_status visit_timestamp(const ut_unit*, const ut_unit*, double, void*) {
  return UT_BAD_ARG;
}
ut_status visit_logarithmic(const ut_unit*, double, const ut_unit*, void*) {
  return UT_BAD_ARG;
}
const ut_visitor visitor{visit_basic, visit_product, visit_galilean, visit_timestamp, visit_logarithmic};

ut_status visit_galilean(const ut_unit*, double, const ut_unit* underlying, double, void* arg) {
  return ut_accept_visitor(underlying, &visitor, arg);
}

const std::vector<std::string>& common_units() {
  static const std::vector<std::string> units{
      "m",      "mm",    "um",    "kg",    "g",    "s",     "ms",     "N",     "kN",     "Pa", "kPa",
      "MPa",    "GPa",   "bar",   "K",     "degC", "rad",   "deg",    "rpm",   "rad/s",  "Hz", "Pa s",
      "mPa s",  "cP",    "N/m",   "N s/m", "kg m", "m/s",   "mm/s",   "m/s^2", "kg/m^3", "W",  "kW",
      "J/kg/K", "W/m/K", "m^2/s", "N m",   "g mm", "kg mm", "kg m^2", "byte",  "MB",     "GB", "GiB"};
  return units;
}

// Words of a unit that UDUNITS understands as something nobody means here.
void refuse_traps(std::string_view unit) {
  std::string word;
  for (std::size_t i = 0; i <= unit.size(); ++i) {
    const char c = i < unit.size() ? unit[i] : ' ';
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) {
      word += c;
      continue;
    }
    if (word == "C") throw InputError("'C' is the coulomb; write degC for a temperature");
    if (word == "F") throw InputError("'F' is the farad; write degF for a temperature");
    if (word == "Bq") throw InputError("'Bq' is the becquerel; write Hz for a frequency");
    if (word == "since" || word == "from" || word == "after" || c == '@')
      throw InputError(fmt::format("'{}' is not a unit", unit));
    word.clear();
  }
  const char first = unit.empty() ? ' ' : unit[0];
  if (first == ',') throw InputError("a number has a decimal point, not a comma");
  if ((first >= '0' && first <= '9') && unit.substr(0, 2) != "1/")
    throw InputError(fmt::format("'{}' is not a unit: there is a second number", unit));
}

// Units of memory: to UDUNITS a byte is a pure number and B is the bel.
const std::map<std::string, double, std::less<>>& units_of_memory() {
  static const std::map<std::string, double, std::less<>> units{{"byte", 1},        {"kB", 1e3},          {"MB", 1e6},
                                                                {"GB", 1e9},        {"TB", 1e12},         {"KiB", 1024},
                                                                {"MiB", 1048576.0}, {"GiB", 1073741824.0}};
  return units;
}

std::vector<std::string> common_units_of(std::string_view si);

// `si` is the kind that is expected, for the hint.
Unit parse_unit(std::string_view text, std::string_view si = "*") {
  refuse_traps(text);
  if (text.empty() || text == "1") return {};
  if (const auto memory = units_of_memory().find(text); memory != units_of_memory().end()) {
    Unit u;
    u.powers["byte"] = 1;
    u.scale = memory->second;
    return u;
  }
  const UnitPtr unit(ut_parse(unit_system(), std::string(text).c_str(), UT_UTF8));
  if (!unit) {
    // Which the nearest spelling does not find.
    static const std::map<std::string_view, const char*> meant{{"U/min", "rpm"}, {"r/min", "rpm"}, {"cst", "cSt"},
                                                               {"CST", "cSt"},   {"lbs", "lb"},    {"kgm2", "kg m^2"}};
    const auto known = meant.find(text);
    throw InputError(fmt::format("unknown unit '{}'{}", text,
                                 known != meant.end() ? fmt::format(" (did you mean '{}'?)", known->second)
                                                      : did_you_mean(text, common_units_of(si))));
  }
  UnitParts s;
  if (ut_accept_visitor(unit.get(), &visitor, &s) != UT_SUCCESS || !s.coherent)
    throw InputError(fmt::format("unit '{}' cannot be used here", text));
  const std::unique_ptr<cv_converter, decltype(&cv_free)> convert(ut_get_converter(unit.get(), s.coherent.get()),
                                                                  &cv_free);
  core::require(convert != nullptr, "a unit does not convert to its own coherent unit");
  Unit u;
  u.powers = std::move(s.powers);
  std::erase_if(u.powers, [](const auto& p) { return p.second == 0; });
  u.offset = cv_convert_double(convert.get(), 0.0);
  u.scale = u.offset == 0 ? cv_convert_double(convert.get(), 1.0)
                          : (cv_convert_double(convert.get(), 1000.0) - u.offset) / 1000.0;
  return u;
}

// "delta K" is our mark of a temperature difference, not a unit of UDUNITS.
constexpr std::string_view difference = "delta K";

std::string_view plain(std::string_view si) {
  return si == "1" ? std::string_view() : coherent(si);
}

// A hint does not make a pressure (MPa) of a viscosity (mPas).
std::vector<std::string> common_units_of(std::string_view si) {
  std::vector<std::string> units = common_units();
  if (si == "*") return units;
  const auto powers = parse_unit(plain(si)).powers;
  std::erase_if(units, [&](const std::string& u) { return parse_unit(u).powers != powers; });
  return units;
}

// The unit in which something of kind `si` is written. A frequency may be given by its cycles: 1 Hz is 2 pi rad/s.
Unit unit_of(std::string_view text, std::string_view si) {
  Unit u = parse_unit(plain(text), si);
  static const auto cycles = parse_unit("Hz").powers;
  if (si != frequency || !text.ends_with("Hz") || u.powers != cycles) return u;
  u.powers = parse_unit(plain(si)).powers;
  u.scale *= 2 * std::numbers::pi;
  return u;
}

std::string expected(std::string_view si) {
  static const std::map<std::string, std::string, std::less<>> examples{
      {"m", "a length such as 180 um"},
      {"kg", "a mass such as 2500 kg"},
      {"s", "a time such as 1e-5 s"},
      {"rad/s", "a speed such as 3600 rpm or 377 rad/s"},
      {"rad", "an angle such as 60 deg"},
      {"Hz", "a frequency such as 50 Hz"},
      {std::string(frequency), "a frequency such as 60 Hz, 3600 rpm or 377 rad/s"},
      {"K", "a temperature such as 60 degC"},
      {"delta K", "a temperature difference such as 20 K"},
      {"Pa", "a pressure such as 1.5 bar"},
      {"Pa s", "a viscosity such as 6.7 mPa s"},
      {"kg/m^3", "a density such as 850 kg/m^3"},
      {"N", "a force such as 10 kN"},
      {"N/m", "a stiffness such as 1e9 N/m"},
      {"N s/m", "a damping such as 1e5 N s/m"},
      {"m/s", "a velocity such as 2.5 mm/s"},
      {"m/s^2", "an acceleration such as 9.81 m/s^2"},
      {"kg m", "an unbalance such as 50 kg mm"},
      {"byte", "a size of memory such as 8 GB"}};
  const auto it = examples.find(si);
  return it != examples.end() ? it->second : fmt::format("a value in {}", si);
}

// Why a unit of another quantity may have been written, and what to write instead.
std::string mixed_up(const Unit& u, std::string_view si) {
  struct Pair {
    std::string_view wanted, given;
    const char* hint;
  };
  static constexpr std::array<Pair, 6> pairs{
      {{"rad/s", "Hz", "a frequency is not a speed: 1 Hz is 60 rpm"},
       {"Hz", "rad/s", "a speed is not a frequency: 60 rpm is 1 Hz"},
       {"Pa s", "m^2/s",
        "a kinematic viscosity: its product with the density is the viscosity, mPa s = cSt x density / (1000 kg/m^3)"},
       {"kg", "N", "a weight is not a mass: a mass of 1 kg weighs 9.81 N"},
       {"N", "kg", "a mass is not a force: 1 kg weighs 9.81 N, which is 1 kgf"},
       {"kg m^2", "m^4", "a second moment of area is not the moment of inertia of a mass"}}};
  for (const auto& [wanted, given, hint] : pairs)
    if (si == wanted && u.powers == parse_unit(given).powers) return fmt::format(" ({})", hint);
  return {};
}

void require_kind(const Unit& u, std::string_view unit, std::string_view si) {
  if (si == "*") return;
  const Unit wanted = parse_unit(plain(si));
  if (u.powers != wanted.powers)
    throw InputError(fmt::format("'{}' does not fit: expected {}{}", unit, expected(si), mixed_up(u, si)));
  if (si == difference && u.offset != 0)
    throw InputError(fmt::format("'{}' is a temperature, expected {} (in K)", unit, expected(si)));
}

double apply(const Unit& u, double number) {
  if (u.offset != 0) return u.offset + number * u.scale;
  // 110 um as 110/1e6 is the double nearest to 1.1e-4; 110 * 1e-6 is not.
  const double inverse = std::round(1 / u.scale);
  if (u.scale < 1 && std::abs(inverse * u.scale - 1) < 1e-15) return number / inverse;
  return number * u.scale;
}

}  // namespace

Split split_quantity(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  std::string_view number = text;
  if (!number.empty() && number.front() == '+') number.remove_prefix(1);
  Split s;
  const auto [end, code] = std::from_chars(number.data(), number.data() + number.size(), s.number);
  if (code == std::errc::invalid_argument)
    throw InputError(text.empty() ? std::string("there is no number") : fmt::format("'{}' is not a number", text));
  if (code != std::errc() || !std::isfinite(s.number))
    throw InputError(fmt::format("'{}' is not a finite number", text));
  std::string_view unit(end, static_cast<std::size_t>(number.data() + number.size() - end));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  s.unit = unit;
  return s;
}

double to_si(std::string_view text, std::string_view si) {
  const Split s = split_quantity(text);
  if (si == "1") {
    if (!s.unit.empty()) throw InputError(fmt::format("'{}' has a unit, expected a bare number", text));
    return s.number;
  }
  if (s.unit.empty() && si != "*") throw InputError(fmt::format("'{}' has no unit: expected {}", text, expected(si)));
  if (s.unit == si || (s.unit == "K" && si == difference)) return s.number;
  check_kind(s.unit, si);
  const double value = apply(unit_of(s.unit, si), s.number);
  if (!std::isfinite(value)) throw InputError(fmt::format("'{}' is not a finite number in SI units", text));
  return value;
}

double number_to_si(double number, std::string_view unit) {
  return apply(parse_unit(plain(unit)), number);
}

double from_si(double value, std::string_view unit, std::string_view si) {
  const Unit u = unit_of(unit, si);
  const double inverse = std::round(1 / u.scale);
  if (u.offset == 0 && u.scale < 1 && std::abs(inverse * u.scale - 1) < 1e-15) return value * inverse;
  return (value - u.offset) / u.scale;
}

bool same_kind(std::string_view unit, std::string_view other) {
  return unit_of(unit, other).powers == unit_of(other, unit).powers;
}

std::string_view coherent(std::string_view si) {
  return si == difference ? std::string_view("K") : si == frequency ? std::string_view("rad/s") : si;
}

void check_kind(std::string_view unit, std::string_view si) {
  require_kind(unit_of(unit, si), unit, si);
}

std::string write_number(double value) {
  std::string text = fmt::format("{}", value == 0 ? 0.0 : value);
  if (const std::size_t e = text.find('e'); e != std::string::npos) {  // 1e-5 and 1e16, not 1e-05 and 1e+16
    std::size_t digits = e + 1;
    if (text[digits] == '+') text.erase(digits, 1);
    if (text[digits] == '-') ++digits;
    if (text[digits] == '0') text.erase(digits, 1);
  }
  // 1.8e9 reads better than 1800000000.
  const std::size_t sign = text[0] == '-' ? 1 : 0, last = text.find_last_not_of('0');
  if (text.find_first_of(".en") != std::string::npos || text.size() - last < 7) return text;
  const std::size_t exponent = text.size() - sign - 1;
  text.resize(last + 1);
  if (last > sign) text.insert(sign + 1, ".");
  return fmt::format("{}e{}", text, exponent);
}

std::string write_memory(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

std::string write_rounded(double value) {
  double short_value = value;
  const std::string text = fmt::format("{:.15g}", value);
  (void)std::from_chars(text.data(), text.data() + text.size(), short_value);
  if (!std::isfinite(short_value)) throw InputError("the result is not a finite number");
  return write_number(short_value);
}

std::string scaled(std::string_view text, double factor) {
  const Split now = split_quantity(text);
  if (now.unit.empty()) return write_rounded(now.number * factor);
  if (number_to_si(0, now.unit) != 0)
    throw InputError(fmt::format("'{}' has no factor: its zero is not that of the temperature; write it in K", text));
  return write_rounded(now.number * factor) + " " + now.unit;
}

std::string write_quantity(double value, std::string_view unit, std::string_view si) {
  if (unit.empty() || unit == "1") return write_number(value);
  const Unit u = unit_of(unit, si);
  const double number = from_si(value, unit, si);
  for (int digits = 1; digits <= 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", number, digits);
    double read = 0;
    (void)std::from_chars(text.data(), text.data() + text.size(), read);
    if (apply(u, read) == value) return fmt::format("{} {}", write_number(read), plain(unit));
  }
  // The division may be off by a unit in the last place: look at the neighbours.
  for (double x : {std::nextafter(number, -HUGE_VAL), std::nextafter(number, HUGE_VAL)})
    if (apply(u, x) == value) return fmt::format("{} {}", write_number(x), plain(unit));
  return fmt::format("{} {}", write_number(number), plain(unit));
}

}  // namespace whirl::deck
