#pragma once
// Shards simulated in memory instead of read from files. Their content equals that of the files of `generate`
// to the last bit.
#include <deque>
#include <memory>

#include "mpi/draw/databank.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::draw {

class ShardMaker;

/// Sequence of simulated shards.
class SimulatedShards {
 public:
  /// Draws the databank. `threads`: number of shards simulated concurrently. Throws the errors of load_study
  /// and draw_databank, and InputError after a stop signal.
  SimulatedShards(const DatasetConfig& config, int threads);
  ~SimulatedShards();
  SimulatedShards(const SimulatedShards&) = delete;
  SimulatedShards& operator=(const SimulatedShards&) = delete;
  [[nodiscard]] const store::DatasetHeader& header() const { return header_; }
  /// Returns the next shard, from number 0 to header().shard_count() - 1. Throws InputError after a stop
  /// signal.
  store::ShardData next();

 private:
  void simulate_ahead();
  store::ShardData make(ShardMaker& maker, std::uint64_t shard) const;

  Study study_;
  store::ShardAttributes attributes_;
  store::DatasetHeader header_;
  Databank bank_;
  std::vector<std::unique_ptr<ShardMaker>> makers_;  ///< one per thread
  std::deque<store::ShardData> ahead_;
  std::uint64_t made_ = 0;
};

}  // namespace swingbank::mpi::draw
