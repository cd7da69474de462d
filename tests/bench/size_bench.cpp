// Processor time and memory against the size of the grid (tiled_grid.hpp): construction of the grid,
// reference integrator and SIMD kernel, each in a separate process.
//   bench_size NETWORK.raw NETWORK.dyr [SECONDS]
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "sim/batch/batch.hpp"
#include "sim/reference/reference.hpp"
#include "tests/bench/tiled_grid.hpp"

namespace {
using namespace swingbank::sim;

struct Cost {
  double seconds = 0.0, megabytes = 0.0;
};

/// Cost of `work` in a separate process; ends the program if it fails.
template <class Work>
Cost cost(const Work& work) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    try {
      work();
    } catch (const swingbank::InputError& e) {
      std::fprintf(stderr, "%s\n", e.what());
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  rusage use{};
  if (child < 0 || wait4(child, &status, 0, &use) < 0 || status != 0) std::exit(1);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(use.ru_utime) + seconds(use.ru_stime), static_cast<double>(use.ru_maxrss) / 1024.0};
}

constexpr int kEvents = 8;
constexpr double kFaultOn = 0.1, kFaultOff = 0.2;  ///< [s]

network::Event event(int number, const grid::Grid& grid) {
  network::Event e;
  e.faults = {{(15 + 50 * number) % static_cast<int>(grid.network.buses.size()), kFaultOn, kFaultOff, {}}};
  return e;
}

void reference_run(const grid::Grid& grid, double seconds) {
  reference::ReferenceOptions options;
  options.t_end = seconds;
  options.plants = {0};
  const auto run = reference::run_reference(grid, event(0, grid), options);
  if (run.outcome != Outcome::stable) std::exit(2);
}

void batch_run(const grid::Grid& grid, double seconds) {
  batch::BatchOptions options;
  options.t_end = seconds;
  options.plants = {0};
  batch::Batch batch(grid, options);
  int given = 0;
  batch.run(
      [&](batch::Job& job) {
        if (given == kEvents) return false;
        job.event = event(given++, grid);
        return true;
      },
      [](const batch::Job&, const Trajectory& t) {
        if (t.outcome != Outcome::stable) std::exit(2);
      });
}

void print(const char* what, const Cost& now, const Cost& before, double grown) {
  const auto exponent = [&](double a, double b) {
    return grown > 1.0 && b > 0.0 ? std::log(a / b) / std::log(grown) : 0.0;
  };
  std::printf("  %-44s %9.3f s  exponent %5.2f  %8.1f MB  exponent %5.2f\n", what, now.seconds,
              exponent(now.seconds, before.seconds), now.megabytes,
              exponent(now.megabytes, before.megabytes));
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "bench_size NETWORK.raw NETWORK.dyr [SECONDS]\n");
    return 1;
  }
  const double seconds = argc > 3 ? std::atof(argv[3]) : 1.0;
  const auto make = [&](int tiles) {
    return grid::make_grid(tiled_network(argv[1], tiles), tiled_dynamics(argv[2], tiles, true), argv[2],
                           Conventions::psse());
  };
  int before = 0;
  Cost made_before, reference_before, batch_before;
  for (const int tiles : {1, 5, 20, 40, 200}) {
    const Cost made = cost([&] { (void)make(tiles); });
    const auto beside = [&](const Cost& whole) {
      return Cost{whole.seconds - made.seconds, whole.megabytes};
    };
    const Cost reference = beside(cost([&] { reference_run(make(tiles), seconds); }));
    const Cost batch_cost = beside(cost([&] { batch_run(make(tiles), seconds); }));
    const double grown = before > 0 ? static_cast<double>(tiles) / before : 1.0;
    std::printf("%d buses, %d machines; runs of %g s\n", 50 * tiles, 10 * tiles, seconds);
    print("grid: network, power flow, plants", made, made_before, grown);
    print("reference, one event, beside the grid", reference, reference_before, grown);
    print(("lanes, " + std::to_string(kEvents) + " events, beside the grid").c_str(), batch_cost,
          batch_before, grown);
    made_before = made, reference_before = reference, batch_before = batch_cost, before = tiles;
  }
}
