#include "validate/record/detail/columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <regex>

#include "base/constants.hpp"

namespace swingbank::validate::record {
namespace {

struct Alias {
  std::string_view name;  ///< normalised
  Quantity quantity;
  bool deviation = false;
};
/// Names of quantities, without units. V1 is the positive sequence; VMP, VAP, IMP, IAP (also with the last
/// two letters exchanged) are signal types of synchrophasor exchange files.
constexpr Alias kAliases[] = {
    {"t", Quantity::time},
    {"time", Quantity::time},
    {"timestamp", Quantity::time},
    {"datetime", Quantity::time},
    {"utc", Quantity::time},
    {"timeutc", Quantity::time},
    {"utctime", Quantity::time},
    {"domain", Quantity::time},
    {"v", Quantity::V},
    {"u", Quantity::V},
    {"ug", Quantity::V},
    {"vm", Quantity::V},
    {"vt", Quantity::V},
    {"vmag", Quantity::V},
    {"vterm", Quantity::V},
    {"v1", Quantity::V},
    {"v1mag", Quantity::V},
    {"v1magnitude", Quantity::V},
    {"vmp", Quantity::V},
    {"vpm", Quantity::V},
    {"voltage", Quantity::V},
    {"voltagemag", Quantity::V},
    {"voltagemagnitude", Quantity::V},
    {"terminalvoltage", Quantity::V},
    {"theta", Quantity::theta},
    {"angle", Quantity::theta},
    {"vang", Quantity::theta},
    {"vangle", Quantity::theta},
    {"v1ang", Quantity::theta},
    {"v1angle", Quantity::theta},
    {"vap", Quantity::theta},
    {"vpa", Quantity::theta},
    {"voltageang", Quantity::theta},
    {"voltageangle", Quantity::theta},
    {"phaseangle", Quantity::theta},
    {"f", Quantity::f},
    {"freq", Quantity::f},
    {"frequency", Quantity::f},
    {"p", Quantity::P},
    {"pe", Quantity::P},
    {"pgen", Quantity::P},
    {"activepower", Quantity::P},
    {"realpower", Quantity::P},
    {"power", Quantity::P},
    {"q", Quantity::Q},
    {"qe", Quantity::Q},
    {"qgen", Quantity::Q},
    {"reactivepower", Quantity::Q},
    {"speed", Quantity::speed, true},
    {"speeddeviation", Quantity::speed, true},
    {"omega", Quantity::speed},
    {"w", Quantity::speed},
    {"rotorspeed", Quantity::speed},
    {"efd", Quantity::Efd},
    {"fieldvoltage", Quantity::Efd},
    {"vs", Quantity::Vs},
    {"vpss", Quantity::Vs},
    {"vstab", Quantity::Vs},
    {"pssoutput", Quantity::Vs},
    {"vref", Quantity::Vref},
    {"voltagereference", Quantity::Vref},
    {"pm", Quantity::Pm},
    {"pmech", Quantity::Pm},
    {"tm", Quantity::Pm},
    {"mechanicalpower", Quantity::Pm},
    {"pref", Quantity::Pref},
    {"powerreference", Quantity::Pref},
    {"loadreference", Quantity::Pref},
    {"gate", Quantity::gate},
    {"gateposition", Quantity::gate},
    {"gateopening", Quantity::gate},
    {"valve", Quantity::gate},
    {"valveposition", Quantity::gate},
    {"ifd", Quantity::Ifd},
    {"fieldcurrent", Quantity::Ifd},
    {"i", Quantity::I},
    {"ig", Quantity::I},
    {"imag", Quantity::I},
    {"i1", Quantity::I},
    {"i1mag", Quantity::I},
    {"i1magnitude", Quantity::I},
    {"imp", Quantity::I},
    {"ipm", Quantity::I},
    {"current", Quantity::I},
    {"currentmag", Quantity::I},
    {"currentmagnitude", Quantity::I},
    {"phi", Quantity::phi},
    {"iang", Quantity::phi},
    {"iangle", Quantity::phi},
    {"i1ang", Quantity::phi},
    {"i1angle", Quantity::phi},
    {"iap", Quantity::phi},
    {"ipa", Quantity::phi},
    {"currentang", Quantity::phi},
    {"currentangle", Quantity::phi},
};

struct UnitName {
  std::string_view name;  ///< normalised
  Unit unit;
};
constexpr UnitName kUnits[] = {
    {"s", Unit::second},       {"sec", Unit::second},       {"seconds", Unit::second},
    {"ms", Unit::millisecond}, {"us", Unit::microsecond},   {"pu", Unit::pu},
    {"kv", Unit::kilovolt},    {"kvll", Unit::kilovolt},    {"v", Unit::volt},
    {"vll", Unit::volt},       {"kvln", Unit::kilovolt_ln}, {"vln", Unit::volt_ln},
    {"rad", Unit::radian},     {"radians", Unit::radian},   {"deg", Unit::degree},
    {"degree", Unit::degree},  {"degrees", Unit::degree},   {"°", Unit::degree},
    {"hz", Unit::hertz},       {"mw", Unit::megawatt},      {"mvar", Unit::megavar},
    {"mvars", Unit::megavar},  {"ka", Unit::kiloampere},    {"a", Unit::ampere},
    {"amps", Unit::ampere},
};

/// Headings that are a unit and yet say what they are.
constexpr struct {
  std::string_view name;
  Quantity quantity;
  Unit unit;
} kUnitHeadings[] = {
    {"mw", Quantity::P, Unit::megawatt},
    {"mvar", Quantity::Q, Unit::megavar},
    {"hz", Quantity::f, Unit::hertz},
    {"kv", Quantity::V, Unit::kilovolt},
};

bool fits(Quantity q, Unit u) {
  switch (q) {
    case Quantity::time:
      return u == Unit::second || u == Unit::millisecond || u == Unit::microsecond;
    case Quantity::V:
      return u == Unit::pu || u == Unit::kilovolt || u == Unit::volt || u == Unit::kilovolt_ln ||
             u == Unit::volt_ln;
    case Quantity::theta:
    case Quantity::phi:
      return u == Unit::radian || u == Unit::degree;
    case Quantity::f:
      return u == Unit::pu || u == Unit::hertz;
    case Quantity::P:
      return u == Unit::pu || u == Unit::megawatt;
    case Quantity::Q:
      return u == Unit::pu || u == Unit::megavar;
    case Quantity::I:
      return u == Unit::pu || u == Unit::kiloampere || u == Unit::ampere;
    case Quantity::Pm:
    case Quantity::Pref:
      return u == Unit::pu || u == Unit::megawatt;
    case Quantity::Efd:
      return u == Unit::pu || u == Unit::volt || u == Unit::kilovolt;
    case Quantity::Ifd:
      return u == Unit::pu || u == Unit::ampere || u == Unit::kiloampere;
    case Quantity::speed:
    case Quantity::Vs:
    case Quantity::Vref:
    case Quantity::gate:
      return u == Unit::pu;
  }
  return false;
}

const Alias* find_alias(std::string_view name) {
  const auto found = std::ranges::find(kAliases, name, &Alias::name);
  return found == std::end(kAliases) ? nullptr : &*found;
}
std::optional<Unit> find_unit(std::string_view text) {
  const std::string name = normalised(text);
  const auto found = std::ranges::find(kUnits, name, &UnitName::name);
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->unit);
}

ColumnMeaning meaning(const Alias& alias, std::optional<Unit> unit) {
  if (unit && !fits(alias.quantity, *unit)) unit.reset();
  return {alias.quantity, unit, alias.deviation, {}, false};
}

/// "V (kV)" or "P [MW]": the part before, and the unit inside.
std::optional<ColumnMeaning> bracketed(std::string_view heading) {
  const char last = heading.empty() ? '\0' : heading.back();
  if (last != ')' && last != ']') return std::nullopt;
  const auto open = heading.rfind(last == ')' ? '(' : '[');
  if (open == std::string_view::npos) return std::nullopt;
  const Alias* alias = find_alias(normalised(heading.substr(0, open)));
  if (!alias) return std::nullopt;
  return meaning(*alias, find_unit(heading.substr(open + 1, heading.size() - open - 2)));
}

/// "V_kV_ln", "theta deg", "P/MW": the longest ending that is a unit.
std::optional<ColumnMeaning> suffixed(std::string_view heading) {
  for (std::size_t at = heading.find_first_of("_ /-"); at != std::string_view::npos;
       at = heading.find_first_of("_ /-", at + 1)) {
    const Alias* alias = find_alias(normalised(heading.substr(0, at)));
    const auto unit = find_unit(heading.substr(at + 1));
    if (alias && unit && fits(alias->quantity, *unit)) return meaning(*alias, unit);
  }
  return std::nullopt;
}

std::optional<ColumnMeaning> without_terminal(std::string_view heading, std::string_view unit) {
  if (const auto m = bracketed(heading)) return m;
  if (const auto m = suffixed(heading)) return m;
  const std::string name = normalised(heading);
  if (const Alias* alias = find_alias(name)) return meaning(*alias, find_unit(unit));
  for (const auto& u : kUnitHeadings)
    if (name == u.name) return ColumnMeaning{u.quantity, u.unit, false, {}, false};
  // A name we know with something behind it that is no unit: better asked about than left out.
  if (const Alias* alias = find_alias(normalised(heading.substr(0, heading.find('_')))))
    return meaning(*alias, std::nullopt);
  return std::nullopt;
}

}  // namespace

