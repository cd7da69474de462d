// Events per core-second of the lanes kernel on IEEE 39 (all GENROU, 15 s, 120 samples/s), lanes against the
// scalar build of the same kernel, alternating in one run.
//   bench_kernel RAW DYR [events] [rounds]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>

#include "sim/solve/batch.hpp"

namespace {
using namespace swingbank::sim;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Random bolted faults of 0.05-0.2 s at any bus; one random machine with parameters within 10 % of the
/// file's.
std::vector<Job> jobs(const Grid& grid, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<Job> list(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto& job = list[i];
    job.id = i;
    const int bus = static_cast<int>(u(random) * static_cast<double>(grid.network.buses.size()));
    job.event.faults.push_back({bus, 2.0, 2.0 + 0.05 + 0.15 * u(random), {}});
    const auto plant = static_cast<std::size_t>(u(random) * static_cast<double>(grid.plants.size()));
    auto p = grid.plants[plant].machine.p;
    for (auto& v : p) v *= 0.9 + 0.2 * u(random);
    if (grid.plants[plant].machine.effect->unphysical(p.data()).empty())
      job.machine_parameters.push_back({static_cast<int>(plant), p});
  }
  return list;
}

/// The same grid with an exciter, a governor and a stabiliser at standard values on every machine.
Grid controlled(Grid grid) {
  for (Plant& plant : grid.plants)
    for (const char* name : {"TGOV1", "IEEEST", "SEXS"}) {
      const Effect& e = *find_effect(name);
      plant.controls.push_back({&e, e.standard_parameters()});
    }
  return grid;
}

double events_per_core_second(Batch& batch, const std::vector<Job>& list, int& stable) {
  std::size_t at = 0;
  stable = 0;
  const double start = cpu_seconds();
  batch.run([&](Job& job) { return at < list.size() && (job = list[at++], true); },
            [&](const Job&, const Trajectory& t) { stable += t.outcome == Outcome::stable; });
  return static_cast<double>(list.size()) / (cpu_seconds() - start);
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: bench_kernel RAW DYR [events] [rounds]\n");
    return 1;
  }
  try {
    const Grid grid = load_grid(argv[1], argv[2], Conventions::psse());
    const int count = argc > 3 ? std::atoi(argv[3]) : 400, rounds = argc > 4 ? std::atoi(argv[4]) : 3;
    const auto list = jobs(grid, count);
    const Grid with_controls = controlled(grid);
    struct Case {
      const char* what;
      int lanes;
      bool one, controls;
      std::vector<double> rates;
      int stable = 0;
    };
    std::vector<Case> cases = {{"8 lanes, all generators recorded", 8, false, false, {}},
                               {"4 lanes, all generators recorded", 4, false, false, {}},
                               {"scalar, all generators recorded", 1, false, false, {}},
                               {"8 lanes, one generator recorded", 8, true, false, {}},
                               {"8 lanes, controls on all, all recorded", 8, false, true, {}},
                               {"8 lanes, controls on all, one recorded", 8, true, true, {}}};
    for (int round = 0; round < rounds; ++round)
      for (auto& c : cases) {
        BatchOptions options;
        options.lanes = c.lanes;
        if (c.one) options.plants = {3};
        Batch batch(c.controls ? with_controls : grid, options);
        c.rates.push_back(events_per_core_second(batch, list, c.stable));
      }
    const auto median = [](std::vector<double> v) {
      std::sort(v.begin(), v.end());
      return v[v.size() / 2];
    };
    const double scalar = median(cases[2].rates);
    for (auto& c : cases)
      std::printf("%-40s %7.0f events/core-s (median of %d, %.0f..%.0f)  %.2f x scalar  %d of %d stable\n",
                  c.what, median(c.rates), rounds, *std::min_element(c.rates.begin(), c.rates.end()),
                  *std::max_element(c.rates.begin(), c.rates.end()), median(c.rates) / scalar, c.stable,
                  count);
  } catch (const swingbank::InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
