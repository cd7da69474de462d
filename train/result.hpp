#pragma once
// The JSON of one run; its keys stand in README.md.
#include <nlohmann/json_fwd.hpp>

#include "train/run.hpp"

namespace swingbank {

/// The config's name; the folder's, if the dataset was made before headers had a name.
std::string dataset_name(const Dataset& dataset);

/// What tells this run from every other: data, recipe, seed. A checkpoint or result with another identity is
/// not its.
nlohmann::json identity(const ShardStream& stream, const RunRequest& request);

struct RunParts {
  const RowSplit& split;
  const Features& features;
  const LoopReport& report;
  const Score& score;
};
nlohmann::json result_json(const ShardStream& stream, const RunRequest& request, const RunParts& parts);

}  // namespace swingbank
