#pragma once
// Simulates a range of draws and lays their records out as rows of a shard.
#include <functional>
#include <map>
#include <memory>

#include "mpi/draw/sampler.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::draw {

class ShardMaker {
 public:
  ShardMaker(const Study& study, const Databank& bank);
  /// Simulates draws first ... first+count-1. Rows come in order of (sample_id, generator), attributes unset.
  /// `tick` is called now and then, with the number of draws finished since the last call.
  store::ShardData make(std::uint64_t first, std::uint64_t count,
                        const std::function<void(std::uint64_t)>& tick);

 private:
  struct Slots;
  [[nodiscard]] sim::lanes::Batch& batch_for(std::size_t generator);
  void run(Slots& slots, std::vector<std::uint64_t> ids, sim::lanes::Batch& batch,
           const std::function<void(std::uint64_t)>& tick);
  void keep(Slots& slots, const sim::lanes::Job& job, const sim::Trajectory& t) const;
  void keep_row(Slots& slots, std::size_t slot, const sim::Trajectory& t, std::size_t plant) const;
  [[nodiscard]] store::ShardData compact(Slots& slots) const;

  const Study& study_;
  const Databank& bank_;
  Sampler sampler_;
  std::vector<sim::Channel>
      simulated_;                  ///< what the kernel records: the config's channels, V and theta if needed
  std::vector<int> source_;        ///< per channel of the config: position in simulated_, or -1: frequency
  int voltage_ = -1, angle_ = -1;  ///< positions in simulated_
  bool angle_recorded_ = false;
  std::map<std::size_t, std::unique_ptr<sim::lanes::Batch>>
      batches_;  ///< by generator; one under 0 if all vary
};

/// The kernel's options for a config; one place, so that its variant is what the config hash says.
sim::lanes::BatchOptions batch_options(const DatasetConfig& config);
/// Batch::variant() for a config.
std::string kernel_variant(const Study& study);
/// Channel, parameter and other attributes of every shard of a dataset.
store::ShardAttributes shard_attributes(const Study& study, const std::string& hash,
                                        const std::string& kernel);

}  // namespace swingbank::mpi::draw
