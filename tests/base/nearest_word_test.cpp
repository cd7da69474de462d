#include "base/nearest_word.hpp"

#include <gtest/gtest.h>

namespace swingbank {
namespace {

const std::vector<std::string> kEffects = {"GENCLS", "GENROU", "GENSAL", "SEXS", "ESDC1A", "ESDC2A"};

TEST(NearestWord, ReturnsTheWordWithTheFewestEdits) {
  EXPECT_EQ(nearest_word("GENRUO", kEffects), "GENROU");
  EXPECT_EQ(nearest_word("GENRUO", {"GENROE", "GENROU"}), "GENROU");  // two letters swapped
  EXPECT_EQ(nearest_word("Xddp", {"Xdp", "Xdpp"}), "Xdpp");           // of the same length
  EXPECT_EQ(nearest_word("ESDC2", kEffects), "ESDC2A");
  EXPECT_EQ(nearest_word("ESDC2B", kEffects), "ESDC2A");
}
TEST(NearestWord, AcceptsPrefixesInAnyCase) {
  EXPECT_EQ(nearest_word("SEX", kEffects), "SEXS");
  EXPECT_EQ(nearest_word("sexs", kEffects), "SEXS");
}
TEST(NearestWord, ReturnsNothing_WhenNoWordIsNear) {
  EXPECT_EQ(nearest_word("nonesuch", kEffects), "");
  EXPECT_EQ(nearest_word("D", {"H", "Xd"}), "");  // half of the word differs, so it is not a typing error
  EXPECT_EQ(suggestion("nonesuch", kEffects, "see the list"), "see the list");
  EXPECT_EQ(suggestion("GENRUO", kEffects, "see the list"), "did you mean GENROU?");
}

}  // namespace
}  // namespace swingbank
