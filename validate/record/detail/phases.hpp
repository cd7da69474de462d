#pragma once
// Columns of three-phase phasors from phasor measurement units, and their combination to the positive
// sequence.
#include <string>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Returns the meaning of "Va_mag", "VA_Ang (deg)", "IC_M", "PhA Voltage Magnitude" or "Vab_kV": magnitude or
/// angle of one phase, or of a line-to-line voltage. The unit kV or V of a voltage to neutral becomes
/// kilovolt_ln or volt_ln. Returns no value for any other heading.
std::optional<ColumnMeaning> phase_meaning(std::string_view heading, std::string_view unit);

/// Clears the meaning of unneeded phase columns: incomplete sets, line-to-line voltages beside complete
/// voltages to neutral, all phases of a quantity whose positive sequence the file contains, and currents if
/// it contains P and Q.
void keep_needed_phases(std::vector<Heading>& headings);

/// Returns true if the unit of a column can be inferred from its values: for magnitudes and angles of three
/// phases, and for a frequency.
bool is_unit_in_values(const Heading& heading);

/// Infers units missing in the headings from the values, and replaces three phases by the positive sequence
/// [pu, rad]. The result is noted. Throws InputError if no unit fits, the phase sequence is A-C-B or one
/// phase is reversed.
void combine_phases(RawRecord& raw, const RecordBase& base, const std::string& file);

}  // namespace swingbank::validate::record
