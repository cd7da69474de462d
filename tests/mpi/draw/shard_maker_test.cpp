#include "mpi/draw/shard_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace swingbank::mpi::draw {
namespace {

constexpr auto no_tick = [](std::uint64_t) {};

/// A dataset config of the project with few draws, its databank and a shard maker.
struct MadeCase {
  Study study;
  Databank bank;
  ShardMaker maker;
  static Study load(const std::string& name, std::uint64_t draws) {
    Overrides o;
    o.draws = draws;
    DatasetConfig c =
        read_dataset_config(std::string(SWINGBANK_SOURCE) + "/configs/datasets/" + name + ".toml", o);
    c.record.t_end = 3.0;  // covers the fault; short for speed
    return load_study(c);
  }
  MadeCase(const std::string& name, std::uint64_t draws)
      : study(load(name, draws)),
        bank(draw_databank(study.config, study.grid.plants[static_cast<std::size_t>(study.plants[0])],
                           study.config.points())),
        maker(study, bank) {}
};

std::size_t channel_index(const MadeCase& c, const std::string& name) {
  const auto& names = c.study.config.record.channels;
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

TEST(Sampling, GeneratorsAlternateAndFaultsShareADatabankPoint) {
  MadeCase c("ieee39_gencls", 40);
  Sampler sampler(c.study, c.bank);
  for (std::uint64_t id = 0; id < 40; ++id) {
    const Draw d = sampler.draw(id);
    EXPECT_EQ(d.recorded, (std::vector<std::size_t>{id % 10}));
    const auto& fault = d.job.event.faults.at(0);
    EXPECT_GE(fault.t_off - fault.t_on, 0.05);
    EXPECT_LE(fault.t_off - fault.t_on, 0.2);
  }
  MadeCase twelve("ieee14_genrou_bus3", 36);
  Sampler shared(twelve.study, twelve.bank);
  EXPECT_EQ(shared.draw(0).job.parameters, shared.draw(11).job.parameters);
  EXPECT_NE(shared.draw(11).job.parameters, shared.draw(12).job.parameters);
  EXPECT_NE(shared.draw(0).job.event.faults[0].t_off, shared.draw(1).job.event.faults[0].t_off);
}

TEST(ShardMaking, RowsEqualRecordsOfTheKernel) {
  MadeCase c("ieee39_gencls", 20);
  const store::ShardData d = c.maker.make(0, 20, no_tick);
  ASSERT_GT(d.rows, 10u);
  Sampler sampler(c.study, c.bank);
  sim::batch::BatchOptions options = batch_options(c.study.config);
  options.lanes = 1;
  sim::batch::Batch alone(
      c.study.grid,
      options);  // every plant and channel, one event at a time (one lane): computes the values independently
  const std::size_t q = channel_index(c, "Q");
  for (std::size_t row = 0; row < d.rows; row += 5) {
    const Draw draw = sampler.draw(d.sample_id[row]);
    bool given = false;
    alone.run([&](sim::batch::Job& job) { return given ? false : (job = draw.job, given = true); },
              [&](const sim::batch::Job&, const sim::Trajectory& t) {
                const double* expected =
                    t.at(c.study.plants[draw.recorded[0]], static_cast<int>(sim::Channel::Q));
                for (std::size_t k = 0; k < d.samples; ++k)
                  // SIMD widths agree to 1e-9, and the record is a float of values up to 10 (1e-6).
                  ASSERT_NEAR(d.records[(row * d.channels + q) * d.samples + k], expected[k], 2e-6) << k;
              });
    EXPECT_EQ(d.generator[row], c.study.config.generators[draw.recorded[0]]);
    EXPECT_EQ(d.parameters[row * 2], c.bank.point(draw.points[0])[0]);
  }
}

TEST(ShardMaking, PartsEqualTheWhole) {
  MadeCase c("ieee39_genrou", 24);
  const store::ShardData whole = c.maker.make(0, 24, no_tick), first = c.maker.make(0, 7, no_tick),
                         rest = c.maker.make(7, 17, no_tick);
  auto hashes = store::row_hashes(first), more = store::row_hashes(rest);
  hashes.insert(hashes.end(), more.begin(), more.end());
  EXPECT_EQ(hashes, store::row_hashes(whole));
}

TEST(ShardMaking, TicksCountEveryRun) {
  MadeCase c("ieee39_gencls", 30);
  std::uint64_t ticks = 0;
  c.maker.make(0, 30, [&](std::uint64_t n) { ticks += n; });
  EXPECT_EQ(ticks, 30u);
}

TEST(ShardMaking, UnstableDrawsAreListedWithoutARow) {
  MadeCase c("ieee39_genrou", 60);
  const store::ShardData d = c.maker.make(0, 60, no_tick);
  ASSERT_EQ(d.draw_outcome.size(), 60u);
  const auto stable = static_cast<std::size_t>(std::ranges::count(d.draw_outcome, 0));
  EXPECT_EQ(d.rows, stable);
  EXPECT_LT(stable, 60u);  // within three seconds some of sixty lose synchronism
  for (std::size_t row = 0; row < d.rows; ++row) EXPECT_EQ(d.draw_outcome[d.sample_id[row]], 0);
  for (const float v : d.records) ASSERT_TRUE(std::isfinite(v));
}

TEST(ShardMaking, AllVaryGivesARowPerGenerator) {
  MadeCase c("ieee39_gencls_all", 6);
  const store::ShardData d = c.maker.make(0, 6, no_tick);
  ASSERT_EQ(d.rows % 10, 0u);
  ASSERT_GE(d.rows, 10u);
  for (std::size_t row = 0; row < 10; ++row) EXPECT_EQ(d.generator[row], c.study.config.generators[row]);
  EXPECT_NE(d.parameters[0], d.parameters[2]);
}

TEST(ShardMaking, AngleIsInvalidOnlyDuringATerminalFault) {
  MadeCase c("ieee39_gencls_all", 1);
  // A fault of 0.1 s at the terminal of bus 30: samples in (2.0 s, 2.1 s] have V = 0; the sample at 2.0 s is
  // the value before the fault.
  c.study.fault_buses = {c.study.grid.network.bus_index(30)};
  c.study.config.fault.shortest = c.study.config.fault.longest = 0.1;
  const store::ShardData d = c.maker.make(0, 1, no_tick);
  ASSERT_EQ(d.rows, 10u);
  const std::size_t v = channel_index(c, "V"), f = channel_index(c, "frequency");
  for (std::size_t k = 0; k < d.samples; ++k) {
    const bool shorted = k > 240 && k <= 252;
    EXPECT_EQ(d.angle_valid[k], shorted ? 0 : 1) << k;
    EXPECT_EQ(std::abs(d.records[v * d.samples + k]) < 1e-11F, shorted) << k;  // the kernel returns 1e-12
    EXPECT_EQ(d.angle_valid[d.samples + k], 1) << k;                           // bus 31 has a nonzero voltage
    EXPECT_LT(std::abs(d.records[f * d.samples + k]), 0.5F);
  }
  EXPECT_EQ(d.records[f * d.samples], 0.0F);
}

}  // namespace
}  // namespace swingbank::mpi::draw
