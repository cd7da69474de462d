#pragma once
// Simulation of a range of draws (simulated events) and arrangement of the records as rows of a shard.
#include <functional>
#include <map>
#include <memory>

#include "mpi/draw/sampler.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::draw {

/// Simulator of shards.
class ShardMaker {
 public:
  ShardMaker(const Study& study, const Databank& bank);
  /// Simulates draws first ... first+count-1. Returns the rows in order of (sample_id, generator), without
  /// attributes. Calls `tick` repeatedly with the number of draws finished since the last call.
  store::ShardData make(std::uint64_t first, std::uint64_t count,
                        const std::function<void(std::uint64_t)>& tick);

 private:
  struct Slots;
  [[nodiscard]] sim::batch::Batch& batch_for(std::size_t generator);
  void run(Slots& slots, std::vector<std::uint64_t> ids, sim::batch::Batch& batch,
           const std::function<void(std::uint64_t)>& tick);
  void keep(Slots& slots, const sim::batch::Job& job, const sim::Trajectory& t) const;
  void keep_row(Slots& slots, std::size_t slot, const sim::Trajectory& t, std::size_t plant) const;
  [[nodiscard]] store::ShardData compact(Slots& slots) const;

  const Study& study_;
  const Databank& bank_;
  Sampler sampler_;
  /// Channels that the kernel records: those of the config, plus V and theta if frequency or theta is one of
  /// them.
  std::vector<sim::Channel> simulated_;
  std::vector<int> source_;        ///< index into simulated_ of each channel of the config; -1: frequency
  int voltage_ = -1, angle_ = -1;  ///< indices into simulated_
  bool angle_recorded_ = false;
  /// SIMD batch of events for each generator whose parameters are drawn; a single batch with key 0 if the
  /// parameters of all generators are drawn in every event.
  std::map<std::size_t, std::unique_ptr<sim::batch::Batch>> batches_;
};

/// Returns the options of the SIMD kernel for a config. They determine the kernel's variant
/// (Batch::variant()), which is part of the config hash.
sim::batch::BatchOptions batch_options(const DatasetConfig& config);
/// Returns Batch::variant() for a study.
std::string kernel_variant(const Study& study);
/// Returns the attributes common to all shards of a dataset.
store::ShardAttributes shard_attributes(const Study& study, const std::string& hash,
                                        const std::string& kernel);

}  // namespace swingbank::mpi::draw
