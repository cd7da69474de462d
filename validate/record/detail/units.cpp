#include "validate/record/detail/units.hpp"

#include <algorithm>
#include <cctype>
#include <numbers>

#include "base/constants.hpp"
#include "validate/record/detail/columns.hpp"

namespace swingbank::validate::record {
namespace {

/// Names of units, normalised, in English, German, French, Spanish, Portuguese, Italian and Russian.
constexpr struct {
  Unit unit;
  std::string_view names;
} kUnits[] = {
    {Unit::second,
     "s sec secs second seconds sek sekunde sekunden seconde secondes segundo segundos seg secondi с сек"},
    {Unit::millisecond,
     "ms msec msecs millis millisec millisecond milliseconds millisekunden millisecondes milisegundos "
     "milissegundos millisecondi мс"},
    {Unit::microsecond,
     "us usec usecs micros microsec microsecond microseconds mikrosekunden microsecondes microsegundos "
     "microssegundos microsecondi мкс"},
    {Unit::nanosecond, "ns nsec nanos nanosec nanosecond nanoseconds nanosekunden nanosecondes нс"},
    {Unit::minute, "min mins minute minutes minuten minuto minutos minuti мин"},
    {Unit::hour, "h hr hrs hour hours stunden heures horas ore ч"},
    {Unit::day, "d day days tage jours dias giorni"},
    {Unit::cycle, "cycle cycles cyc cycl perioden"},
    {Unit::pu, "pu perunit"},
    {Unit::kilovolt, "kv kvolt kvolts kilovolt kilovolts"},
    {Unit::volt, "v volt volts"},
    {Unit::radian, "rad radian radians"},
    {Unit::degree, "deg degs degree degrees grad °"},
    {Unit::hertz, "hz hertz"},
    {Unit::millihertz, "mhz millihertz"},
    {Unit::gigawatt, "gw gwatt gwatts gigawatt gigawatts"},
    {Unit::megawatt, "mw mwatt mwatts megawatt megawatts"},
    {Unit::kilowatt, "kw kwatt kwatts kilowatt kilowatts"},
    {Unit::watt, "w watt watts"},
    {Unit::gigavar, "gvar gvars gigavar gigavars"},
    {Unit::megavar, "mvar mvars megavar megavars"},
    {Unit::kilovar, "kvar kvars kilovar kilovars"},
    {Unit::var, "var vars"},
    {Unit::kiloampere, "ka kamp kamps kiloamp kiloamps kiloampere kiloamperes"},
    {Unit::ampere, "a amp amps ampere amperes"},
};
/// Ignored qualifiers after a unit, then qualifiers after a voltage unit that state line to line or line to
/// neutral.
constexpr std::string_view kIdleBehindUnits =
    "pos positive seq sequence rms prim primary utc gmt local unix epoch since from after start trigger "
    "event 1970";
constexpr std::string_view kLine = "ll linetoline lineline pp phasetophase phasephase phph";
constexpr std::string_view kNeutral =
    "ln linetoneutral lineneutral lg linetoground lineground le linetoearth pn phn phasetoneutral phaseneutral "
    "pg phg phasetoground phaseground";

std::optional<Unit> unit_named(std::string_view name) {
  const auto* found = std::ranges::find_if(kUnits, [&](const auto& u) { return is_word_of(name, u.names); });
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->unit);
}

}  // namespace

bool fits(Quantity q, Unit u) {
  switch (q) {
    case Quantity::time:
      return u <= Unit::stamp;
    case Quantity::V:
      return u == Unit::pu || u == Unit::kilovolt || u == Unit::volt || u == Unit::kilovolt_ln ||
             u == Unit::volt_ln;
    case Quantity::theta:
    case Quantity::phi:
      return u == Unit::radian || u == Unit::degree;
    case Quantity::f:
      return u == Unit::pu || u == Unit::hertz || u == Unit::millihertz;
    case Quantity::Q:
      return u == Unit::pu || u == Unit::gigavar || u == Unit::megavar || u == Unit::kilovar ||
             u == Unit::var;
    case Quantity::I:
      return u == Unit::pu || u == Unit::kiloampere || u == Unit::ampere;
    case Quantity::P:
    case Quantity::Pm:
    case Quantity::Pref:
      return u == Unit::pu || u == Unit::gigawatt || u == Unit::megawatt || u == Unit::kilowatt ||
             u == Unit::watt;
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

bool is_word_of(std::string_view word, std::string_view list) {
  for (std::size_t at = list.find(word); !word.empty() && at != std::string_view::npos;
       at = list.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ' ')) return true;
  }
  return false;
}

