#pragma once
// Combination of test rows of one plant: error as a function of the number of records.
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// Returns the test rows of each plant (one generator, the same parameters) with three rows or more, as
/// positions in `rows`.
std::vector<std::vector<std::size_t>> plants_of(const data::Labels& labels,
                                                std::span<const std::uint64_t> rows);

/// Estimates a plant's parameters [raw units] from several test rows.
using FromSeveral = std::function<std::vector<double>(std::span<const std::size_t>)>;

/// Returns the key `several` of train/run/README.md; null if no plant has three records. `estimates`: rows x
/// parameters [raw units], whose mean is one combined estimate. `product`: another, by posteriors; empty:
/// none.
nlohmann::json several_json(const data::Labels& labels, std::span<const std::uint64_t> rows,
                            std::span<const double> estimates, const FromSeveral& product = {});

}  // namespace swingbank::train::run
