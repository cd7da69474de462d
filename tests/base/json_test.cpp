#include "base/json.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace swingbank {
namespace {

using nlohmann::json;

template <class T>
void expect_refused(const std::string& text) {
  EXPECT_THROW((void)json::parse(text).get<T>(), json::type_error) << text;
}

TEST(Json, AcceptsIntegersThatFitTheType) {
  EXPECT_EQ(json::parse("18446744073709551615").get<std::uint64_t>(), UINT64_MAX);
  EXPECT_EQ(json::parse("-128").get<std::int8_t>(), -128);
  for (const char* text : {"1.3e95", "-1", "1.5", "2.0", "18446744073709551616", "true", "\"1\"", "null"})
    expect_refused<std::uint64_t>(text);
  expect_refused<std::int64_t>("9223372036854775808");
  expect_refused<std::uint8_t>("256");
  expect_refused<std::int8_t>("-129");
}

TEST(Json, ChecksIntegersInListsAndObjects) {
  EXPECT_EQ(json::parse("[1, 2]").get<std::vector<int>>(), (std::vector<int>{1, 2}));
  expect_refused<std::vector<int>>("[1, 2.5]");
  expect_refused<std::map<std::string, std::uint64_t>>(R"({"stable": -1})");
  EXPECT_THROW((void)json::parse(R"({"seed": 0.5})").value("seed", 1), json::type_error);
}

TEST(Json, ErrorNamesExpectedAndFoundType) {
  try {
    (void)json::parse("-7").get<std::uint8_t>();
    FAIL() << "it was read";
  } catch (const json::type_error& e) {
    EXPECT_NE(std::string(e.what()).find("a whole number of 0 to 255 is expected, not -7"), std::string::npos)
        << e.what();
  }
}

TEST(Json, ReadsOtherNumbersAndTextsUnchanged) {
  EXPECT_EQ(json::parse("5").get<double>(), 5.0);
  EXPECT_TRUE(json::parse("true").get<bool>());
  EXPECT_EQ(json(std::uint8_t{7}).dump() + json(-3).dump() + json(true).dump(), "7-3true");
}

}  // namespace
}  // namespace swingbank