std::optional<Unit> find_unit(std::string_view text) {
  if (const auto whole = unit_named(normalised(text))) return whole;
  constexpr std::string_view between = " ,;_-/.()[]";
  std::optional<Unit> unit;
  std::string behind;
  while (true) {
    const auto begin = text.find_first_not_of(between);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(between), text.size());
    const std::string word = normalised(text.substr(0, end));
    text.remove_prefix(end);
    if (unit)
      behind += is_word_of(word, kIdleBehindUnits) ? std::string() : word;
    else if (word != "in" && !(unit = unit_named(word)))
      return std::nullopt;
  }
  if (behind.empty() || !unit) return unit;
  if (unit != Unit::kilovolt && unit != Unit::volt) return std::nullopt;
  if (is_word_of(behind, kLine)) return unit;
  if (!is_word_of(behind, kNeutral)) return std::nullopt;
  return unit == Unit::kilovolt ? Unit::kilovolt_ln : Unit::volt_ln;
}

bool is_unit(std::string_view text) { return find_unit(text).has_value(); }

std::string normalised(std::string_view text) {
  // Plain forms of the accented letters from U+00C0 on; a blank marks characters without a plain form.
  constexpr std::string_view plain = "aaaaaaaceeeeiiiidnooooo ouuuuypsaaaaaaaceeeeiiiidnooooo ouuuuypy";
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (c < 0x80) {
      if (std::isalnum(c) != 0) name += static_cast<char>(std::tolower(c));
      continue;
    }
    if ((c == 0xC2 && next == 0xB5) || (c == 0xCE && next == 0xBC)) {  // micro sign, Greek mu
      name += 'u', ++i;
    } else if (c == 0xC2 && next == 0xA0) {  // no-break space
      ++i;
    } else if (c == 0xC3 && next >= 0x80) {
      const char letter = plain[next - 0x80U];
      if (letter != ' ') name += letter;
      ++i;
    } else if (c == 0xD0 && next >= 0x90 && next < 0xA0) {  // Cyrillic capitals
      name += text[i], name += static_cast<char>(next + 0x20), ++i;
    } else if (c == 0xD0 && next >= 0xA0 && next < 0xB0) {
      name += static_cast<char>(0xD1), name += static_cast<char>(next - 0x20), ++i;
    } else {
      name += text[i];
    }
  }
  return name;
}

bool is_clock_word(std::string_view text) {
  const std::string word = normalised(text);
  for (const std::string_view begin : {"utc", "gmt", "hh", "yyyy", "dd", "mm"})
    if (word.starts_with(begin)) return true;
  return is_word_of(
      word,
      "local cet cest mez mesz est edt cst cdt mst mdt pst pdt stamp date clock unix epoch posix "
      "serial datenum");
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

/// Converts field voltage and current from the record's unit (pu, V, A) to the model's pu.
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
    case Unit::nanosecond:
      return v * 1e-9;
    case Unit::minute:
      return v * 60;
    case Unit::hour:
      return v * 3600;
    case Unit::day:
      return v * 86400;
    case Unit::cycle:
      return v / base.frequency;
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
    case Unit::millihertz:
      return v * 1e-3 / base.frequency - (column.deviation ? 0 : 1);
    case Unit::gigawatt:
    case Unit::gigavar:
      return v * 1e3 / base.mva;
    case Unit::megawatt:
    case Unit::megavar:
      return v / base.mva;
    case Unit::kilowatt:
    case Unit::kilovar:
      return v * 1e-3 / base.mva;
    case Unit::watt:
    case Unit::var:
      return v * 1e-6 / base.mva;
    case Unit::kiloampere:
      return v * std::numbers::sqrt3 * base.kv / base.mva;
    case Unit::ampere:
      return v * 1e-3 * std::numbers::sqrt3 * base.kv / base.mva;
  }
  return v;
}

}  // namespace swingbank::validate::record
