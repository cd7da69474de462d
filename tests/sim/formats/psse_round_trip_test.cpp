#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/formats/write_raw.hpp"

namespace swingbank::sim::formats {
namespace {

void expect_round_trip(const network::Network& n) {
  for (const int version : {32, 33, 34, 35}) {
    SCOPED_TRACE(version);
    const ScratchFile file("out.raw");
    write_raw(n, file.path, version);
    expect_same(n, read_raw(file.path));
  }
}

class PsseRoundTripNetworks : public ::testing::TestWithParam<const char*> {};
TEST_P(PsseRoundTripNetworks, ReadBackToTheLastBit) {
  expect_round_trip(read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/" + GetParam() + ".raw"));
}
INSTANTIATE_TEST_SUITE_P(Committed, PsseRoundTripNetworks,
                         ::testing::Values("ieee14_genrou", "ieee39_gencls", "ieee39_genrou",
                                           "ieee14_dataset_genrou", "ieee39_dataset_gencls",
                                           "ieee39_dataset_genrou"));

/// Doubles that use all 53 bits, on bases without a finite decimal quotient: the hardest case for a text
/// file.
network::Network random_network(double base, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-3.0, 3.0);
  std::uniform_real_distribution<double> decade(-9.0, 4.0);
  const auto any = [&] { return value(random) * std::pow(10.0, decade(random)); };
  const auto positive = [&] { return std::abs(any()) + 1e-12; };
  // Above the least impedance of a branch (sim/network/tie.hpp), below which the reader changes it.
  const auto reactance = [&] {
    const double x = any();
    return x + std::copysign(1e-5, x);
  };
  network::Network n;
  n.title = "random\nnumbers, 'quoted'";
  n.base_mva = base;
  n.frequency = 50.0;
  for (int i = 0; i < 40; ++i)
    n.buses.push_back({100 + i, "B'" + std::to_string(i) + ", /", positive(),
                       i == 0 ? network::BusType::slack : network::BusType::generator, positive(),
                       value(random), i % 5, i % 7, i % 3});
  for (int i = 0; i < 40; ++i) {
    n.loads.push_back({i, "L", {any(), any()}, {any(), any()}, {any(), any()}, i % 4, 9 - i % 9, 1 + i % 2});
    n.shunts.push_back({i, "S", {any(), any()}});
    // The slack generator and enough branches to connect all buses are in service; otherwise the reader
    // repairs the case.
    const auto [q_min, q_max] = std::minmax({any(), any()});
    n.generators.push_back({i, "G1", any(), any(), positive(), positive(), any(), any(), i % 3 != 1, q_min,
                            q_max, positive(), positive(), i % 6 == 2 ? (i + 3) % 40 : -1, positive()});
    n.branches.push_back({i,
                          (i + 1) % 40,
                          "C",
                          any(),
                          reactance(),
                          any(),
                          1.0,
                          0.0,
                          {any(), any()},
                          {any(), any()},
                          i % 4 != 1});
  }
  for (int i = 0; i < 40; ++i)
    n.branches.push_back({i,
                          (i + 7) % 40,
                          "T",
                          any(),
                          reactance(),
                          0.0,
                          positive(),
                          value(random),
                          {any(), any()},
                          {},
                          i % 3 != 0,
                          true});
  return n;
}
TEST(PsseRoundTrip, RandomNumbersReadBackToTheLastBit) {
  for (const double base : {100.0, 33.3, 1.0 / 3.0, 12345.678901234567})
    for (unsigned seed = 1; seed <= 5; ++seed) expect_round_trip(random_network(base, seed));
}

}  // namespace
}  // namespace swingbank::sim::formats
