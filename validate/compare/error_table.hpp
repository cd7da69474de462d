#pragma once
// RMS, noise and their ratio of every event and channel: the one table and the one JSON of all commands.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/played.hpp"

namespace swingbank::validate::compare {

/// One row per event and channel, for each model RMS, noise σ and RMS / noise of the whole record
/// (WindowError, ChannelComparison); of a single model the largest error too. `unseen`: names of the records
/// that were not fitted to.
report::Table error_table(const std::vector<Played>& played, const std::vector<std::string>& unseen = {});
/// The same as the terminal prints it, below its caption.
std::string error_text(const std::vector<Played>& played, const std::vector<std::string>& unseen = {});
/// Rows of record, channel, model, unit, rms, noise and rms_over_noise (null without noise).
nlohmann::json errors_json(const std::vector<Played>& played);

}  // namespace swingbank::validate::compare
