#include "validate/record/detail/columns.hpp"

#include <algorithm>
#include <map>
#include <regex>

#include "validate/record/detail/phases.hpp"

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
    {"timetag", Quantity::time},
    {"datetime", Quantity::time},
    {"utc", Quantity::time},
    {"timeutc", Quantity::time},
    {"utctime", Quantity::time},
    {"localtime", Quantity::time},
    {"elapsedtime", Quantity::time},
    {"relativetime", Quantity::time},
    {"simulationtime", Quantity::time},
    {"epoch", Quantity::time},
    {"unixtime", Quantity::time},
    {"soc", Quantity::time},
    {"secondofcentury", Quantity::time},
    {"domain", Quantity::time},
    {"zeit", Quantity::time},
    {"uhrzeit", Quantity::time},
    {"zeitstempel", Quantity::time},
    {"datumuhrzeit", Quantity::time},
    {"temps", Quantity::time},
    {"heure", Quantity::time},
    {"horodatage", Quantity::time},
    {"tempo", Quantity::time},
    {"ora", Quantity::time},
    {"dataora", Quantity::time},
    {"tiempo", Quantity::time},
    {"hora", Quantity::time},
    {"fechahora", Quantity::time},
    {"datahora", Quantity::time},
    {"время", Quantity::time},
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

/// Headings that consist of a unit only, which identifies the quantity.
constexpr struct {
  std::string_view name;
  Quantity quantity;
  Unit unit;
} kUnitHeadings[] = {
    {"seconds", Quantity::time, Unit::second},
    {"sec", Quantity::time, Unit::second},
    {"sekunden", Quantity::time, Unit::second},
    {"segundos", Quantity::time, Unit::second},
    {"secondes", Quantity::time, Unit::second},
    {"secondi", Quantity::time, Unit::second},
    {"ms", Quantity::time, Unit::millisecond},
    {"msec", Quantity::time, Unit::millisecond},
    {"milliseconds", Quantity::time, Unit::millisecond},
    {"us", Quantity::time, Unit::microsecond},
    {"usec", Quantity::time, Unit::microsecond},
    {"microseconds", Quantity::time, Unit::microsecond},
    {"nanoseconds", Quantity::time, Unit::nanosecond},
    {"minutes", Quantity::time, Unit::minute},
    {"hours", Quantity::time, Unit::hour},
    {"cycles", Quantity::time, Unit::cycle},
    {"mw", Quantity::P, Unit::megawatt},
    {"mvar", Quantity::Q, Unit::megavar},
    {"hz", Quantity::f, Unit::hertz},
    {"kv", Quantity::V, Unit::kilovolt},
};

const Alias* find_alias(std::string_view name) {
  const auto found = std::ranges::find(kAliases, name, &Alias::name);
  return found == std::end(kAliases) ? nullptr : &*found;
}
/// Returns the meaning of a column; `named` is its unit as written in the file.
ColumnMeaning meaning(const Alias& alias, std::string_view named) {
  std::optional<Unit> unit = find_unit(named);
  if (unit && !fits(alias.quantity, *unit)) unit.reset();
  ColumnMeaning m{alias.quantity, unit, alias.deviation, {}, false};
  m.unknown_unit = !unit && !normalised(named).empty() && !is_clock_word(named);
  return m;
}

/// Parses "V (kV)" or "P [MW]": the name and the unit in brackets.
std::optional<ColumnMeaning> bracketed(std::string_view heading) {
  const char last = heading.empty() ? '\0' : heading.back();
  if (last != ')' && last != ']') return std::nullopt;
  const auto open = heading.find(last == ')' ? '(' : '[');
  if (open == std::string_view::npos) return std::nullopt;
  const Alias* alias = find_alias(normalised(heading.substr(0, open)));
  if (!alias) return std::nullopt;
  return meaning(*alias, heading.substr(open + 1, heading.size() - open - 2));
}

/// Parses "V_kV_ln", "theta deg", "P/MW", "Time, s", "time in ms": the longest ending that is a unit.
std::optional<ColumnMeaning> suffixed(std::string_view heading) {
  constexpr std::string_view between = "_ /-,";
  for (std::size_t at = heading.find_first_of(between); at != std::string_view::npos;
       at = heading.find_first_of(between, at + 1)) {
    const Alias* alias = find_alias(normalised(heading.substr(0, at)));
    const auto unit = find_unit(heading.substr(at + 1));
    if (alias && unit && fits(alias->quantity, *unit)) return meaning(*alias, heading.substr(at + 1));
  }
  return std::nullopt;
}

std::optional<ColumnMeaning> without_terminal(std::string_view heading, std::string_view unit) {
  if (const auto m = bracketed(heading)) return m;
  if (const auto m = suffixed(heading)) return m;
  const std::string name = normalised(heading);
  if (const Alias* alias = find_alias(name)) return meaning(*alias, unit);
  for (const auto& u : kUnitHeadings)
    if (name == u.name) return ColumnMeaning{u.quantity, u.unit, false, {}, false};
  if (auto m = phase_meaning(heading, unit)) return m;
  // A known name with an unknown ending is reported rather than ignored.
  if (const auto at = heading.find('_'); at != std::string_view::npos)
    if (const Alias* alias = find_alias(normalised(heading.substr(0, at))))
      return meaning(*alias, heading.substr(at + 1));
  return std::nullopt;
}

}  // namespace

std::optional<ColumnMeaning> quantity_of(std::string_view word) {
  const Alias* alias = find_alias(normalised(word));
  return alias ? std::optional(meaning(*alias, {})) : std::nullopt;
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
  if (word == "ANGL" && !id.empty()) return std::nullopt;  // rotor angle, not that of the bus voltage
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

std::string_view word_of(Quantity q) {
  constexpr std::string_view words[kQuantities] = {"t",   "V", "theta", "f",  "P",    "Q",  "speed", "Efd",
                                                   "Ifd", "I", "phi",   "Vs", "Vref", "Pm", "Pref",  "gate"};
  return words[static_cast<int>(q)];
}

std::string names_of(Quantity q) {
  constexpr std::string_view names[kQuantities] = {
      "t_s, t_ms, t_us, t_ns, t_min, t_h, t_cycles",
      "V_pu, V_kV, V_kV_ln",
      "theta_rad, theta_deg",
      "f_pu, f_hz",
      "P_pu, P_MW",
      "Q_pu, Q_Mvar",
      "omega_pu, speed_pu",
      "Efd_pu, Efd_V",
      "Ifd_pu, Ifd_A",
      "I_pu, I_A, I_kA",
      "phi_rad, phi_deg",
      "Vs_pu",
      "Vref_pu",
      "Pm_pu, Pm_MW",
      "Pref_pu, Pref_MW",
      "gate_pu",
  };
  return std::string(names[static_cast<int>(q)]);
}

}  // namespace swingbank::validate::record
