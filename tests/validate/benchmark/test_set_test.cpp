// Tests file of a benchmark: keys, faults with their lines, and the record of each test.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/support.hpp"
#include "validate/benchmark/generated_input.hpp"

namespace swingbank::validate::benchmark {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char* const kDip = R"(name = "set"
[operating_point]
P = 0.8
Q = 0.1
V = 1.0
rate = 200
[[test]]
name = "dip"
kind = "voltage_dip"
event = 1.0
end = 1.15
size = -0.5
pre = [0.5, 1.0]
post = [1.2, 5.0]
)";

std::vector<std::string> complaints(const std::string& text) {
  return test::messages([&] { parse_tests(text, "set.toml"); });
}
std::vector<std::string> missing(TestSet& set, const std::vector<std::string>& given, bool generate) {
  Problems problems;
  find_records(set, given, generate, problems);
  return test::messages([&] { problems.raise(); });
}

TEST(BenchmarkTestSetTest, ReadsAllKeys) {
  const TestSet set = parse_tests(kDip, "set.toml");
  ASSERT_EQ(set.tests.size(), 1U);
  const benchmark::Test& t = set.tests.front();
  EXPECT_EQ(t.name, "dip");
  EXPECT_EQ(t.kind, TestKind::voltage_dip);
  EXPECT_EQ(t.event, 1.0);
  EXPECT_EQ(t.last(), 1.15);
  EXPECT_EQ(t.size, -0.5);
  EXPECT_EQ(t.pre, (Interval{0.5, 1.0}));
  EXPECT_FALSE(t.during);
  EXPECT_EQ(t.post, (Interval{1.2, 5.0}));
  EXPECT_EQ(set.initial->P, 0.8);
  EXPECT_THAT(t.where, HasSubstr("set.toml:7"));
}

TEST(BenchmarkTestSetTest, ReportsAllFaultsWithTheirLines) {
  const auto all = complaints(R"(name = "set"
[[test]]
name = "a b"
kind = "voltage_dip"
event = 1.0
size = 0.5
[[test]]
name = "c"
kind = "dip"
event = 1.0
[[test]]
name = "d"
kind = "v_reference_step"
event = 2.0
end = 1.0
post = [0.5, 3.0]
color = "red"
)");
  const std::vector<::testing::Matcher<std::string>> expected = {
      AllOf(HasSubstr("name 'a b'"), HasSubstr("set.toml:3")),         HasSubstr("no end"),
      AllOf(HasSubstr("size = 0.5 pu"), HasSubstr("set.toml:6")),      HasSubstr("set.toml:9"),
      AllOf(HasSubstr("end = 1 s"), HasSubstr("set.toml:15")),         HasSubstr("no size"),
      AllOf(HasSubstr("post = [0.5, 3] s"), HasSubstr("set.toml:16")), HasSubstr("color")};
  EXPECT_THAT(all, ::testing::IsSupersetOf(expected));
}

TEST(BenchmarkTestSetTest, RefusesSetWithoutTestsAndEqualNames) {
  EXPECT_THAT(complaints("name = \"x\"\n"), ElementsAre(HasSubstr("no test")));
  const std::string twice = std::string(kDip) + std::string(kDip).substr(std::string(kDip).find("[[test]]"));
  EXPECT_THAT(complaints(twice), ElementsAre(HasSubstr("two tests named 'dip'")));
}

TEST(BenchmarkTestSetTest, FindsRecordsByNameAndByKey) {
  TestSet set = parse_tests(kDip, "folder/set.toml");
  EXPECT_THAT(missing(set, {"emt/dip.csv"}, false), IsEmpty());
  EXPECT_EQ(set.tests.front().record, "emt/dip.csv");
  set = parse_tests(std::string(kDip) + "record = \"run_7.inf\"\n", "folder/set.toml");
  EXPECT_THAT(missing(set, {}, false), IsEmpty());
  EXPECT_EQ(set.tests.front().record, "folder/run_7.inf");
  set = parse_tests(std::string(kDip) + "record = \"run_7.inf\"\n", "folder/set.toml");
  EXPECT_THAT(missing(set, {"emt/run_7.inf"}, false), IsEmpty());
  EXPECT_EQ(set.tests.front().record, "emt/run_7.inf");
}

TEST(BenchmarkTestSetTest, RefusesTestsWithoutInputAndUnusedRecords) {
  TestSet set = parse_tests(kDip, "set.toml");
  EXPECT_THAT(missing(set, {"emt/swell.csv"}, false),
              ElementsAre(AllOf(HasSubstr("no record for test 'dip'"), HasSubstr("set.toml:7")),
                          AllOf(HasSubstr("swell.csv"), HasSubstr("--records"))));
  EXPECT_THAT(missing(set, {}, true), IsEmpty());
  set.initial.reset();
  EXPECT_THAT(missing(set, {}, true), ElementsAre(HasSubstr("no operating point")));
  set = parse_tests(kDip, "set.toml");
  set.tests.front().size.reset();
  EXPECT_THAT(missing(set, {}, true), ElementsAre(HasSubstr("no size")));
}

TEST(BenchmarkGeneratedInputTest, DipAndRamp) {
  const auto model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const TestSet set = parse_tests(kDip, "set.toml");
  benchmark::Test t = set.tests.front();
  record::Record r = generated_input(t, *set.initial, model);
  ASSERT_EQ(r.samples(), 1001);
  EXPECT_EQ(r.V[200], 1.0);  // 1 s: a sample at the switching has the value before it
  EXPECT_EQ(r.V[201], 0.5);
  EXPECT_EQ(r.V[230], 0.5);
  EXPECT_EQ(r.V[231], 1.0);
  EXPECT_NEAR(r.P[500] * r.base.mva, 0.8 * model.plant.mva, 1e-9);
  t.kind = TestKind::frequency_ramp;
  t.end = 2.0;
  t.size = 0.5;
  r = generated_input(t, *set.initial, model);
  EXPECT_NEAR(r.theta[400], constants::turn * 0.25, 1e-12);          // 0.5 Hz/s for 1 s
  EXPECT_NEAR(r.theta[600], constants::turn * (0.25 + 0.5), 1e-12);  // then 0.5 Hz
  EXPECT_EQ(r.V[300], 1.0);
}

TEST(BenchmarkTestSetTest, LimitsTheSamplesOfAGeneratedInput) {
  std::string text = kDip;
  text.replace(text.find("rate = 200"), 10, "rate = 2e5");
  TestSet set = parse_tests(text, "set.toml");
  EXPECT_THAT(missing(set, {}, true), IsEmpty());  // 5 s
  set.tests.front().post->second = 5.1;
  EXPECT_THAT(
      missing(set, {}, true),
      ElementsAre(AllOf(HasSubstr("1.02e+06 samples of test 'dip' at set.toml"), HasSubstr("lower rate"))));
}

}  // namespace
}  // namespace swingbank::validate::benchmark
