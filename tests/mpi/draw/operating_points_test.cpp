#include "mpi/draw/operating_points.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "mpi/draw/shard_maker.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::draw {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kPointConfigs = fs::path(SWINGBANK_SOURCE) / "configs/datasets";

DatasetConfig config(const std::string& name = "ieee39_genrou_points", std::uint64_t draws = 24) {
  Overrides o;
  o.draws = draws;
  DatasetConfig c = read_dataset_config(kPointConfigs / (name + ".toml"), o);
  c.record.t_end = 3.0;  // covers the fault; short for speed
  return c;
}

/// Characteristic numbers of a grid.
std::vector<double> figures(const sim::grid::Grid& grid) {
  std::vector<double> all;
  for (const auto& v : grid.flow.voltage) all.insert(all.end(), {v.real(), v.imag()});
  for (const auto& p : grid.plants) all.insert(all.end(), {p.generation.real(), p.generation.imag(), p.mva});
  for (const auto& b : grid.network.branches) all.push_back(b.in_service ? 1.0 : 0.0);
  return all;
}

double total_load(const sim::grid::Grid& grid) {
  double sum = 0.0;
  for (const auto& l : grid.network.loads) sum += l.power.real();
  return sum;
}

TEST(OperatingPoint, IsAFunctionOfSeedAndBlock) {
  const Study study = load_study(config());
  OperatingPoints forward(study), alone(study);
  forward.at(0);
  forward.at(4);
  EXPECT_EQ(figures(*forward.at(5).grid), figures(*alone.at(5).grid));
  EXPECT_EQ(forward.at(5).grid, forward.at(5).grid);  // cached
  EXPECT_NE(figures(*forward.at(6).grid), figures(*alone.at(5).grid));
  DatasetConfig other = config();
  other.seed = 2;
  const Study second = load_study(other);
  EXPECT_NE(figures(*OperatingPoints(second).at(5).grid), figures(*alone.at(5).grid));
}

/// At every bus the generation equals the power of loads and branches.
TEST(OperatingPoint, PowerIsBalancedAtEveryBus) {
  const Study study = load_study(config());
  OperatingPoints points(study);
  for (std::uint64_t block = 0; block < 20; ++block) {
    const sim::grid::Grid& grid = *points.at(block).grid;
    const Eigen::Map<const Eigen::VectorXcd> v(grid.flow.voltage.data(),
                                               static_cast<Eigen::Index>(grid.flow.voltage.size()));
    const Eigen::VectorXcd current = sim::network::bus_admittance(grid.network) * v;
    Eigen::VectorXcd left = v.cwiseProduct(current.conjugate());
    for (const auto& plant : grid.plants) left[plant.bus] -= plant.generation;
    for (const auto& load : grid.network.loads) left[load.bus] += sim::network::consumption(load, grid.flow);
    EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-9) << block;
  }
}

TEST(OperatingPoint, StaysWithinTheConfiguredRanges) {
  const Study study = load_study(config());
  const OperatingPointConfig& c = *study.config.operating_point;
  OperatingPoints points(study);
  constexpr int kBlocks = 300;
  double load = 0.0, ratio = 0.0, oversized = 0.0, v_low = 1.0, v_high = 0.0;
  for (std::uint64_t block = 0; block < kBlocks; ++block) {
    const sim::grid::Grid& grid = *points.at(block).grid;
    load += total_load(grid) / total_load(study.grid) / kBlocks;
    for (std::size_t i = 0; i < grid.plants.size(); ++i) {
      const auto &plant = grid.plants[i], &own = study.grid.plants[i];
      const auto bus = static_cast<std::size_t>(plant.bus);
      const double dv = std::abs(grid.flow.voltage[bus]) - std::abs(study.grid.flow.voltage[bus]);
      EXPECT_LE(std::abs(dv), c.voltage + 1e-9);
      v_low = std::min(v_low, dv);
      v_high = std::max(v_high, dv);
      const double loading = std::abs(plant.generation) * grid.network.base_mva / plant.mva;
      EXPECT_GE(loading, c.loading_low / c.oversized_high - 1e-12);
      EXPECT_LE(loading, c.loading_high + 1e-12);
      // Only oversized machines (base multiplied by 2 to 10) can have a loading below the range.
      oversized += loading < c.loading_low ? 1.0 : 0.0;
      if (grid.network.buses[bus].type == sim::network::BusType::slack) continue;
      const double times = plant.generation.real() / own.generation.real();
      EXPECT_GE(times, c.loads_low * c.dispatch_low - 1e-12);
      EXPECT_LE(times, c.loads_high * c.dispatch_high + 1e-12);
      ratio += times / (9.0 * kBlocks);
    }
  }
  // Uniform over 0.5 to 1.1: mean 0.8, standard error of 300 blocks 0.01; redraws shift it slightly.
  EXPECT_NEAR(load, 0.8, 0.05);
  EXPECT_NEAR(ratio, 0.8 * 0.95, 0.05);
  EXPECT_LT(v_low, -0.029);
  EXPECT_GT(v_high, 0.029);
  // 12 % of the machines are oversized, by a factor f uniform over 2 to 10. P(U(0.1, 1) < 0.1 f) =
  // (0.1 f - 0.1)/0.9, on average 0.556. The standard error is 0.5 % for 3,000 machines.
  EXPECT_NEAR(oversized / (10.0 * kBlocks), 0.12 * 0.5 / 0.9, 0.02);
}

