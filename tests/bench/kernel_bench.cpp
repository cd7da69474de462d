// Events per core-second of the SIMD kernel on IEEE 39 (all GENROU, 15 s, 120 samples/s): SIMD batch, scalar
// build of the same kernel and reference integrator, alternating in one run, and the peak rate of the core.
// Built with SWINGBANK_COUNT_FLOPS it counts operations per event instead.
//   bench_kernel RAW DYR [events] [rounds] [words of the rows wanted]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "sim/core/pack.hpp"
#include "sim/reference/reference.hpp"
#include "tests/bench/kernel_events.hpp"

namespace {
using namespace swingbank::sim;

constexpr int kReferenceEvents = 25;  ///< in each round

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Case {
  const char* what;
  int lanes;  ///< 0: the reference integrator
  bool one, controls;
  std::vector<double> rates = {};
  int stable = 0, events = 0;
  double operations = 0;  ///< per event
};

/// Adds one round's rate. The reference integrator, some hundred times slower, runs fewer events.
void round(Case& c, const grid::Grid& grid, const std::vector<batch::Job>& list) {
  c.stable = c.events = 0;
  const double start = cpu_seconds();
  if (c.lanes == 0) {
    reference::ReferenceOptions options;
    for (; c.events < static_cast<int>(list.size()) && c.events < kReferenceEvents; ++c.events) {
      const batch::Job& job = list[static_cast<std::size_t>(c.events)];
      grid::Grid changed = grid;
      for (auto& [plant, as] : batch::changed_plants(grid, job))
        changed.plants[static_cast<std::size_t>(plant)] = as;
      c.stable += reference::run_reference(changed, job.event, options).outcome == Outcome::stable;
    }
  } else {
    batch::BatchOptions options;
    options.lanes = c.lanes;
    if (c.one) options.plants = {3};
#ifdef SWINGBANK_COUNT_FLOPS
    pack_operations = 0;
#endif
    std::size_t at = 0;
    batch::Batch batch(grid, options);
    batch.run([&](batch::Job& job) { return at < list.size() && (job = list[at++], true); },
              [&](const batch::Job&, const Trajectory& t) { c.stable += t.outcome == Outcome::stable; });
    c.events = static_cast<int>(list.size());
#ifdef SWINGBANK_COUNT_FLOPS
    c.operations = static_cast<double>(pack_operations) / c.events;
#endif
  }
  c.rates.push_back(c.events / (cpu_seconds() - start));
}

/// Peak rate by multiply-adds of sixteen independent SIMD packs [GFLOP/s]; a multiply-add counts as two.
double peak_gflops() {
  constexpr int kSums = 16, kTimes = 20'000'000;
  P8 sum[kSums];
  for (int i = 0; i < kSums; ++i) sum[i] = P8(1.0 + i);
  const P8 factor(0.999999), addend(1e-6);
  const double start = cpu_seconds();
  for (int k = 0; k < kTimes; ++k)
    for (auto& s : sum) s = s * factor + addend;
  const double seconds = cpu_seconds() - start;
  volatile double kept = 0;
  for (const auto& s : sum) kept = kept + s[0];
  return 2.0 * 8 * kSums * kTimes / seconds * 1e-9;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: bench_kernel RAW DYR [events] [rounds] [words of the rows wanted]\n");
    return 1;
  }
  try {
    const grid::Grid grid = grid::load_grid(argv[1], argv[2], Conventions::psse());
    const int count = argc > 3 ? std::atoi(argv[3]) : 400, rounds = argc > 4 ? std::atoi(argv[4]) : 3;
    const auto list = jobs(grid, count);
    const grid::Grid with_controls = controlled(grid);
    std::vector<Case> cases = {{"scalar, all generators recorded", 1, false, false},
                               {"4 lanes, all generators recorded", 4, false, false},
                               {"8 lanes, all generators recorded", 8, false, false},
                               {"reference integrator, all recorded", 0, false, false},
                               {"8 lanes, one generator recorded", 8, true, false},
                               {"8 lanes, controls on all, all recorded", 8, false, true},
                               {"8 lanes, controls on all, one recorded", 8, true, true},
                               {"16 floats, all generators recorded", 16, false, false},
                               {"16 floats, one generator recorded", 16, true, false},
                               {"16 floats, controls on all, all recorded", 16, false, true},
                               {"16 floats, controls on all, one recorded", 16, true, true}};
    if (argc > 5)
      std::erase_if(cases, [&](const Case& c) {
        return std::string_view(c.what).find(argv[5]) == std::string_view::npos;
      });
#ifdef SWINGBANK_COUNT_FLOPS
    for (auto& c : cases) {
      if (c.lanes != 4 && c.lanes != 8) continue;  // operations are counted for packs of doubles only
      round(c, c.controls ? with_controls : grid, list);
      std::printf("%-40s %7.2f million operations per event, %d events\n", c.what, 1e-6 * c.operations,
                  c.events);
    }
#else
    std::vector<double> peaks;
    for (int k = 0; k < rounds; ++k) {
      if (argc <= 5) peaks.push_back(peak_gflops());
      for (auto& c : cases) round(c, c.controls ? with_controls : grid, list);
    }
    for (auto& c : cases)
      std::printf("%-40s %7.0f events/core-s (median of %d, %.0f..%.0f)  %.3g x the first  %d of %d stable\n",
                  c.what, median(c.rates), rounds, *std::min_element(c.rates.begin(), c.rates.end()),
                  *std::max_element(c.rates.begin(), c.rates.end()), median(c.rates) / median(cases[0].rates),
                  c.stable, c.events);
    if (!peaks.empty())
      std::printf("%-40s %7.0f GFLOP/s\n", "multiply-adds of independent packs", median(peaks));
#endif
  } catch (const swingbank::InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
