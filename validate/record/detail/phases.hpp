#pragma once
// Columns of phasors of three phases, as phasor measurement units stream them: found by name, kept where the
// positive sequence is not given, and combined to it.
#include <string>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// "Va_mag", "VA_Ang (deg)", "IC_M", "PhA Voltage Magnitude", "Vab_kV": magnitude or angle of one phase, or
/// of the voltage between two. A magnitude to neutral has the unit of one to neutral. None: it is no such
/// column.
std::optional<ColumnMeaning> phase_meaning(std::string_view heading, std::string_view unit);

/// Takes the meaning from columns of phases that are not needed: of an incomplete set, or where the file
/// gives the positive sequence, or P and Q beside the current.
void keep_needed_phases(std::vector<Heading>& headings);

/// Whether the values tell the unit: magnitudes and angles of three phases, and a frequency.
bool is_unit_in_values(const Heading& heading);

/// Settles the units that the headings lack by the values, and puts the positive sequence in the place of
/// three phases [pu, rad]. What was taken is noted. Throws InputError where no unit fits, or where the phases
/// follow one another in the order A-C-B.
void combine_phases(RawRecord& raw, const RecordBase& base, const std::string& file);

}  // namespace swingbank::validate::record