TEST(OperatingPoint, RedrawsAndCountsInfeasiblePoints) {
  DatasetConfig c = config();
  c.operating_point->loads_high = 3.0;
  const Study heavy = load_study(c);
  OperatingPoints points(heavy);
  Redrawn all;
  for (std::uint64_t block = 0; block < 20; ++block) {
    const OperatingPoint& p = points.at(block);
    ASSERT_TRUE(p.grid);
    all.no_power_flow += p.redrawn.no_power_flow;
    all.implausible += p.redrawn.implausible;
  }
  EXPECT_GT(all.no_power_flow, 0u);
  EXPECT_GT(all.implausible, 0u);
  c.operating_point->loads_low = 2.9;
  const Study hopeless = load_study(c);
  try {
    OperatingPoints(hopeless).at(3);
    FAIL() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("no operating point for block 3"),
                                HasSubstr("of 100 random operating points")));
  }
}

TEST(OperatingPoint, LineOutagesKeepTheGridConnected) {
  DatasetConfig c = config();
  c.operating_point->lines_out_high = 2;
  const Study study = load_study(c);
  OperatingPoints points(study);
  std::vector<int> count(3);
  for (std::uint64_t block = 0; block < 60; ++block) {
    const auto& network = points.at(block).grid->network;
    const auto out = std::ranges::count_if(network.branches, [](const auto& b) { return !b.in_service; });
    ASSERT_LE(out, 2);
    ++count[static_cast<std::size_t>(out)];
    EXPECT_EQ(std::ranges::max(sim::network::islands(network)), 0);
  }
  for (const int n : count) EXPECT_GT(n, 5);  // of 60, 20 expected
}

struct Case {
  Study study;
  Databank bank;
  ShardMaker maker;
  explicit Case(const DatasetConfig& c)
      : study(load_study(c)),
        bank(draw_databank(c, study.grid.plants[static_cast<std::size_t>(study.plants[0])], c.points())),
        maker(study, bank) {}
  store::ShardData make(std::uint64_t first, std::uint64_t count) {
    return maker.make(first, count, [](std::uint64_t) {});
  }
};

