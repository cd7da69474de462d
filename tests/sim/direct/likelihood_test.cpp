// Machines of the IEEE 39-bus system in a fault, recorded with noise: the fit reaches the Cramer-Rao bound.
#include "sim/direct/likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/direct/detail/innovations.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/direct/recorded.hpp"

namespace swingbank::sim::direct {
namespace {

/// Means over machines, events and noise realisations: squared error divided by its bound, and chi-square.
struct Judged {
  double ratio = 0, chi_square = 0;
};
constexpr std::size_t kSomeMachines = 4, kAllMachines = 10;
Judged judge(const std::string& system, std::span<const ParameterPrior> free, double level,
             std::size_t machines) {
  const auto grid = test::configured_grid(system, Conventions::psse());
  Judged all;
  double count = 0;
  std::vector<Recording> records = recorded(grid, 16, 2.063);
  records.resize(machines);
  for (Recording& clean : records) {
    const auto& machine = grid.plants[static_cast<std::size_t>(count)].machine;
    clean.event = 2.0;
    clean.noise = {level};
    const auto bound = error_bound(*machine.effect, clean, machine.p, free);
    std::vector<double> start = machine.p;
    for (const auto& f : free) start[static_cast<std::size_t>(f.index)] = f.mean;
    const auto found = most_probable_of(
        *machine.effect, with_noise(clean, level, static_cast<std::uint64_t>(1 + count)), {&start, 1}, free);
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto i = static_cast<std::size_t>(free[k].index);
      EXPECT_LT(bound[k], 1.0001 * free[k].deviation * free[k].deviation)
          << machine.effect->parameters[i].name;
      all.ratio += std::pow(found.p[i] - machine.p[i], 2) / bound[k] / static_cast<double>(free.size());
    }
    all.chi_square += found.chi_square;
    ++count;
  }
  all.ratio /= count;
  all.chi_square /= count;
  return all;
}

const std::vector<ParameterPrior> kClassical = {uniform_prior(0, 1, 10), uniform_prior(1, 0, 8),
                                                uniform_prior(3, 0.05, 0.6)};
// Round-rotor machines: thirteen unknowns each, several of them strongly correlated.
const std::vector<ParameterPrior> kRoundRotor = {
    uniform_prior(0, 2, 10),     uniform_prior(1, 0.05, 0.2),   uniform_prior(2, 0.5, 1.2),
    uniform_prior(3, 0.08, 0.2), uniform_prior(4, 1, 10),       uniform_prior(5, 0, 3),
    uniform_prior(6, 0.8, 2.5),  uniform_prior(7, 0.8, 2.4),    uniform_prior(8, 0.32, 0.6),
    uniform_prior(9, 0.45, 0.8), uniform_prior(11, 0.05, 0.24), uniform_prior(12, 0.01, 0.3),
    uniform_prior(13, 0.1, 1)};

// For ten records with two unknowns each, the mean of squared normal numbers has a standard deviation of 0.3.
void expect_bound_of_classical_machines(double level) {
  const Judged j = judge("ieee39_dataset_gencls", kClassical, level, kAllMachines);
  EXPECT_NEAR(j.chi_square, 1, 0.03);
  EXPECT_LT(j.ratio, 1.9);
}
TEST(Likelihood, ReachesTheBoundOfClassicalMachines) { expect_bound_of_classical_machines(0.001); }
TEST(LikelihoodFull, ReachesTheBoundOfClassicalMachines_WithMoreNoise) {
  expect_bound_of_classical_machines(0.005);
}

void expect_bound_of_round_rotor_machines(std::size_t machines) {
  const Judged j = judge("ieee39_dataset_genrou", kRoundRotor, 0.001, machines);
  EXPECT_NEAR(j.chi_square, 1, 0.03);
  EXPECT_LT(j.ratio, 1.6);
}
TEST(Likelihood, ReachesTheBoundOfRoundRotorMachines) { expect_bound_of_round_rotor_machines(kSomeMachines); }
TEST(LikelihoodFull, ReachesTheBoundOfRoundRotorMachines) {
  expect_bound_of_round_rotor_machines(kAllMachines);
}

TEST(Likelihood, SensitivitiesAreDerivativesOfTheResiduals) {
  const auto grid = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  const auto& machine = grid.plants[3].machine;
  Recording r = recorded(grid, 16, 2.063)[3];
  r.event = 2.0;
  const NoisyRecord record = noisy_record(with_noise(r, 0.002, 1), 13.0);
  std::vector<double> p = machine.p;
  p[0] *= 1.2;  // away from the optimum
  const std::array<double, kSteady> steady = {record.P0, record.Q0, record.V0, 0};
  const std::vector<ScaledParameter> by = {{0, 2.0}, {1, 0.04}, {4, 3.0}, {8, 0.1}, {13, 0.3}};
  const Filtered filtered = filter(*machine.effect, record, p, steady);
  const LinearisedResiduals l = linearise(*machine.effect, record, filtered, p, steady, by);
  const auto at = [&](std::size_t k, double change) {
    auto moved = p;
    auto point = steady;
    if (k < by.size())
      moved[static_cast<std::size_t>(by[k].index)] += change * by[k].scale;
    else
      point[k - by.size()] += change;
    return residuals(*machine.effect, record, filtered, l.response, moved, point);
  };
  EXPECT_LT((at(0, 0) - l.value).norm(), 1e-8);
  for (std::size_t k = 0; k < by.size() + kSteady; ++k) {
    const Eigen::VectorXd difference = (at(k, 1e-5) - at(k, -1e-5)) / 2e-5;
    EXPECT_LT((difference - l.jacobian().col(static_cast<Eigen::Index>(k))).norm(), 2e-3 * difference.norm())
        << k;
  }
}

TEST(Likelihood, NamesUnsupportedMachines) {
  EXPECT_TRUE(has_likelihood(*library::compiled().find("GENROU")));
  EXPECT_TRUE(has_likelihood(*library::compiled().find("GENCLS")));
  EXPECT_FALSE(has_likelihood(*library::compiled().find("GENTPJ")));
}

}  // namespace
}  // namespace swingbank::sim::direct
