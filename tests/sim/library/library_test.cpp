// Libraries are values: an effect added to one is absent from all others.
#include "sim/library/library.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "sim/library/variants.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::sim::library {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

/// User-defined model MINE with one parameter and `factor` in its equation and description.
std::string user_model(double factor) {
  return fmt::format(R"law(name = "MINE"
title = "{0} times the speed"
source = "test"
output = "Vs"
action = "add"
value = "{0} * K * speed"
[parameters]
K = {{ unit = "pu", default = {0}, low = 0.0, high = 1000.0, null_value = 0.0, meaning = "gain" }}
)law",
                     factor);
}
double standard(const EffectLibrary& library) { return library.find("MINE")->default_parameters().at(0); }

TEST(EffectLibrary, VariantsReferToANonVariantOfTheirSlot) {
  int variants = 0;
  for (const Effect& effect : compiled_effects())
    if (const Effect* other = variant_of(effect)) {
      ++variants;
      EXPECT_EQ(other->slot, effect.slot) << effect.name;
      EXPECT_EQ(variant_of(*other), nullptr) << effect.name;
    }
  EXPECT_GE(variants, 10);
  EXPECT_EQ(variant_of(*compiled().find("SCRX")), compiled().find("SEXS"));
  EXPECT_EQ(variant_of(*compiled().find("SEXS")), nullptr);
}

TEST(EffectLibrary, HoldsTheCompiledEffects) {
  const EffectLibrary library;
  ASSERT_EQ(library.all().size(), compiled_effects().size());
  for (const Effect& effect : compiled_effects()) EXPECT_EQ(library.find(effect.name), &effect);
  EXPECT_EQ(library.find("genrou"), library.find("GENROU"));
  EXPECT_EQ(library.find("MINE"), nullptr);
  EXPECT_THAT(library.names(Slot::machine), HasSubstr("GENROU"));
  EXPECT_THAT(library.names(Slot::machine), Not(HasSubstr("SEXS")));
}

TEST(EffectLibrary, LibrariesWithEqualNamesAreIndependent) {
  EffectLibrary one, other;
  user_models::load_user_model(user_model(2.0), "law.toml", one);
  user_models::load_user_model(user_model(3.0), "law.toml", other);
  EXPECT_EQ(standard(one), 2.0);
  EXPECT_EQ(standard(other), 3.0);
  EXPECT_EQ(compiled().find("MINE"), nullptr);
  EXPECT_THAT(one.names(), EndsWith(", MINE"));
  EXPECT_THAT(one.names(Slot::stabiliser), EndsWith(", MINE"));
}

TEST(EffectLibrary, CopySharesOnlyEarlierEffects) {
  EffectLibrary copy;
  const Effect* shared = nullptr;
  {
    EffectLibrary first;
    shared = &user_models::load_user_model(user_model(2.0), "law.toml", first);
    copy = first;
    std::string later = user_model(3.0);
    later.replace(later.find("MINE"), 4, "LATER");
    user_models::load_user_model(later, "later.toml", first);
  }
  EXPECT_EQ(copy.find("MINE"), shared);  // outlives the library that read it
  EXPECT_EQ(shared->default_parameters(), std::vector<double>{2.0});
  EXPECT_EQ(copy.find("LATER"), nullptr);
}

TEST(EffectLibrary, RefusesDuplicateNames) {
  EffectLibrary library;
  library.add(user_models::make_user_model(user_model(2.0), "law.toml"));
  try {
    library.add(user_models::make_user_model(user_model(3.0), "law.toml"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a second effect 'MINE'"));
  }
  Effect compiled_name = user_models::make_user_model(user_model(3.0), "law.toml");
  compiled_name.name = "sexs";
  EXPECT_THROW(library.add(compiled_name), InputError);
  EXPECT_EQ(standard(library), 2.0);
  EXPECT_EQ(library.all().size(), compiled_effects().size() + 1);
}

TEST(EffectLibrary, ThreadsReadingEqualNamesGetTheirOwnEffects) {
  constexpr int kThreads = 4, kRounds = 50;
  std::vector<int> own(kThreads);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([t, &own] {
        for (int k = 0; k < kRounds; ++k) {
          EffectLibrary library;
          user_models::load_user_model(user_model(1.0 + t), "law.toml", library);
          own[static_cast<std::size_t>(t)] += standard(library) == 1.0 + t;
        }
      });
  }
  EXPECT_EQ(own, std::vector<int>(kThreads, kRounds));
}

}  // namespace
}  // namespace swingbank::sim::library
