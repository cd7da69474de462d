#include "sim/plant/orderings.hpp"

#include <gmock/gmock.h>

#include <random>

#include "sim/library/library.hpp"

namespace swingbank::sim::plant {
namespace {

/// Values within a factor of four of the defaults.
Block drawn(const Effect& effect, std::mt19937& random) {
  std::uniform_real_distribution<double> factor(-1.4, 1.4);
  Block block{&effect, effect.default_parameters()};
  for (double& value : block.p) value = std::max(value, 0.01) * std::exp(factor(random));
  return block;
}

TEST(Orderings, MatchTheChecksOfEveryMachine) {
  std::mt19937 random(7);
  int machines = 0, sound = 0;
  for (const Effect& effect : library::compiled_effects()) {
    if (effect.slot != Slot::machine) continue;
    ++machines;
    EXPECT_TRUE(violated({&effect, effect.default_parameters()}).empty()) << effect.name;
    for (int k = 0; k < 20000; ++k) {
      const Block block = drawn(effect, random);
      const bool physical = effect.unphysical(block.p.data()).empty();
      ASSERT_EQ(violated(block).empty(), physical)
          << effect.name << ": " << effect.unphysical(block.p.data());
      sound += physical ? 1 : 0;
    }
  }
  EXPECT_GE(machines, 6);
  EXPECT_GT(sound, 100);  // both outcomes occurred
}

TEST(Orderings, NameBothParametersAndIgnoreZeros) {
  const Effect& round = *library::compiled().find("GENROU");
  Block block{&round, round.default_parameters()};
  const auto set = [&](const char* name, double value) {
    block.p[static_cast<std::size_t>(round.parameter_index(name))] = value;
  };
  set("S10", 0.0);
  set("S12", 0.0);
  EXPECT_TRUE(violated(block).empty());
  set("Xd", 0.147);
  set("Xdp", 1.53);
  ASSERT_FALSE(violated(block).empty());
  EXPECT_EQ(violation_text(block, violated(block).front()), "Xd = 0.147 pu is not above X'd = 1.53 pu");
  set("Xdp", 0.3);
  set("Xd", 1.8);
  set("Xdpp", 0.2);
  set("Xl", 0.224);  // X''d is also X''q: reported once
  EXPECT_EQ(violated(block).size(), 1u);
}

}  // namespace
}  // namespace swingbank::sim::plant
