// Benchmark of a model against itself, against another one, and against a record that it cannot follow.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/json.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/benchmark/generated_input.hpp"
#include "validate/benchmark/report.hpp"

namespace swingbank::validate::benchmark {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kSet = R"(name = "set"
[operating_point]
P = 0.5
Q = 0.1
V = 1.0
rate = 200
[[test]]
name = "dip"
kind = "voltage_dip"
event = 1.0
end = 1.15
size = -0.3
pre = [0.5, 1.0]
post = [1.2, 4.0]
[[test]]
name = "ramp"
kind = "frequency_ramp"
event = 0.5
end = 1.5
size = -0.2
post = [1.5, 4.0]
[[test]]
name = "angle"
kind = "phase_step"
event = 0.5
size = 10
post = [0.5, 3.0]
)";

class BenchmarkTest : public ::testing::Test {
 protected:
  std::vector<TestResult> run(const plant::PlantModel& model, const plant::PlantModel* against) {
    records_.clear();
    for (const benchmark::Test& t : set_.tests) records_.push_back(generated_input(t, *set_.initial, model));
    return run_benchmark(set_.tests, {.model = model, .against = against, .records = records_, .by = by_});
  }
  /// Returns the model with a changed inertia.
  static plant::PlantModel heavier(const plant::PlantModel& model, double factor) {
    plant::PlantModel other = model;
    const int h = other.plant.machine.effect->parameter_index("H");
    other.plant.machine.p[static_cast<std::size_t>(h)] *= factor;
    return other;
  }

  TestSet set_ = parse_tests(kSet, "set.toml");
  thresholds::Acceptance by_ = thresholds::read_acceptance("dtr-simulation");
  std::vector<record::Record> records_;
  plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
};

TEST_F(BenchmarkTest, ModelAgainstItselfHasNoError) {
  const auto results = run(model_, &model_);
  EXPECT_TRUE(passes(results));
  for (const TestResult& r : results) {
    const double windows = r.test.end ? 3 : 2;
    EXPECT_EQ(r.rows.size(), 2 * windows) << r.test.name;  // of P and Q
    for (const auto& row : r.rows) EXPECT_EQ(row.errors.mxe, 0) << r.test.name << row.channel;
    const auto& P = r.event.channels.front().modelled;
    EXPECT_GT(*std::ranges::max_element(P) - *std::ranges::min_element(P), 1e-3) << r.test.name;
  }
}

TEST_F(BenchmarkTest, ErrorsAreThoseOfTheSamplesInEachWindow) {
  const auto other = heavier(model_, 1.3);
  const auto results = run(model_, &other);
  const TestResult& r = results.front();
  const auto& e = r.event;
  const double to_mva = 100 * e.record.base.mva / model_.plant.mva;
  // Before the fault, during it without its first 20 ms, and after it from 1.21 s on, without the first 60
  // ms.
  const std::pair<double, double> windows[] = {{0.5, 1.0}, {1.02, 1.15}, {1.21, 4.0}};
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t w = 0; w < 3; ++w) {
      double most = 0, sum = 0, size = 0;
      int samples = 0;
      for (std::size_t k = 0; k < e.record.t.size(); ++k) {
        const double t = e.record.t[k],
                     error = to_mva * (e.channels[c].modelled[k] - e.channels[c].measured[k]);
        if (t < windows[w].first + (w > 0 ? 1e-3 : -1e-3) || t > windows[w].second + 1e-3) continue;
        most = std::max(most, std::abs(error));
        sum += error;
        size += std::abs(error);
        ++samples;
      }
      const auto& row = r.rows[3 * c + w];
      EXPECT_EQ(row.samples, samples) << c << w;
      EXPECT_NEAR(row.errors.mxe, most, 1e-9);
      EXPECT_NEAR(row.errors.me, sum / samples, 1e-9);
      EXPECT_NEAR(row.errors.mae, size / samples, 1e-9);
    }
  EXPECT_GT(r.rows[2].errors.mxe, 0.01);  // P after the dip
}

