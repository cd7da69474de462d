#pragma once
// List of all thresholds in the order of their definition, and their JSON.
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "validate/thresholds/adequacy.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {

/// Returns all thresholds.
std::vector<Threshold> all_thresholds();
/// Returns all thresholds as [{"name", "value", "unit", "why"}].
nlohmann::json thresholds_json();
/// Returns {"criterion", "quantity", "adequate", "value", "limit", "unit", "where"}; value null if not
/// finite.
nlohmann::json ruling_json(const Ruling& ruling);

}  // namespace swingbank::validate::thresholds
