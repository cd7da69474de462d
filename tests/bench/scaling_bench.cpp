// Cost of an event against the number of generators, on synthetic grids. Expected growth: at most quadratic.
//   bench_scaling [events] [rounds]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "sim/batch/batch.hpp"
#include "tests/bench/synthetic_grid.hpp"

namespace {
using namespace swingbank::sim;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Processor time per event of 15 s [s], and number of stable events.
double seconds_per_event(const grid::Grid& grid, int events, int& stable) {
  batch::BatchOptions options;
  options.plants = {0};
  batch::Batch batch(grid, options);
  int given = 0;
  stable = 0;
  const double start = cpu_seconds();
  batch.run(
      [&](batch::Job& job) {
        if (given == events) return false;
        job.event.faults = {{2 * (given % static_cast<int>(grid.plants.size())), 1.0, 1.06, {}}};
        ++given;
        return true;
      },
      [&](const batch::Job&, const Trajectory& t) { stable += t.outcome == Outcome::stable; });
  return (cpu_seconds() - start) / events;
}
}  // namespace

int main(int argc, char** argv) {
  const int events = argc > 1 ? std::atoi(argv[1]) : 64, rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  std::vector<int> sizes = {10, 25, 50, 100, 200};
  std::vector<std::vector<double>> times(sizes.size());
  std::vector<int> stable(sizes.size());
  try {
    std::vector<grid::Grid> grids;
    for (int n : sizes) grids.push_back(synthetic(n));
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < sizes.size(); ++i)
        times[i].push_back(seconds_per_event(grids[i], events, stable[i]));
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      std::sort(times[i].begin(), times[i].end());
      const double median = times[i][times[i].size() / 2];
      std::printf("%4d generators  %9.3f ms per event  %d of %d stable", sizes[i], 1e3 * median, stable[i],
                  events);
      if (i > 0) {
        const double before = times[i - 1][times[i - 1].size() / 2];
        std::printf("  exponent %.2f",
                    std::log(median / before) / std::log(static_cast<double>(sizes[i]) / sizes[i - 1]));
      }
      std::printf("\n");
    }
    const double one = seconds_per_event(grids[0], events, stable[0]);
    const double four = seconds_per_event(grids[0], 4 * events, stable[0]);
    std::printf("events: %d cost %.3f ms each, %d cost %.3f ms each\n", events, 1e3 * one, 4 * events,
                1e3 * four);
  } catch (const swingbank::InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
