#pragma once
// The shards of a dataset from memory: simulated, handed over, forgotten. What is in them is what `generate`
// would have written, to the last bit.
#include <deque>
#include <memory>

#include "mpi/draw/databank.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::draw {

class ShardMaker;

class SimulatedShards {
 public:
  /// Draws the databank. `threads` shards are made at once. Throws InputError as load_study and draw_databank
  /// do, and where a signal asked for an end meanwhile.
  SimulatedShards(const DatasetConfig& config, int threads);
  ~SimulatedShards();
  SimulatedShards(const SimulatedShards&) = delete;
  SimulatedShards& operator=(const SimulatedShards&) = delete;
  [[nodiscard]] const store::DatasetHeader& header() const { return header_; }
  /// The next shard, from number 0 on, header().shard_count() in all.
  store::ShardData next();

 private:
  void simulate_ahead();
  store::ShardData make(ShardMaker& maker, std::uint64_t shard) const;

  Study study_;
  store::ShardAttributes attributes_;
  store::DatasetHeader header_;
  Databank bank_;
  std::vector<std::unique_ptr<ShardMaker>> makers_;  ///< one a thread
  std::deque<store::ShardData> ahead_;
  std::uint64_t made_ = 0;
};

}  // namespace swingbank::mpi::draw
