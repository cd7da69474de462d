#pragma once
// Which quantity and unit a column's name means. The tables here are the documentation's source
// (validate/record/README.md).
#include <optional>
#include <string>
#include <string_view>

#include "validate/record/detail/phase.hpp"
#include "validate/record/detail/units.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

struct ColumnMeaning {
  Quantity quantity;
  std::optional<Unit> unit;  ///< none: a known quantity whose unit is missing or not known
  bool deviation = false;    ///< values are deviations from nominal (speed), not 1 at nominal (omega)
  std::string terminal;      ///< prefix of the name: "G2" of "G2.V_pu"
  bool negated = false;      ///< the file's values have the other sign
  /// A unit is named, and it is none of the quantity's: values of a time without a unit may tell it, of a
  /// time with an unknown one they may not.
  bool unknown_unit = false;
  std::optional<Phase> phase = {};  ///< of one phase of three; none: the positive sequence
};

/// What a heading means: "V_pu", "V (kV)", "P [MW]", "G2.theta_rad", or "VOLTAGE_MAG" where another header
/// line gives `unit`. Case, blanks, '_' and '-' within names do not matter. None: not a quantity we read.
std::optional<ColumnMeaning> column_meaning(std::string_view heading, std::string_view unit = {});

/// The quantity that a person's word means ("V", "omega"), without unit.
std::optional<ColumnMeaning> quantity_of(std::string_view word);

/// A unit of the quantity: `unit` where that is one, or the one with which the heading ends ("BUS1_kV",
/// "GSU_T1.MW", "Pgen [MW]").
std::optional<Unit> unit_in(Quantity quantity, std::string_view heading, std::string_view unit);

/// A channel of PSS/E as dyntools exports it: "VOLT 32 [NORTH 20.0]" is of terminal "32", "POWR 32 1" of
/// "32/1".
std::optional<ColumnMeaning> psse_channel(std::string_view heading);

/// The quantity's name in a map of columns: "V".
std::string_view word_of(Quantity q);

/// Names a column of the quantity can have, with units: "P_pu, P_MW".
std::string names_of(Quantity q);

/// Brings a value to the record's units: s, pu, rad; frequency and speed to deviations [pu].
double to_record_units(const ColumnMeaning& column, double value, const RecordBase& base);

}  // namespace swingbank::validate::record
