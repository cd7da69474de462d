#pragma once
// Units of measured quantities: their names in headings, and how names are compared.
#include <optional>
#include <string>
#include <string_view>

namespace swingbank::validate::record {

enum class Quantity { time, V, theta, f, P, Q, speed, Efd, Ifd, I, phi, Vs, Vref, Pm, Pref, gate };
constexpr int kQuantities = 16;
/// Whether only components are driven by it or compared with it: such columns of other records are left out.
constexpr bool is_inner(Quantity q) { return q >= Quantity::Vs; }
enum class Unit {
  second,
  millisecond,
  microsecond,
  nanosecond,
  minute,
  hour,
  day,
  cycle,  ///< of the nominal frequency
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
  megawatt,
  kilowatt,
  watt,
  megavar,
  kilovar,
  var,
  kiloampere,
  ampere
};

/// A unit, with words behind it that may stand there: "kV L-L", "kV_ln", "pu, pos. seq.", "ms since epoch".
/// None: it is no unit, or words behind it are not known ("kV peak").
std::optional<Unit> find_unit(std::string_view text);
/// Is the text a unit we know ("kV", "deg.", "p.u.")?
bool is_unit(std::string_view text);
/// Whether values of the quantity may be written in the unit.
bool fits(Quantity quantity, Unit unit);

/// Whether a heading names a clock, a zone or a pattern where others have the unit: "Time (UTC)",
/// "Time (hh:mm:ss)".
bool is_clock_word(std::string_view text);

/// Does the quantity in that unit need base.kv?
bool needs_kv(Quantity quantity, Unit unit);
/// The key of the plant file under [record] that the quantity in that unit needs: "efd_base"; empty: none.
std::string_view needs_base(Quantity quantity, Unit unit);

/// Lower case without accents, letters and digits only ("°" counts as a letter): how names are compared.
std::string normalised(std::string_view text);
/// Whether `list`, words divided by blanks, has the word.
bool is_word_of(std::string_view word, std::string_view list);

}  // namespace swingbank::validate::record
