#pragma once
// Table and JSON of RMS, noise and RMS / noise per event and channel, common to all commands.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/event_use.hpp"
#include "validate/compare/played.hpp"

namespace swingbank::validate::compare {

/// Table with one row per event and channel: RMS, noise σ and RMS / noise of the whole record for each model
/// (WindowError, ChannelComparison). For a single model it also has the maximum error. After a fit, a column
/// shows the use of each event.
report::Table error_table(const std::vector<Played>& played, const EventUse& use = {});
/// The same table as terminal text below its caption.
std::string error_text(const std::vector<Played>& played, const EventUse& use = {});
/// JSON rows: record, channel, model, unit, rms, noise and rms_over_noise (null without noise).
nlohmann::json errors_json(const std::vector<Played>& played);

}  // namespace swingbank::validate::compare
