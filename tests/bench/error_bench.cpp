// Largest error of the SIMD kernel against the reference integrator over the stable events of bench_kernel,
// without and with controls, in double and in float. Errors are relative to max(1 pu, the channel's swing);
// samples within 2 ms of a switching time are excluded.
//   bench_error RAW DYR [events]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "sim/reference/reference.hpp"
#include "tests/bench/kernel_events.hpp"

namespace {
using namespace swingbank::sim;

struct Worst {
  double error = 0.0;
  std::string where;
  int compared = 0, beyond = 0, differ = 0;  ///< numbers of events: compared, error above 1e-4, other outcome
};

Trajectory reference(const grid::Grid& grid, const batch::Job& job) {
  grid::Grid changed = grid;
  for (auto& [plant, as] : batch::changed_plants(grid, job))
    changed.plants[static_cast<std::size_t>(plant)] = as;
  return reference::run_reference(changed, job.event, reference::ReferenceOptions{});
}

bool near_switching(const batch::Job& job, double t) {
  return std::ranges::any_of(job.event.faults, [t](const network::BusFault& f) {
    return std::abs(t - f.t_on) < 2e-3 || std::abs(t - f.t_off) < 2e-3;
  });
}

double row_error(const batch::Job& job, const Trajectory& run, const double* a, const double* b) {
  const auto [low, high] = std::minmax_element(b, b + run.samples);
  double worst = 0.0;
  for (int k = 0; k < run.samples; ++k)
    if (!near_switching(job, k / run.rate)) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst / std::max(1.0, *high - *low);
}

void compare(const grid::Grid& grid, const batch::Job& job, const Trajectory& run, Worst& worst) {
  const Trajectory ida = reference(grid, job);
  if (ida.outcome != run.outcome) ++worst.differ;
  if (ida.outcome != Outcome::stable || run.outcome != Outcome::stable) return;
  double event = 0.0;
  for (int p = 0; p < static_cast<int>(run.plants.size()); ++p)
    for (int c = 0; c < static_cast<int>(run.channels.size()); ++c) {
      const double error = row_error(job, run, run.at(p, c), ida.at(p, c));
      event = std::max(event, error);
      if (error <= worst.error) continue;
      worst.error = error;
      worst.where = std::string(kChannels[static_cast<std::size_t>(c)].name) + " of plant " +
                    std::to_string(p) + ", event " + std::to_string(job.id);
    }
  ++worst.compared;
  worst.beyond += event > 1e-4;
}

void report(const char* what, const grid::Grid& grid, int count, int lanes) {
  const auto list = jobs(grid, count);
  std::size_t at = 0;
  Worst worst;
  batch::BatchOptions options;
  options.lanes = lanes;
  batch::Batch batch(grid, options);
  batch.run([&](batch::Job& job) { return at < list.size() && (job = list[at++], true); },
            [&](const batch::Job& job, const Trajectory& run) { compare(grid, job, run, worst); });
  std::printf("%-16s worst error %.2g (%s), %d of %d stable events beyond 1e-4, %d with another outcome\n",
              what, worst.error, worst.where.c_str(), worst.beyond, worst.compared, worst.differ);
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: bench_error RAW DYR [events]\n");
    return 1;
  }
  try {
    const grid::Grid grid = grid::load_grid(argv[1], argv[2], Conventions::psse());
    const int count = argc > 3 ? std::atoi(argv[3]) : 400;
    for (const int lanes : {8, 16}) {
      std::printf("%s\n", lanes == 8 ? "8 lanes in double" : "16 lanes in float");
      report("machines alone", grid, count, lanes);
      report("controls on all", controlled(grid), count, lanes);
    }
  } catch (const swingbank::InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
