// Sources of parameter values: stated once for an effect, or by a single parameter.
#include <gtest/gtest.h>

#include "sim/core/effect.hpp"

namespace swingbank::sim {
namespace {

constexpr Source kPage = literature::kundur("table 4.2"), kChosen = literature::own("for this test");

struct Model {
  static constexpr Source defaults_from = kPage, bounds_from = kChosen;
  static constexpr Parameter parameters[] = {
      {"a", "a", "s", 1.0, 0.0, 2.0, kNoNullValue, "of the effect"},
      {"b", "b", "s", 1.0, 0.0, 2.0, kNoNullValue, "standard of its own", literature::cim("GovGAST")},
      {"c", "c", "s", 1.0, 0.0, 2.0, kNoNullValue, "bounds of their own", kAsEffect,
       literature::derived("a time")}};
};

TEST(Literature, SourceOfAParameterPrecedesThatOfTheEffect) {
  const auto& [a, b, c] = kSourced<Model>;
  EXPECT_EQ(as_text(a.default_from), "Kundur: table 4.2");
  EXPECT_EQ(as_text(a.bounds_from), "own choice: for this test");
  EXPECT_EQ(as_text(b.default_from), "CIM: GovGAST");
  EXPECT_EQ(as_text(b.bounds_from), "own choice: for this test");
  EXPECT_EQ(as_text(c.default_from), "Kundur: table 4.2");
  EXPECT_EQ(as_text(c.bounds_from), "derived: a time");
}

TEST(Literature, OwnReasonIsNoPublishedWork) {
  EXPECT_TRUE(kPage.work->published());
  EXPECT_FALSE(kChosen.work->published());
  EXPECT_EQ(as_text(literature::user_model("my_limiter.toml")), "my_limiter.toml");
  EXPECT_FALSE(Source{}.given());
  EXPECT_FALSE(literature::own("").given());
}

}  // namespace
}  // namespace swingbank::sim
