// bench_likelihood [LEVEL] [EVENTS]: cost and success of the maximum a posteriori estimates of sim/direct.
// Records of the ten machines of the IEEE 39-bus system in EVENTS faults, with noise of LEVEL. Prints, for
// GENCLS and GENROU, the processor time of the Cramér-Rao bound (one evaluation with sensitivities) and of
// estimates from three kinds of start, the median and 99th percentile over the records, and how many end in
// the optimum that a search from the true parameters reaches.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "sim/core/noise.hpp"
#include "sim/direct/likelihood.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/direct/recorded.hpp"

namespace swingbank::sim::direct {
namespace {

using Free = std::vector<ParameterPrior>;

/// A noisy record, and its machine.
struct Case {
  const Effect* effect;
  std::vector<double> truth;
  Recording clean, noisy;
};

struct Measured {
  std::vector<double> ms, excess;  ///< processor time; cost above the optimum of a search from the truth
  int iterations = 0;
};

void print(const std::string& name, Measured m) {
  std::ranges::sort(m.ms);
  std::ranges::sort(m.excess);
  const auto at = [](const std::vector<double>& x, double share) {
    return x.empty() ? 0.0 : x[static_cast<std::size_t>(share * static_cast<double>(x.size() - 1) + 0.5)];
  };
  const auto same = std::ranges::count_if(m.excess, [](double e) { return e < 1; });
  fmt::print("{:34} {:8.2f} {:8.2f} {:8.2f}", name, at(m.ms, 0.5), at(m.ms, 0.99), at(m.ms, 1));
  if (!m.excess.empty())
    fmt::print("   {:4} of {:4}  {:10.3g}  {:.1f} iterations", same, m.excess.size(), at(m.excess, 1),
               static_cast<double>(m.iterations) / static_cast<double>(m.ms.size()));
  fmt::print("\n");
}

void bench(const std::string& system, const Free& free, double level, int events) {
  const auto grid = test::configured_grid(system, Conventions::psse());
  std::vector<Case> cases;
  std::uint64_t seed = 1;
  for (int e = 0; e < events; ++e) {
    auto records = recorded(grid, 3 + (7 * e) % 27, 2.05 + 0.013 * (e % 5));
    for (std::size_t k = 0; k < records.size(); ++k) {
      Recording& r = records[k];
      r.event = 2.0;
      r.noise = {level};
      const auto& machine = grid.plants[k].machine;
      cases.push_back({machine.effect, machine.p, r, with_noise(r, level, seed++)});
    }
  }
  fmt::print("{}: {} records, noise {} %\n{:34} {:>8} {:>8} {:>8}   same optimum   largest excess\n", system,
             cases.size(), 100 * level, "processor time [ms]", "median", "99 %", "largest");
  Measured bound, truth, mean, scaled, several;
  std::vector<double> optimum;
  const auto timed = [](Measured& into, const std::function<MostProbable()>& run, double least) {
    const std::clock_t begin = std::clock();
    const MostProbable found = run();
    into.ms.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    into.excess.push_back(found.cost - least);
    into.iterations += found.iterations;
    return found.cost;
  };
  std::uint32_t draw = 0;
  for (const Case& c : cases) {
    const Effect& effect = *c.effect;
    const std::clock_t begin = std::clock();
    error_bound(effect, c.clean, c.truth, free);
    bound.ms.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    std::vector<double> middle = c.truth, near = c.truth;
    for (const auto& f : free) {
      const auto i = static_cast<std::size_t>(f.index);
      middle[i] = f.mean;
      near[i] = std::clamp(near[i] + 0.3 * f.deviation * normal_pair(7, draw++, 0)[0], f.low, f.high);
    }
    const double best = timed(
        truth, [&] { return most_probable(effect, c.noisy, c.truth, free); }, 0);
    truth.excess.pop_back();
    timed(
        scaled, [&] { return most_probable_near(effect, c.noisy, near, free); }, best);
    timed(
        mean, [&] { return most_probable(effect, c.noisy, middle, free); }, best);
    timed(
        several,
        [&] {
          return most_probable_of(effect, c.noisy, {&middle, 1}, free);
        },
        best);
  }
  print("bound", bound);
  print("from the truth", truth);
  print("from 0.3 deviations about it", scaled);
  print("from the prior's mean", mean);
  print("several starts", several);
}

}  // namespace
}  // namespace swingbank::sim::direct

int main(int argc, char** argv) {
  using namespace swingbank::sim::direct;
  const double level = argc > 1 ? std::atof(argv[1]) : 0.001;
  const int events = argc > 2 ? std::atoi(argv[2]) : 3;
  const auto u = uniform_prior;
  bench("ieee39_dataset_gencls", {u(0, 1, 10), u(1, 0, 8)}, level, events);
  bench(
      "ieee39_dataset_genrou",
      {u(0, 2, 10), u(1, 0.05, 0.2), u(2, 0.5, 1.2), u(3, 0.08, 0.2), u(4, 1, 10), u(5, 0, 3), u(6, 0.8, 2.5),
       u(7, 0.8, 2.4), u(8, 0.32, 0.6), u(9, 0.45, 0.8), u(11, 0.05, 0.24), u(12, 0.01, 0.3), u(13, 0.1, 1)},
      level, events);
  return 0;
}
