#pragma once
// Header of a dataset (dataset.json): the properties common to all shards, computed from the study.
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::draw {

/// Returns the header of a study's dataset. `a`: result of shard_attributes.
store::DatasetHeader dataset_header(const Study& study, const store::ShardAttributes& a);

}  // namespace swingbank::mpi::draw
