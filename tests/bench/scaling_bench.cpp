// Cost of an event against the number of generators, on synthetic grids: a ring of generator buses with
// chords, each machine behind its own transformer, a load at every ring bus. Cost grows no worse than
// quadratically.
//   bench_scaling [events] [rounds]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "sim/solve/batch.hpp"

namespace {
using namespace swingbank::sim;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Branch branch(int from, int to, double x, bool transformer) {
  Branch b{};
  b.from = from;
  b.to = to;
  b.circuit = "1";
  b.r = transformer ? 0.0 : 0.1 * x;
  b.x = x;
  b.transformer = transformer;
  return b;
}

/// n machines of 100 MVA at 80 MW; bus 2i is the ring's, bus 2i + 1 the machine's.
Grid synthetic(int n) {
  Network net;
  net.title = net.origin = "synthetic";
  std::vector<DyrRecord> dynamics;
  for (int i = 0; i < n; ++i) {
    net.buses.push_back({2 * i + 1, "RING", 230.0, BusType::load, 1.0, 0.0});
    net.buses.push_back({2 * i + 2, "UNIT", 20.0, i == 0 ? BusType::slack : BusType::generator, 1.02, 0.0});
    net.branches.push_back(branch(2 * i, 2 * i + 1, 0.1, true));
    net.branches.push_back(branch(2 * i, 2 * ((i + 1) % n), 0.05, false));
    if (i % 2 == 0 && n > 6) {
      net.branches.push_back(branch(2 * i, 2 * ((i + n / 3) % n), 0.1, false));
      net.branches.back().circuit = "2";
    }
    Load load{};
    load.bus = 2 * i;
    load.id = "1";
    load.power = {0.8, 0.2};
    net.loads.push_back(load);
    Generator g{};
    g.bus = 2 * i + 1;
    g.id = "1";
    g.p = 0.8;
    g.vset = 1.02;
    g.mva = 100.0;
    g.zx = 0.25;
    net.generators.push_back(g);
    dynamics.push_back(
        {2 * i + 2,
         "GENROU",
         "1",
         {8.0, 0.03, 0.4, 0.05, 4.0 + 0.1 * (i % 10), 1.0, 1.8, 1.7, 0.3, 0.55, 0.25, 0.2, 0.1, 0.4},
         i + 1});
  }
  return make_grid(std::move(net), dynamics, "synthetic", Conventions::psse());
}

/// Seconds of processor time per event of 15 s, and how many ended stable.
double seconds_per_event(const Grid& grid, int events, int& stable) {
  BatchOptions options;
  options.plants = {0};
  Batch batch(grid, options);
  int given = 0;
  stable = 0;
  const double start = cpu_seconds();
  batch.run(
      [&](Job& job) {
        if (given == events) return false;
        job.event.faults = {{2 * (given % static_cast<int>(grid.plants.size())), 1.0, 1.06, {}}};
        ++given;
        return true;
      },
      [&](const Job&, const Trajectory& t) { stable += t.outcome == Outcome::stable; });
  return (cpu_seconds() - start) / events;
}
}  // namespace

int main(int argc, char** argv) {
  const int events = argc > 1 ? std::atoi(argv[1]) : 64, rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  std::vector<int> sizes = {10, 25, 50, 100, 200};
  std::vector<std::vector<double>> times(sizes.size());
  std::vector<int> stable(sizes.size());
  try {
    std::vector<Grid> grids;
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
