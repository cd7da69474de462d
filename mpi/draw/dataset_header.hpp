#pragma once
// What dataset.json says of a study: all that is common to the shards of its dataset.
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::draw {

/// `a`: as shard_attributes gives them.
store::DatasetHeader dataset_header(const Study& study, const store::ShardAttributes& a);

}  // namespace swingbank::mpi::draw
