#pragma once
// Units of measured quantities: names in headings, and comparison of names.
#include <optional>
#include <string>
#include <string_view>

namespace swingbank::validate::record {

enum class Quantity { time, V, theta, f, P, Q, speed, Efd, Ifd, I, phi, Vs, Vref, Pm, Pref, gate };
constexpr int kQuantities = 16;
/// Returns whether only records of a component (exciter, governor, machine) use the quantity. Records of a
/// plant ignore its column.
constexpr bool is_inner(Quantity q) { return q >= Quantity::Vs; }
enum class Unit {
  second,
  millisecond,
  microsecond,
  nanosecond,
  minute,
  hour,
  day,
  cycle,  ///< cycle of the nominal frequency
  stamp,
  pu,
  kilovolt,
  volt,
  kilovolt_ln,
  volt_ln,
  radian,
  degree,
  hertz,
  millihertz,
  gigawatt,
  megawatt,
  kilowatt,
  watt,
  gigavar,
  megavar,
  kilovar,
  var,
  kiloampere,
  ampere
};

/// Parses a unit with optional qualifiers: "kV L-L", "kV_ln", "pu, pos. seq.", "ms since epoch". Returns no
/// value if the text is not a unit or contains an unknown qualifier ("kV peak").
std::optional<Unit> find_unit(std::string_view text);
/// Returns whether the text is a known unit ("kV", "deg.", "p.u.").
bool is_unit(std::string_view text);
/// Returns whether values of the quantity may be written in the unit.
bool fits(Quantity quantity, Unit unit);

/// Returns whether a heading names a clock, a zone or a pattern in place of the unit: "Time (UTC)",
/// "Time (hh:mm:ss)".
bool is_clock_word(std::string_view text);

/// Returns whether the quantity in that unit requires base.kv.
bool needs_kv(Quantity quantity, Unit unit);
/// Returns the key under [record] of the plant file that the quantity in that unit requires, such as
/// "efd_base"; empty if it requires none.
std::string_view needs_base(Quantity quantity, Unit unit);

/// Returns the text for comparison of names: lower case without accents, letters and digits only ("°" counts
/// as a letter).
std::string normalised(std::string_view text);
/// Returns whether `list`, words separated by blanks, contains the word.
bool is_word_of(std::string_view word, std::string_view list);

}  // namespace swingbank::validate::record
