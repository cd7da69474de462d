#pragma once
// Test rows of one plant taken together: how the error falls with the number of its records.
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// The test rows of each plant, as places in `rows`: those of one generator with the same parameters, where
/// there are three or more.
std::vector<std::vector<std::size_t>> plants_of(const data::Labels& labels,
                                                std::span<const std::uint64_t> rows);

/// A plant's parameters, raw units, from rows of the test together.
using FromSeveral = std::function<std::vector<double>(std::span<const std::size_t>)>;

/// Key `several` of train/run/README.md; null if no plant has three records. `estimates`: rows x parameters,
/// raw units; their mean is one estimate from several. `product`: another, of beliefs; empty: there are none.
nlohmann::json several_json(const data::Labels& labels, std::span<const std::uint64_t> rows,
                            std::span<const double> estimates, const FromSeveral& product = {});

}  // namespace swingbank::train::run
