#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

void expect_round_trip(const network::Network& n) {
  for (const int version : {32, 33, 34, 35}) {
    SCOPED_TRACE(version);
    const ScratchFile file("out.raw");
    write_raw(n, file.path, version);
    expect_same(n, read_raw(file.path));
  }
}

class PsseWriteNetworks : public ::testing::TestWithParam<const char*> {};
TEST_P(PsseWriteNetworks, ReadBackToTheLastBit) {
  expect_round_trip(read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/" + GetParam() + ".raw"));
}
INSTANTIATE_TEST_SUITE_P(Committed, PsseWriteNetworks,
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
TEST(PsseWrite, RandomNumbersReadBackToTheLastBit) {
  for (const double base : {100.0, 33.3, 1.0 / 3.0, 12345.678901234567})
    for (unsigned seed = 1; seed <= 5; ++seed) expect_round_trip(random_network(base, seed));
}

TEST(PsseWrite, VersionsConvertWithoutLoss) {
  const network::Network n = random_network(100.0, 9);
  network::Network again = n;
  for (const int version : {33, 34, 35, 33, 32, 35, 34})
    again = parse_raw(raw_text(again, version, "text"), "text");
  expect_same(n, again);
}

TEST(PsseWrite, OtherVersionsAreRefused) {
  const network::Network n = random_network(100.0, 9);
  for (const int version : {0, 31, 36})
    EXPECT_THAT(sentences_of([&] { raw_text(n, version, "out.raw"); }),
                HasSubstr("version " + std::to_string(version)));
}

TEST(PsseWrite, RefusesContentThatARawCannotHold) {
  network::Network n = read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee14_genrou.raw");
  n.branches[0].tap = 0.9;
  n.branches.back().b = 0.1;
  const ScratchFile file("out.raw");
  const auto text = sentences_of([&] { write_raw(n, file.path); });
  EXPECT_THAT(text, HasSubstr("branch 1-2 circuit 1"));
  EXPECT_THAT(text, HasSubstr("branch 5-6 circuit 1"));
  EXPECT_FALSE(std::filesystem::exists(file.path));
}

TEST(PsseWrite, ImpossiblePathLeavesNoFile) {
  const network::Network n = read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee14_genrou.raw");
  EXPECT_THAT(sentences_of([&] { write_raw(n, "/nowhere/at/all/out.raw"); }), HasSubstr("No such file"));
  // The target is a folder: the rename fails and the temporary file is removed.
  const ScratchFile file("out.raw");
  std::filesystem::create_directories(file.path / "inside");
  EXPECT_THAT(sentences_of([&] { write_raw(n, file.path); }), HasSubstr("cannot write the file"));
  int left = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(file.path.parent_path()))
    ++left;
  EXPECT_EQ(left, 1);
}

}  // namespace
}  // namespace swingbank::sim::formats
