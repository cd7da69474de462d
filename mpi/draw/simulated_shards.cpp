#include "mpi/draw/simulated_shards.hpp"

#include <algorithm>
#include <future>
#include <utility>

#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "mpi/draw/dataset_header.hpp"
#include "mpi/draw/shard_maker.hpp"

namespace swingbank::mpi::draw {

namespace {

void require_no_stop(const DatasetConfig& config) {
  if (stop_asked())
    throw InputError({"stopped on a signal", config.file.string(), "nothing was trained yet",
                      "run the command again: it starts from the beginning"});
}

}  // namespace

SimulatedShards::SimulatedShards(const DatasetConfig& config, int threads) : study_(load_study(config)) {
  const std::string kernel = kernel_variant(study_);
  attributes_ = shard_attributes(study_, config_hash(config, kernel), kernel);
  header_ = dataset_header(study_, attributes_);
  const auto& base = study_.grid.plants[static_cast<std::size_t>(study_.plants[0])];
  // Runs in a temporary thread, whose OpenMP threads end with it, because a process with OpenMP threads must
  // not fork.
  bank_ = std::async(std::launch::async, [&] {
            return draw_databank(study_.config, base, study_.config.points());
          }).get();
  require_no_stop(config);
  for (int i = 0; i < std::max(1, threads); ++i)
    makers_.push_back(std::make_unique<ShardMaker>(study_, bank_));
}

SimulatedShards::~SimulatedShards() = default;

store::ShardData SimulatedShards::make(ShardMaker& maker, std::uint64_t shard) const {
  const DatasetConfig& c = study_.config;
  const std::uint64_t first = shard * c.draws_per_shard;
  store::ShardData data =
      maker.make(first, std::min(c.draws_per_shard, c.draws - first), [](std::uint64_t) {});
  data.attributes = attributes_;
  data.attributes.shard = shard;
  return data;
}

void SimulatedShards::simulate_ahead() {
  require_no_stop(study_.config);
  const std::uint64_t count = std::min<std::uint64_t>(makers_.size(), header_.shard_count() - made_);
  std::vector<std::future<store::ShardData>> parts;
  for (std::uint64_t k = 0; k < count; ++k)
    parts.push_back(
        std::async(std::launch::async, [this, k, shard = made_ + k] { return make(*makers_[k], shard); }));
  made_ += count;
  for (auto& part : parts) ahead_.push_back(part.get());
}

store::ShardData SimulatedShards::next() {
  if (ahead_.empty()) simulate_ahead();
  store::ShardData data = std::move(ahead_.front());
  ahead_.pop_front();
  return data;
}

}  // namespace swingbank::mpi::draw
