#pragma once
// Readers of playback files of simulators: PSS/E's .plb (model PLBVFU1) and PowerWorld's play-in signals.
#include <string>
#include <string_view>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// Returns whether the name ends in .plb.
bool is_plb(const std::string& name);
/// Returns whether the text defines PowerWorld's play-in signals: DATA (PLAYINSIGNAL, [TSName, TSTime,
/// TSSignal, TSSignal:1]).
bool is_powerworld(std::string_view text);

/// Reads time [s], voltage and frequency at arbitrary sample times. Neither format states units; they are
/// inferred from the values and noted. Throws InputError with every fault.
Record playback_record(std::string_view text, const std::string& name, const RecordBase& base,
                       const ReadOptions& options);

}  // namespace swingbank::validate::record