std::size_t channel(const Case& c, const std::string& name) {
  const auto& names = c.study.config.record.channels;
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

/// Checks rows: their initial power, converted from the row's machine base, equals that of the power flow,
/// and their record equals that of a separate simulation of the grid at this operating point.
void expect_rows_are_their_grids(const DatasetConfig& config) {
  Case c(config);
  const store::ShardData d = c.make(0, config.draws);
  ASSERT_GT(d.rows, config.draws / 2);
  ASSERT_EQ(d.machine_base.size(), d.rows);
  OperatingPoints points(c.study);
  Sampler sampler(c.study, c.bank);
  sim::batch::BatchOptions options = batch_options(config);
  options.lanes = 1;
  const std::size_t p = channel(c, "P"), q = channel(c, "Q"), v = channel(c, "V");
  for (std::size_t row = 0; row < d.rows; row += 7) {
    const std::uint64_t block = d.sample_id[row] / config.operating_point->per_block;
    const sim::grid::Grid& grid = *points.at(block).grid;
    const auto plant = std::ranges::find_if(grid.plants, [&](const sim::plant::Plant& x) {
      return grid.network.buses[static_cast<std::size_t>(x.bus)].number == d.generator[row];
    });
    const auto first = [&](std::size_t k) { return d.records[(row * d.channels + k) * d.samples]; };
    EXPECT_EQ(d.machine_base[row], plant->mva);
    EXPECT_NEAR(first(p) * d.machine_base[row], plant->generation.real() * 100.0, 1e-3);
    EXPECT_NEAR(first(q) * d.machine_base[row], plant->generation.imag() * 100.0, 1e-3);
    EXPECT_NEAR(first(v), std::abs(grid.flow.voltage[static_cast<std::size_t>(plant->bus)]), 1e-6);
    Draw draw = sampler.draw(d.sample_id[row]);
    draw.job.grid = {};
    sim::batch::Batch alone(grid, options);
    bool given = false;
    alone.run([&](sim::batch::Job& job) { return given ? false : (job = draw.job, given = true); },
              [&](const sim::batch::Job&, const sim::Trajectory& t) {
                const double* expected =
                    t.at(static_cast<int>(plant - grid.plants.begin()), static_cast<int>(sim::Channel::P));
                for (std::size_t k = 0; k < d.samples; ++k)
                  // SIMD widths agree to 1e-9, and the record is a float of values up to 10 (1e-6).
                  ASSERT_NEAR(d.records[(row * d.channels + p) * d.samples + k], expected[k], 2e-6) << k;
              });
  }
}

TEST(OperatingPointRows, EqualRecordsOfTheirGrid) { expect_rows_are_their_grids(config()); }
TEST(OperatingPointRows, EqualRecordsOfTheirGrid_WhenOneGeneratorVaries) {
  DatasetConfig c = config("ieee39_genrou", 60);
  c.operating_point = config().operating_point;
  expect_rows_are_their_grids(c);
}

/// Ranks and shards may divide a dataset anywhere, also inside a block.
TEST(OperatingPointRows, PartsEqualTheWhole) {
  Case c(config());
  const store::ShardData whole = c.make(0, 24), first = c.make(0, 11), rest = c.make(11, 13);
  auto hashes = store::row_hashes(first), more = store::row_hashes(rest);
  hashes.insert(hashes.end(), more.begin(), more.end());
  EXPECT_EQ(hashes, store::row_hashes(whole));
  auto redrawn = first.draw_redrawn;
  redrawn.insert(redrawn.end(), rest.draw_redrawn.begin(), rest.draw_redrawn.end());
  EXPECT_EQ(redrawn, whole.draw_redrawn);
  EXPECT_EQ(redrawn.size(), 48u);
}

TEST(OperatingPointConfigFile, HashCoversEveryKeyAndRefusalsNameThem) {
  const test::Folder folder;
  const std::string text = read_text(kPointConfigs / "ieee39_gencls_points.toml");
  const auto read = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    for (auto at = changed.find("../networks"); at != std::string::npos; at = changed.find("../networks"))
      changed.replace(at, 11, (kPointConfigs.parent_path() / "networks").string());
    write_text(folder.path / "c.toml", changed);
    return read_dataset_config(folder.path / "c.toml");
  };
  const std::string base = read("seed = 1", "seed = 1").canonical();
  const std::pair<const char*, const char*> changes[] = {
      {"per_block = 2", "per_block = 3"},         {"loads = [0.5, 1.1]", "loads = [0.5, 1.0]"},
      {"load_spread = 0.2", "load_spread = 0.1"}, {"dispatch = [0.6, 1.3]", "dispatch = [0.7, 1.3]"},
      {"voltage = 0.03", "voltage = 0.02"},       {"loading = [0.1, 1.0]", "loading = [0.2, 1.0]"},
      {"_share = 0.12", "_share = 0.1"},          {"oversized = [2.0, 10.0]", "oversized = [2.0, 9.0]"},
      {"voltage = 0.03", "lines_out = [0, 2]"}};
  for (const auto& [from, to] : changes) EXPECT_NE(read(from, to).canonical(), base) << to;
  const auto refusal = [&](const std::string& from, const std::string& to) {
    try {
      read(from, to);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing thrown");
  };
  EXPECT_THAT(refusal("loads = [0.5, 1.1]", "loads = [1.1, 0.5]"), HasSubstr("low end lies above"));
  EXPECT_THAT(refusal("per_block = 2", "per_block = 0"), HasSubstr("operating_point.per_block"));
  EXPECT_THAT(refusal("loading = [0.1, 1.0]", ""), HasSubstr("give loading = [low, high] too"));
  EXPECT_THAT(refusal("voltage = 0.03", "lines_out = [0, 1.5]"), HasSubstr("give whole numbers"));
  EXPECT_THAT(refusal("voltage = 0.03", "volts = 0.03"), HasSubstr("unknown key operating_point.volts"));
}

TEST(OperatingPointRows, AreAbsentWithoutTheTable) {
  DatasetConfig c = config();
  const std::string with = c.canonical();
  c.operating_point.reset();
  EXPECT_EQ(c.canonical(), config("ieee39_genrou_all").canonical());
  EXPECT_THAT(with, AllOf(HasSubstr(c.canonical()), HasSubstr("operating_point.loads = [0.5, 1.1]\n")));
  Case plain(c);
  const store::ShardData d = plain.make(0, 8);
  EXPECT_TRUE(d.machine_base.empty());
  EXPECT_TRUE(d.draw_redrawn.empty());
}

}  // namespace
}  // namespace swingbank::mpi::draw
