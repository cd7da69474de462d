#pragma once
// Voltage and frequency as simulators play them back: PSS/E's .plb (model PLBVFU1) and PowerWorld's play-in
// signals.
#include <string>
#include <string_view>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// A name that ends in .plb.
bool is_plb(const std::string& name);
/// Does the text define PowerWorld's play-in signals: DATA (PLAYINSIGNAL, [TSName, TSTime, TSSignal,
/// TSSignal:1])?
bool is_powerworld(std::string_view text);

/// Time [s], voltage, frequency, at any distance of the samples. Neither file names units: which they are is
/// told by the values, and notes say so. Throws InputError with every fault.
Record playback_record(std::string_view text, const std::string& name, const RecordBase& base,
                       const ReadOptions& options);

}  // namespace swingbank::validate::record
