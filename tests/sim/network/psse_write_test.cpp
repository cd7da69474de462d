#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <random>

#include "tests/sim/network/raw_case.hpp"

namespace swingbank::sim {
namespace {

using ::testing::HasSubstr;

/// Every number of a network, in one order, as bits; names and flags as text.
struct Flat {
  std::vector<std::uint64_t> numbers;
  std::string words;
  void add(double v) { numbers.push_back(std::bit_cast<std::uint64_t>(v)); }
  void add(Complex v) {
    add(v.real());
    add(v.imag());
  }
  template <class... T>
  void all(const T&... v) {
    (add(v), ...);
  }
};
Flat flatten(const Network& n) {
  Flat f;
  f.words = n.title;
  f.all(n.base_mva, n.frequency);
  for (const Bus& b : n.buses) {
    f.words += "|" + std::to_string(b.number) + b.name + std::to_string(static_cast<int>(b.type));
    f.all(b.kv, b.vm, b.va);
  }
  for (const Load& l : n.loads) {
    f.words += "|" + std::to_string(l.bus) + l.id;
    f.all(l.power, l.current, l.admittance);
  }
  for (const Shunt& s : n.shunts) {
    f.words += "|" + std::to_string(s.bus) + s.id;
    f.add(s.admittance);
  }
  for (const Branch& b : n.branches) {
    f.words += "|" + std::to_string(b.from) + "-" + std::to_string(b.to) + b.circuit +
               (b.in_service ? "on" : "off") + (b.transformer ? "T" : "L");
    f.all(b.r, b.x, b.b, b.tap, b.shift, b.shunt_from, b.shunt_to);
  }
  for (const Generator& g : n.generators) {
    f.words += "|" + std::to_string(g.bus) + g.id + (g.in_service ? "on" : "off");
    f.all(g.p, g.q, g.vset, g.mva, g.zr, g.zx, g.q_min, g.q_max);
  }
  return f;
}
void expect_round_trip(const Network& n) {
  const ScratchFile file("out.raw");
  write_raw(n, file.path);
  const Flat a = flatten(n), b = flatten(read_raw(file.path));
  EXPECT_EQ(a.words, b.words);
  ASSERT_EQ(a.numbers.size(), b.numbers.size());
  for (std::size_t i = 0; i < a.numbers.size(); ++i)
    ASSERT_EQ(a.numbers[i], b.numbers[i]) << "number " << i << ": " << std::bit_cast<double>(a.numbers[i]);
}

class PsseWriteNetworks : public ::testing::TestWithParam<const char*> {};
TEST_P(PsseWriteNetworks, ReadBackToTheLastBit) {
  expect_round_trip(read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/" + GetParam() + ".raw"));
}
INSTANTIATE_TEST_SUITE_P(Committed, PsseWriteNetworks,
                         ::testing::Values("ieee14_genrou", "ieee39_gencls", "ieee39_genrou",
                                           "ieee14_dataset_genrou", "ieee39_dataset_gencls",
                                           "ieee39_dataset_genrou"));

/// Doubles with all 53 bits in use, on bases that no decimal divides: the hardest case for a text file.
Network random_network(double base, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-3.0, 3.0);
  std::uniform_real_distribution<double> decade(-9.0, 4.0);
  const auto any = [&] { return value(random) * std::pow(10.0, decade(random)); };
  const auto positive = [&] { return std::abs(any()) + 1e-12; };
  Network n;
  n.title = "random\nnumbers, 'quoted'";
  n.base_mva = base;
  n.frequency = 50.0;
  for (int i = 0; i < 40; ++i)
    n.buses.push_back({100 + i, "B'" + std::to_string(i) + ", /", positive(),
                       i == 0 ? BusType::slack : BusType::generator, positive(), value(random)});
  for (int i = 0; i < 40; ++i) {
    n.loads.push_back({i, "L", {any(), any()}, {any(), any()}, {any(), any()}});
    n.shunts.push_back({i, "S", {any(), any()}});
    n.generators.push_back(
        {i, "G1", any(), any(), positive(), positive(), any(), any(), i % 3 != 0, any(), any()});
    n.branches.push_back(
        {i, (i + 1) % 40, "C", any(), any(), any(), 1.0, 0.0, {any(), any()}, {any(), any()}, i % 2 == 0});
  }
  for (int i = 0; i < 40; ++i)
    n.branches.push_back({i,
                          (i + 7) % 40,
                          "T",
                          any(),
                          any(),
                          0.0,
                          positive(),
                          value(random),
                          {any(), any()},
                          {},
                          i % 2 == 1,
                          true});
  return n;
}
TEST(PsseWrite, RandomNumbersReadBackToTheLastBit) {
  for (const double base : {100.0, 33.3, 1.0 / 3.0, 12345.678901234567})
    for (unsigned seed = 1; seed <= 5; ++seed) expect_round_trip(random_network(base, seed));
}

TEST(PsseWrite, RefusesWhatARawCannotHold) {
  Network n = read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee14_genrou.raw");
  n.branches[0].tap = 0.9;
  n.branches.back().b = 0.1;
  const ScratchFile file("out.raw");
  const auto text = sentences_of([&] { write_raw(n, file.path); });
  EXPECT_THAT(text, HasSubstr("branch 1-2 circuit 1"));
  EXPECT_THAT(text, HasSubstr("branch 5-6 circuit 1"));
  EXPECT_FALSE(std::filesystem::exists(file.path));
}

TEST(PsseWrite, AnImpossiblePathLeavesNothingBehind) {
  const Network n = read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee14_genrou.raw");
  EXPECT_THAT(sentences_of([&] { write_raw(n, "/nowhere/at/all/out.raw"); }), HasSubstr("No such file"));
  // A folder stands where the file should go: the rename fails and the temporary file is removed.
  const ScratchFile file("out.raw");
  std::filesystem::create_directories(file.path / "inside");
  EXPECT_THAT(sentences_of([&] { write_raw(n, file.path); }), HasSubstr("cannot rename"));
  int left = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(file.path.parent_path()))
    ++left;
  EXPECT_EQ(left, 1);
}

}  // namespace
}  // namespace swingbank::sim
