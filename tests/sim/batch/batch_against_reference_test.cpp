// The SIMD kernel against the reference integrator: two integrators of the same equations.
#include <array>
#include <random>

#include "sim/batch/batch.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::batch {
namespace {

/// Uniform in [low, high), the same on every platform (std::uniform_real_distribution is not).
class RandomDraws {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  int index(std::size_t n) { return static_cast<int>(random_() % n); }

 private:
  std::mt19937_64 random_{20201121};
};

/// The thesis's ranges of GENROU, in the order of its records (Ra last: 0).
constexpr std::array<std::pair<double, double>, 15> kRanges = {{{2, 10},
                                                                {1.0 / 15, 0.2},
                                                                {0.5, 1.2},
                                                                {0.1, 0.2},
                                                                {1, 10},
                                                                {0, 3},
                                                                {0.8, 2.5},
                                                                {0.4, 2.4},
                                                                {0.8, 2.5},
                                                                {0.4, 2.4},
                                                                {0.3, 0.3},
                                                                {0.01, 0.25},
                                                                {0.001, 1},
                                                                {0.01, 5},
                                                                {0, 0}}};

std::vector<double> physical_genrou(const Effect& effect, RandomDraws& draws) {
  for (;;) {
    std::vector<double> p;
    for (const auto& [low, high] : kRanges) p.push_back(draws.uniform(low, high));
    if (effect.unphysical(p.data()).empty()) return p;
  }
}

struct Case {
  Job job;
  reference::ReferenceRun reference;
};

/// Draws events of the dataset's kind until `count` of them are stable in the reference.
std::vector<Case> stable_cases(const grid::Grid& grid, std::size_t count) {
  RandomDraws draws;
  std::vector<Case> cases;
  for (std::uint64_t id = 0; cases.size() < count && id < 20 * count; ++id) {
    Job job;
    job.id = id;
    const int plant = draws.index(grid.plants.size());
    job.parameters = {
        {plant, plant::kMachineBlock, physical_genrou(*grid.plants[plant].machine.effect, draws)}};
    const int bus = draws.index(grid.network.buses.size());
    job.event.faults = {{bus, 2.0, 2.0 + draws.uniform(0.05, 0.2), {}}};
    grid::Grid drawn = grid;
    drawn.plants[plant].machine.p = job.parameters[0].values;
    reference::ReferenceRun run = reference::run_reference(drawn, job.event, {});
    if (run.outcome == Outcome::stable) cases.push_back({std::move(job), std::move(run)});
  }
  return cases;
}

class BatchAgainstReferenceFull : public ::testing::TestWithParam<const char*> {};

TEST_P(BatchAgainstReferenceFull, HundredRandomStableEvents) {
  const grid::Grid grid = test::configured_grid(GetParam(), Conventions::psse());
  const std::vector<Case> cases = stable_cases(grid, 100);
  ASSERT_EQ(cases.size(), 100u);
  Batch batch(grid, BatchOptions{});
  std::size_t given = 0, compared = 0;
  std::array<double, kChannelCount> worst{};
  batch.run(
      [&](Job& job) {
        if (given == cases.size()) return false;
        job = cases[given++].job;
        return true;
      },
      [&](const Job& job, const Trajectory& run) {
        const auto at =
            std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return c.job.id == job.id; });
        ASSERT_NE(at, cases.end());
        ASSERT_EQ(run.outcome, Outcome::stable) << "event " << job.id;
        ASSERT_EQ(run.rows(), at->reference.rows());
        ++compared;
        for (int p = 0; p < static_cast<int>(grid.plants.size()); ++p)
          for (int c = 0; c < kChannelCount; ++c)
            for (int k = 0; k < run.samples; ++k)
              worst[c] = std::max(worst[c], std::abs(run.at(p, c)[k] - at->reference.at(p, c)[k]));
      });
  EXPECT_EQ(compared, cases.size());
  for (int c = 0; c < kChannelCount; ++c) {
    RecordProperty("largest_" + std::string(kChannels[c].name), testing::PrintToString(worst[c]));
    EXPECT_LE(worst[c], 1e-4) << kChannels[c].name << " [" << kChannels[c].unit
                              << "]";  // required: <= 1e-4 in every channel
  }
}

// The thesis's ranges on the dataset's machine bases, and on the bases of the reference records.
INSTANTIATE_TEST_SUITE_P(Grids, BatchAgainstReferenceFull,
                         ::testing::Values("ieee39_dataset_genrou", "ieee39_genrou"));

/// A few events of each kind for the fast tier, including other grids and other conventions.
TEST(BatchAgainstReference, EachKindOfEvent) {
  struct Kind {
    const char* grid;
    Conventions conventions;
    network::Event event;
  };
  const auto fault = [](int bus, double off, Complex z = {}) {
    return network::Event{{{bus, 2.0, off, z}}, {}};
  };
  network::Event reclosing = fault(3, 2.1);
  reclosing.trips.push_back({2, 2.1, 2.6});
  network::Event trip_only;
  trip_only.trips.push_back({4, 1.0, {}});
  const std::vector<Kind> kinds = {
      {"ieee39_genrou", Conventions::psse(), fault(15, 2.1)},
      {"ieee39_genrou", Conventions::andes(), fault(15, 2.123, {0.001, 0.01})},
      {"ieee39_genrou", Conventions::psse(), fault(33, 2.1)},  // a generator's own bus
      {"ieee39_gencls", Conventions::andes(), fault(3, 2.15)},
      {"ieee39_gencls", Conventions::psse(), trip_only},
      {"ieee14_genrou", Conventions::andes(), reclosing}};
  for (const Kind& kind : kinds) {
    const grid::Grid grid = test::configured_grid(kind.grid, kind.conventions);
    const reference::ReferenceRun reference = reference::run_reference(grid, kind.event, {});
    ASSERT_EQ(reference.outcome, Outcome::stable) << kind.grid;
    Batch batch(grid, BatchOptions{});
    bool given = false, done = false;
    batch.run(
        [&](Job& job) {
          job.event = kind.event;
          return !std::exchange(given, true);
        },
        [&](const Job&, const Trajectory& run) {
          done = true;
          EXPECT_EQ(run.outcome, Outcome::stable);
          EXPECT_LE(test::largest_difference(run, reference), 1e-4) << kind.grid;
        });
    EXPECT_TRUE(done);
  }
}

}  // namespace
}  // namespace swingbank::sim::batch
