#pragma once
// Error of combined estimates from several test rows of one plant, by the number of combined records.
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// Returns the test rows of each plant (one generator with the same parameters) that has at least three, as
/// indices into `rows`.
std::vector<std::vector<std::size_t>> plants_of(const data::Labels& labels,
                                                std::span<const std::uint64_t> rows);

/// Function that estimates a plant's parameters [raw units] from several test rows.
using FromSeveral = std::function<std::vector<double>(std::span<const std::size_t>)>;

/// Returns the key `several` of train/run/README.md; null if no plant has three records. `estimates`: rows x
/// parameters [raw units]; their mean is one combined estimate. `product`: a second combined estimate, from
/// the posteriors; empty: none.
nlohmann::json several_json(const data::Labels& labels, std::span<const std::uint64_t> rows,
                            std::span<const double> estimates, const FromSeveral& product = {});

}  // namespace swingbank::train::run