TEST_F(BenchmarkTest, LimitsDecide) {
  const auto other = heavier(model_, 3);
  by_ = thresholds::parse_acceptance(
      "name = \"narrow\"\nsource = \"test\"\npreset = \"dtr-simulation\"\n[P.post_fault]\nmxe = 0.01\n",
      "a.toml");
  const auto results = run(model_, &other);
  EXPECT_FALSE(passes(results));
  const ReportContext context{
      .model = model_, .reference = "heavier", .set = set_, .by = by_, .provenance = {}};
  const auto j = nlohmann::json::parse(json_report(results, context));
  EXPECT_EQ(j["format"], "swingbank-benchmark-1");
  EXPECT_EQ(j["passes"], false);
  const auto& post = j["tests"][0]["errors"][2];
  EXPECT_EQ(post["window"], "post");
  EXPECT_EQ(post["passes"], false);
  EXPECT_EQ(post["limits_percent"]["mxe"], 0.01);
  EXPECT_NEAR(post["pu"]["mxe"].get<double>(), post["percent"]["mxe"].get<double>() / 100, 1e-12);
  EXPECT_THAT(terminal_report(results, context, true), AllOf(HasSubstr("fail"), HasSubstr("of 0.01 % *")));
  EXPECT_THAT(html_report(results, context), AllOf(HasSubstr("Model fails"), HasSubstr("played in")));
  EXPECT_THAT(csv_report(results), HasSubstr("dip,voltage_dip,P,post,"));
}

TEST_F(BenchmarkTest, ReferenceStepsActOnTheControls) {
  set_ = parse_tests(R"(name = "set"
[operating_point]
P = 0.5
Q = 0.1
V = 1.0
rate = 60
[[test]]
name = "p"
kind = "p_reference_step"
event = 1.0
size = 0.1
post = [1.0, 20.0]
)",
                     "set.toml");
  Problems problems;
  check_controls(set_, model_, problems);
  EXPECT_THAT(test::messages([&] { problems.raise(); }),
              ElementsAre(AllOf(HasSubstr("no control with that reference"), HasSubstr("set.toml:7"))));
  plant::PlantModel governed = model_;
  governed.plant.controls.push_back(test::block("TGOV1", ""));
  check_controls(set_, governed, problems = {});
  EXPECT_TRUE(problems.empty());
  const auto results = run(governed, &governed);
  const auto& P = results.front().event.channels.front().modelled;  // pu on the record's base
  const int droop = governed.plant.controls.back().effect->parameter_index("R");
  // At a fixed frequency, a step of the governor's reference changes the power by step / R.
  const double R = governed.plant.controls.back().p[static_cast<std::size_t>(droop)];
  EXPECT_GT(P.back() - P.front(), 0.01);
  EXPECT_LT((P.back() - P.front()) * records_.front().base.mva / governed.plant.mva, 0.1 / R + 1e-3);
}

TEST_F(BenchmarkTest, TestThatTheModelCannotFollowFails) {
  model_.plant.controls.push_back(test::block("TGOV1", ""));
  set_.initial->P = 1.5;  // above the valve's limit
  const auto results = run(model_, nullptr);
  EXPECT_FALSE(passes(results));
  EXPECT_FALSE(results.front().failure.empty());
  EXPECT_EQ(results.front().event.windows.size(), 3U);  // known without a response
  const ReportContext context{.model = model_, .reference = "EMT", .set = set_, .by = by_, .provenance = {}};
  EXPECT_THAT(csv_report(results), HasSubstr("dip,voltage_dip,,,,,,,,,,,,,fail"));
  EXPECT_THAT(html_report(results, context), HasSubstr("The simulation of this test failed"));
}

TEST_F(BenchmarkTest, RefusesRecordThatLacksAWindow) {
  set_.tests.front().post = Interval{1.2, 4.0};
  records_ = {generated_input(set_.tests.front(), *set_.initial, model_)};
  set_.tests.front().post = Interval{1.2, 9.0};
  set_.tests.resize(1);
  EXPECT_THAT(
      test::messages([&] { run_benchmark(set_.tests, {.model = model_, .records = records_, .by = by_}); }),
      ElementsAre(AllOf(HasSubstr("window post of test 'dip', 1.2 to 9 s"), HasSubstr("set.toml:7"))));
}

}  // namespace
}  // namespace swingbank::validate::benchmark