std::string normalised(std::string_view text) {
  std::string name;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::optional<ColumnMeaning> quantity_of(std::string_view word) {
  const Alias* alias = find_alias(normalised(word));
  return alias ? std::optional(meaning(*alias, std::nullopt)) : std::nullopt;
}

std::optional<Unit> unit_in(Quantity quantity, std::string_view heading, std::string_view unit) {
  const auto fitting = [&](std::string_view text) {
    const auto found = find_unit(text);
    return found && fits(quantity, *found) ? found : std::nullopt;
  };
  if (const auto found = fitting(unit)) return found;
  for (std::size_t at = heading.find_first_of("_ /-.:[("); at != std::string_view::npos;
       at = heading.find_first_of("_ /-.:[(", at + 1))
    if (const auto found = fitting(heading.substr(at + 1))) return found;
  return fitting(heading);
}

std::optional<ColumnMeaning> psse_channel(std::string_view heading) {
  static const std::regex form(
      R"(^(VOLT|ETRM|VANG|ANGL|POWR|VARS|SPD|FREQ|EFD|XADIFD|XADI)\s*(\d+)\s*(?:\[[^\]]*\])?\s*(\w{0,2})$)");
  std::cmatch part;
  if (!std::regex_match(heading.data(), heading.data() + heading.size(), part, form)) return std::nullopt;
  static const std::map<std::string, ColumnMeaning, std::less<>> words = {
      {"VOLT", {Quantity::V, Unit::pu, false, {}, false}},
      {"ETRM", {Quantity::V, Unit::pu, false, {}, false}},
      {"VANG", {Quantity::theta, Unit::degree, false, {}, false}},
      {"ANGL", {Quantity::theta, Unit::degree, false, {}, false}},
      {"POWR", {Quantity::P, Unit::pu, false, {}, false}},
      {"VARS", {Quantity::Q, Unit::pu, false, {}, false}},
      {"SPD", {Quantity::speed, Unit::pu, true, {}, false}},
      {"FREQ", {Quantity::f, Unit::pu, true, {}, false}},
      {"EFD", {Quantity::Efd, Unit::pu, false, {}, false}},
      {"XADIFD", {Quantity::Ifd, Unit::pu, false, {}, false}},
      {"XADI", {Quantity::Ifd, Unit::pu, false, {}, false}}};
  const std::string word = part[1].str(), id = part[3].str();
  if (word == "ANGL" && !id.empty()) return std::nullopt;  // the rotor's angle, not the bus's
  ColumnMeaning m = words.at(word);
  m.terminal = id.empty() ? part[2].str() : part[2].str() + "/" + id;
  return m;
}

std::optional<ColumnMeaning> column_meaning(std::string_view heading, std::string_view unit) {
  if (auto m = psse_channel(heading)) return m;
  if (auto m = without_terminal(heading, unit)) return m;
  for (std::size_t at = heading.find_first_of(".:"); at != std::string_view::npos;
       at = heading.find_first_of(".:", at + 1))
    if (auto m = without_terminal(heading.substr(at + 1), unit)) {
      m->terminal = heading.substr(0, at);
      return m;
    }
  return std::nullopt;
}

bool is_unit(std::string_view text) { return find_unit(text).has_value(); }

std::string_view word_of(Quantity q) {
  constexpr std::string_view words[kQuantities] = {"t",   "V", "theta", "f",  "P",    "Q",  "speed", "Efd",
                                                   "Ifd", "I", "phi",   "Vs", "Vref", "Pm", "Pref",  "gate"};
  return words[static_cast<int>(q)];
}

std::string names_of(Quantity q) {
  constexpr std::string_view names[kQuantities] = {
      "t_s, t_ms",     "V_pu, V_kV, V_kV_ln", "theta_rad, theta_deg", "f_pu, f_hz",
      "P_pu, P_MW",    "Q_pu, Q_Mvar",        "omega_pu, speed_pu",   "Efd_pu, Efd_V",
      "Ifd_pu, Ifd_A", "I_pu, I_A, I_kA",     "phi_rad, phi_deg",     "Vs_pu",
      "Vref_pu",       "Pm_pu, Pm_MW",        "Pref_pu, Pref_MW",     "gate_pu",
  };
  return std::string(names[static_cast<int>(q)]);
}

bool needs_kv(Quantity quantity, Unit unit) {
  if (quantity == Quantity::Efd || quantity == Quantity::Ifd) return false;
  return unit == Unit::kilovolt || unit == Unit::volt || unit == Unit::kilovolt_ln || unit == Unit::volt_ln ||
         unit == Unit::kiloampere || unit == Unit::ampere;
}

std::string_view needs_base(Quantity quantity, Unit unit) {
  if (unit == Unit::pu) return {};
  return quantity == Quantity::Efd ? "efd_base" : quantity == Quantity::Ifd ? "ifd_base" : "";
}

namespace {

/// Field voltage and current: the record's own unit (pu, V, A) to the model's pu.
double field_units(const ColumnMeaning& column, double v, double base) {
  const Unit unit = column.unit.value_or(Unit::pu);
  if (unit == Unit::kilovolt || unit == Unit::kiloampere) v *= 1e3;
  return base > 0 ? v / base : v;
}

}  // namespace

double to_record_units(const ColumnMeaning& column, double v, const RecordBase& base) {
  const bool nominal_is_one =
      (column.quantity == Quantity::f || column.quantity == Quantity::speed) && !column.deviation;
  if (column.negated) v = -v;
  if (column.quantity == Quantity::Efd) return field_units(column, v, base.efd);
  if (column.quantity == Quantity::Ifd) return field_units(column, v, base.ifd);
  switch (column.unit.value_or(Unit::pu)) {
    case Unit::second:
    case Unit::stamp:
    case Unit::radian:
      return v;
    case Unit::pu:
      return nominal_is_one ? v - 1 : v;
    case Unit::millisecond:
      return v * 1e-3;
    case Unit::microsecond:
      return v * 1e-6;
    case Unit::kilovolt:
      return v / base.kv;
    case Unit::volt:
      return v * 1e-3 / base.kv;
    case Unit::kilovolt_ln:
      return v * std::numbers::sqrt3 / base.kv;
    case Unit::volt_ln:
      return v * 1e-3 * std::numbers::sqrt3 / base.kv;
    case Unit::degree:
      return v * constants::pi / 180;
    case Unit::hertz:
      return v / base.frequency - (column.deviation ? 0 : 1);
    case Unit::megawatt:
    case Unit::megavar:
      return v / base.mva;
    case Unit::kiloampere:
      return v * std::numbers::sqrt3 * base.kv / base.mva;
    case Unit::ampere:
      return v * 1e-3 * std::numbers::sqrt3 * base.kv / base.mva;
  }
  return v;
}

}  // namespace swingbank::validate::record
