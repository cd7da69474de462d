// Shards in memory do not depend on the number of threads.
#include "mpi/draw/simulated_shards.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace swingbank::mpi::draw {
namespace {

TEST(SimulatedShards, DoNotDependOnTheNumberOfThreads) {
  Overrides o;
  o.draws = 10;
  o.draws_per_shard = 2;
  DatasetConfig c = read_dataset_config(SWINGBANK_SOURCE "/configs/datasets/ieee14_genrou_bus3.toml", o);
  c.record.t_end = 2.0;  // covers the fault; short for speed
  SimulatedShards one(c, 1), three(c, 3);
  ASSERT_EQ(one.header().shard_count(), 5U);
  for (std::uint64_t k = 0; k < one.header().shard_count(); ++k) {
    const store::ShardData a = one.next(), b = three.next();
    EXPECT_EQ(b.attributes.shard, k);
    EXPECT_EQ(a.draw_sample_id, b.draw_sample_id);
    EXPECT_EQ(a.draw_outcome, b.draw_outcome);
    EXPECT_GT(a.rows, 0U);
    EXPECT_EQ(a.parameters, b.parameters);
    EXPECT_EQ(a.records, b.records);
  }
}

}  // namespace
}  // namespace swingbank::mpi::draw
