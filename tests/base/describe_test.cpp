#include "base/describe.hpp"

#include <gmock/gmock.h>

#include "base/json.hpp"

namespace swingbank {
namespace {

using Json = nlohmann::json;

Json described(const std::function<void(Config&)>& read) { return Json::parse(describe_keys("test", read)); }

TEST(KeyDescription, HasTypesRangesDefaultsAndMeanings) {
  const Json s = described([](Config& c) {
    c.require<double>("t.start", {0.5, 2.0, "s", "start"});
    c.optional<std::int64_t>("n", 3, {1, 10});
    c.optional<double>("base", 0.0, {1e-9, 1e9});  // the default 0 means "missing"; the file must not set it
    c.require<std::vector<std::string>>("words");
    c.interval("box", {0.0, 1.0});
    c.choice("kind", {"a", "b"}, "b");
  });
  EXPECT_EQ(s["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(s["properties"]["t"]["properties"]["start"], Json::parse(R"({"type": "number", "minimum": 0.5,
    "maximum": 2, "description": "start [s]"})"));
  EXPECT_EQ(s["properties"]["n"],
            Json::parse(R"({"type": "integer", "minimum": 1, "maximum": 10, "default": 3})"));
  EXPECT_FALSE(s["properties"]["base"].contains("default"));
  EXPECT_EQ(s["properties"]["words"], Json::parse(R"({"type": "array", "items": {"type": "string"}})"));
  EXPECT_EQ(s["properties"]["box"], Json::parse(R"({"type": "array", "items": {"type": "number", "minimum": 0,
    "maximum": 1}, "minItems": 2, "maxItems": 2})"));
  EXPECT_EQ(s["properties"]["kind"],
            Json::parse(R"({"type": "string", "enum": ["a", "b"], "default": "b"})"));
  EXPECT_EQ(s["required"], Json::parse(R"(["t", "words", "box"])"));
  EXPECT_EQ(s["properties"]["t"]["required"], Json::parse(R"(["start"])"));
  EXPECT_EQ(s["additionalProperties"], false);
}

TEST(KeyDescription, ExploresPresence) {
  const Json s = described([](Config& c) {
    if (c.has("table")) c.require<double>("table.value");
    if (c.has("preset"))
      c.choice("preset", {"one"});
    else
      c.require<double>("limit");
  });
  EXPECT_FALSE(s.contains("required"));
  EXPECT_EQ(s["properties"]["table"]["required"], Json::parse(R"(["value"])"));
  // If the preset is given, `limit` is an unknown key; otherwise it is required.
  EXPECT_EQ(s["allOf"], Json::parse(R"([
    {"if": {"required": ["preset"]}, "then": {"properties": {"limit": false}}},
    {"if": {"not": {"required": ["preset"]}}, "then": {"required": ["limit"]}}])"));
}

TEST(KeyDescription, HasKeysOfEveryBranch) {
  const auto read = [](Config& c) {
    const std::string name = c.branch("unit.effect", {.words = {"A", "B"}, .titles = {"first", "second"}});
    const bool lenient = c.optional<bool>("unit.lenient", false);
    const std::string key = name == "A" ? "unit.K" : "unit.T";
    lenient ? c.optional<double>(key, 1.0) : c.require<double>(key);
  };
  const Json s = described(read);
  EXPECT_EQ(s["properties"]["unit"], Json::parse(R"({"type": "object",
    "properties": {"effect": {"type": "string", "enum": ["A", "B"]}}, "required": ["effect"],
    "allOf": [{"anyOf": [{}, {"$ref": "#/definitions/A"}, {"$ref": "#/definitions/B"}]},
      {"if": {"type": "object", "properties": {"effect": {"enum": ["A"]}}, "required": ["effect"]},
       "then": {"$ref": "#/definitions/A"}},
      {"if": {"type": "object", "properties": {"effect": {"enum": ["B"]}}, "required": ["effect"]},
       "then": {"$ref": "#/definitions/B"}}]
    })"));
  const Json& b = s["definitions"]["B"];
  EXPECT_EQ(b["description"], "second");
  EXPECT_EQ(b["properties"]["effect"]["enum"], Json::parse(R"(["B"])"));
  EXPECT_EQ(b["properties"]["T"], Json::parse(R"({"type": "number", "default": 1.0})"));
  EXPECT_FALSE(b["properties"].contains("K"));
  EXPECT_EQ(b["required"], Json::parse(R"(["effect"])"));
  EXPECT_EQ(b["allOf"].size(), 1U);  // required unless lenient
}

TEST(KeyDescription, WritesShortPartsOnOneLine) {
  const std::string text = describe_keys("test", [](Config& c) {
    c.optional<bool>("flag", false);
    c.optional<std::string>("long", "", {.meaning = std::string(120, 'x')});
  });
  EXPECT_THAT(text, ::testing::HasSubstr("\n  \"flag\": {\"type\":\"boolean\",\"default\":false},\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("\n   \"type\": \"string\",\n"));
}

TEST(KeyDescription, HasTablesOfAnyNameAndNumber) {
  const Json s = described([](Config& c) {
    for (const auto& name : c.keys("plant")) c.require<std::string>("plant." + name + ".model");
    for (int k = 0; c.has("unit[" + std::to_string(k) + "]"); ++k)
      c.optional<double>("unit[" + std::to_string(k) + "].share", 0.5);
    if (c.is_array("list"))
      c.require<std::vector<double>>("list");
    else
      c.require<double>("list");
  });
  EXPECT_EQ(s["properties"]["plant"]["additionalProperties"]["required"], Json::parse(R"(["model"])"));
  EXPECT_EQ(s["properties"]["unit"]["type"], "array");
  EXPECT_TRUE(s["properties"]["unit"]["items"]["properties"].contains("share"));
  EXPECT_EQ(s["properties"]["list"], Json::parse(R"({"type": ["number", "array"], "allOf": [
    {"if": {"type": "number"}, "then": {"type": "number"}},
    {"if": {"type": "array"}, "then": {"type": "array", "items": {"type": "number"}}}]})"));
  EXPECT_EQ(s["required"], Json::parse(R"(["list"])"));
}

}  // namespace
}  // namespace swingbank
