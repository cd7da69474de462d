#pragma once
// Meaning of column names: quantity and unit. validate/record/README.md explains the columns.
#include <optional>
#include <string>
#include <string_view>

#include "validate/record/detail/phase.hpp"
#include "validate/record/detail/units.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

struct ColumnMeaning {
  Quantity quantity;
  std::optional<Unit> unit;  ///< none: unit missing or unknown
  bool deviation = false;    ///< values are deviations from nominal (speed), not 1 at nominal (omega)
  std::string terminal;      ///< prefix of the name: "G2" of "G2.V_pu"
  bool negated = false;      ///< the file's sign is opposite
  /// Whether the given unit does not belong to the quantity. A missing time unit is inferred from the values,
  /// but an unknown time unit is not.
  bool unknown_unit = false;
  std::optional<Phase> phase = {};  ///< phase of a three-phase quantity; none: positive sequence
};

/// Returns the meaning of a heading: "V_pu", "V (kV)", "P [MW]", "G2.theta_rad", or "VOLTAGE_MAG" with `unit`
/// from another header line. Case, blanks, '_' and '-' are ignored. Returns no value for other headings.
std::optional<ColumnMeaning> column_meaning(std::string_view heading, std::string_view unit = {});

/// Returns the quantity denoted by a user's word ("V", "omega"), without unit.
std::optional<ColumnMeaning> quantity_of(std::string_view word);

/// Returns the unit of a column: `unit` if the quantity can have it, otherwise the unit at the end of the
/// heading ("BUS1_kV", "GSU_T1.MW", "Pgen [MW]").
std::optional<Unit> unit_in(Quantity quantity, std::string_view heading, std::string_view unit);

/// Returns the meaning of a PSS/E channel as exported by dyntools: "VOLT 32 [NORTH 20.0]" belongs to terminal
/// "32", "POWR 32 1" to "32/1".
std::optional<ColumnMeaning> psse_channel(std::string_view heading);

/// Returns the quantity's name in a column map: "V".
std::string_view word_of(Quantity q);

/// Returns the column names of the quantity with units: "P_pu, P_MW".
std::string names_of(Quantity q);

/// Converts a value to the record's units: s, pu, rad; frequency and speed to deviations [pu].
double to_record_units(const ColumnMeaning& column, double value, const RecordBase& base);

}  // namespace swingbank::validate::record
