#include "base/sealed_text.hpp"

#include <gtest/gtest.h>

#include "base/json.hpp"

namespace swingbank {
namespace {

TEST(SealedText, DetectsEveryChangedByte) {
  for (const int indent : {-1, 1}) {
    const nlohmann::json object = {{"rows", 12}, {"hash", "0123"}, {"list", {1, 2}}};
    const std::string text = sealed_text(object.dump(indent));
    ASSERT_TRUE(is_sealed(text));
    EXPECT_TRUE(is_sealed(text.substr(0, text.size() - 1)));
    EXPECT_EQ(nlohmann::json::parse(text).at("rows"), 12);
    for (std::size_t i = 0; i + 1 < text.size(); ++i)
      for (const int bit : {1, 32, 128}) {
        std::string changed = text;
        changed[i] = static_cast<char>(changed[i] ^ bit);
        EXPECT_FALSE(is_sealed(changed)) << i;
      }
    for (std::size_t n = 0; n + 1 < text.size(); ++n) EXPECT_FALSE(is_sealed(text.substr(0, n)));
    EXPECT_FALSE(is_sealed(text + text));
  }
}

}  // namespace
}  // namespace swingbank
