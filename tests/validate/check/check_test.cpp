// Sound records are changed by every known mistake, and each mistake must be recognised. Unchanged records
// pass.
#include "validate/check/check.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/validate/playin/support.hpp"
#include "validate/check/signals.hpp"

namespace swingbank::validate::check {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string findings_text(const std::vector<Finding>& findings) {
  std::string all;
  for (const auto& f : findings)
    all += fmt::format("{} {}: {}\n", f.severity == Severity::refuse ? "refuse" : "warn", f.kind,
                       f.problem.sentence());
  return all;
}
bool refused(const std::vector<Finding>& findings, const std::string& kind) {
  return std::ranges::any_of(
      findings, [&](const Finding& f) { return f.severity == Severity::refuse && f.kind == kind; });
}

record::Record example(int i) {
  return record::read_record(test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", i)), {});
}

/// The record as a file with a changed header or changed values, as mistakes occur in practice. The column
/// names state the units.
struct Written {
  std::string V = "V_pu", theta = "theta_rad", P = "P_pu", Q = "Q_pu", f = "f_pu";
  std::function<void(std::vector<double>& row)> edit = [](auto&) {};  ///< t, V, theta, P, Q, f
  record::RecordBase base = {};
  double from = -1, to = 1e9;  ///< part of the record [s]
  bool with_frequency = true;
};
record::Record rewritten(const record::Record& r, const Written& w) {
  std::string text =
      fmt::format("t_s,{},{},{},{}{}\n", w.V, w.theta, w.P, w.Q, w.with_frequency ? "," + w.f : "");
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    if (r.t[k] < w.from || r.t[k] > w.to) continue;
    std::vector<double> row{r.t[k], r.V[k], r.theta_as_written[k], r.P[k], r.Q[k], 1 + r.f[k]};
    w.edit(row);
    text += fmt::format("{:.7f},{:.7f},{:.7f},{:.7f},{:.7f}", row[0], row[1], row[2], row[3], row[4]);
    text += w.with_frequency ? fmt::format(",{:.7f}\n", row[5]) : "\n";
  }
  return record::parse_record(text, "rewritten.csv", w.base);
}

struct Mistake {
  const char *name, *kind;
  Written written;
  double mva = 100;
};
void PrintTo(const Mistake& m, std::ostream* out) { *out << m.name; }

std::vector<Mistake> mistakes() {
  using Row = std::vector<double>&;
  std::vector<Mistake> all = {
      {"too_short", "too_short", {.from = 1.5, .to = 2.5}},
      {"nothing_after_the_event", "too_short", {.to = 2.6}},
      {"begins_in_the_fault", "no_pre_event", {.from = 2.05}},
      {"begins_after_the_fault", "no_pre_event", {.from = 2.3}},
      {"ends_before_the_event", "no_event", {.to = 1.98}},
      {"power_in_MW", "wrong_base", {.edit = [](Row x) { x[3] *= 100, x[4] *= 100; }}},
      {"power_in_pu_named_MW", "wrong_base", {.P = "P_MW", .Q = "Q_Mvar"}},
      // The example's machine, six times as large: on its own base the numbers are unchanged, on 100 MVA they
      // are six times as large.
      {"power_on_the_machine_base", "wrong_base", {}, 600},
      {"power_on_the_system_base",
       "wrong_base",
       {.edit = [](Row x) { x[3] *= 6, x[4] *= 6; }, .base = {600, 60, 0}},
       600},
      {"swapped_P_Q", "swapped_channels", {.edit = [](Row x) { std::swap(x[3], x[4]); }}},
      {"swapped_V_theta",
       "swapped_channels",
       {.edit = [](Row x) { x[2] = std::exchange(x[1], x[2] + 1.5); }, .to = 4}},
      {"degrees_as_radians", "angle_unit", {.edit = [](Row x) { x[2] /= kDegree; }}},
      {"degrees_as_radians_no_frequency",
       "angle_unit",
       {.edit = [](Row x) { x[2] /= kDegree; }, .with_frequency = false}},
      {"wrapped_degrees_as_radians",
       "angle_unit",
       {.edit = [](Row x) { x[2] = std::remainder(x[2] / kDegree + 178, 360); }, .with_frequency = false}},
      {"degrees_beyond_a_turn_as_radians",
       "angle_unit",
       {.edit = [](Row x) { x[2] = x[2] / kDegree + 720; }, .with_frequency = false}},
      {"radians_as_degrees", "angle_unit", {.theta = "theta_deg"}},
      {"kV_as_pu", "voltage_unit", {.edit = [](Row x) { x[1] *= 22; }}},
      {"kV_as_pu_with_base", "voltage_unit", {.edit = [](Row x) { x[1] *= 138; }, .base = {100, 60, 138}}},
      {"base_kv_of_1",
       "voltage_unit",
       {.V = "V_kV", .edit = [](Row x) { x[1] *= 345; }, .base = {100, 60, 1}}},
      {"volts_as_kV",
       "voltage_unit",
       {.V = "V_kV", .edit = [](Row x) { x[1] *= 138e3; }, .base = {100, 60, 138}}},
      {"percent_as_pu", "voltage_unit", {.edit = [](Row x) { x[1] *= 100; }}},
      {"line_to_neutral",
       "voltage_unit",
       {.V = "V_kV", .edit = [](Row x) { x[1] *= 138 / std::numbers::sqrt3; }, .base = {100, 60, 138}}},
      {"frequency_of_50_Hz", "nominal_frequency", {.f = "f_hz", .edit = [](Row x) { x[5] *= 50; }}},
      {"angle_of_50_Hz",
       "nominal_frequency",
       {.edit = [](Row x) { x[2] -= 2 * std::numbers::pi * 10 * x[0]; }, .with_frequency = false}},
      {"frequency_deviation_as_pu", "frequency_unit", {.edit = [](Row x) { x[5] -= 1; }}},
      {"hertz_as_pu", "frequency_unit", {.edit = [](Row x) { x[5] *= 60; }}},
      {"into_the_machine", "power_sign", {.edit = [](Row x) { x[3] = -x[3], x[4] = -x[4]; }}},
      {"reactive_power_in_Gvar", "power_unit", {.edit = [](Row x) { x[4] /= 1e3; }}},
      {"drifting", "unsteady", {.edit = [](Row x) { x[3] += x[0] < 2 ? 0.1 * x[0] : 0.2; }}},
      {"oscillating", "unsteady", {.edit = [](Row x) { x[3] += 0.1 * std::sin(6 * x[0]); }}},
  };
  return all;
}

class RecordMistakeTest : public ::testing::TestWithParam<Mistake> {};
TEST_P(RecordMistakeTest, IsRecognised) {
  const Mistake& m = GetParam();
  for (int i = 1; i <= 4; ++i) {
    const auto findings = check_record(rewritten(example(i), m.written), {m.mva, 60});
    EXPECT_TRUE(refused(findings, m.kind)) << "event " << i << "\n" << findings_text(findings);
    EXPECT_THROW(raise_refusals(findings), InputError);
  }
}
INSTANTIATE_TEST_SUITE_P(All, RecordMistakeTest, ::testing::ValuesIn(mistakes()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(RecordCheckTest, ActivePowerInGigawattsIsRefusedWhereItSteps) {
  const Written gigawatts{.edit = [](std::vector<double>& x) { x[3] /= 1e3; }};
  for (int i : {3, 4}) {  // P hardly steps in events 1 and 2
    const auto findings = check_record(rewritten(example(i), gigawatts), {100, 60});
    EXPECT_TRUE(refused(findings, "power_unit")) << i << findings_text(findings);
  }
}

TEST(RecordCheckTest, ImpossibleFrameIsRefused) {
  const record::Record sound = example(1);
  for (const auto& [V, P] : {std::pair{999.0, sound.P[300]}, {0.0, sound.P[300]}, {sound.V[300], 60.0}}) {
    record::Record r = sound;
    r.V[300] = V;
    r.P[300] = P;
    const auto findings = check_record(r, {100, 60});
    EXPECT_TRUE(refused(findings, "impossible_frame")) << V << findings_text(findings);
  }
  EXPECT_FALSE(refused(check_record(sound, {100, 60}), "impossible_frame"));
}

TEST(RecordCheckTest, InterpolatesLostSamplesWrittenAsZeros) {
  for (int i = 1; i <= 4; ++i) {
    Written w;
    w.edit = [](std::vector<double>& x) {
      if (x[0] > 5 && x[0] < 5.2) x = {x[0], 0, 0, 0, 0, 1};
    };
    const record::Record r = rewritten(example(i), w);
    EXPECT_EQ(std::ranges::count(r.lost, 1), 11) << "event " << i;
    EXPECT_FALSE(refused(check_record(r, {100, 60}), "dropout"));
  }
}
/// A record with noise; the fault lasts a third of it.
record::Record short_record(int samples, double rate, std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1e-4);
  record::Record r;
  r.name = "short.csv";
  for (int k = 0; k < samples; ++k) {
    const bool fault = 3 * k > samples && 3 * k < 2 * samples;
    r.t.push_back(k / rate);
    r.V.push_back((fault ? 0.6 : 1.0) + noise(random));
    r.theta.push_back((fault ? -0.2 : 0.1) + noise(random));
    r.P.push_back((fault ? 0.3 : 0.7) + noise(random));
    r.Q.push_back((fault ? 0.9 : 0.2) + noise(random));
  }
  return r;
}
TEST(RecordCheckTest, ShortRecordsAreRefusedInOneSentence) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> samples(record::kMinSamples, 481);
  std::uniform_real_distribution<double> exponent(0, 6);
  int refused_as_short = 0;
  for (int i = 0; i < 500; ++i) {
    const record::Record r = short_record(samples(random), std::pow(10, exponent(random)), random);
    const double length = r.t.back() - r.t.front();
    const auto findings = check_record(r, {100, 60});
    if (length >= 0.5) continue;
    ++refused_as_short;
    ASSERT_EQ(findings.size(), 1U) << findings_text(findings);
    EXPECT_THAT(findings_text(findings), ::testing::HasSubstr(fmt::format("{:.3g} s is too short", length)));
  }
  EXPECT_GT(refused_as_short, 200);
}
TEST(RecordSignalsTest, RecordsShorterThanATenthOfASecondHaveAnAngle) {
  std::mt19937 random(2);
  for (const double rate : {1e3, 1e4, 1e5, 1e6})
    for (const int samples : {30, 31, 100, 481}) {
      const record::Record r = short_record(samples, rate, random);
      const Signals s = record_signals(r);
      EXPECT_NEAR(s.first_angle, 0.1, 1e-3);
      EXPECT_GE(s.fast_angle, 0) << samples << " samples at " << rate << "/s";
    }
}
TEST(RecordCheckTest, VoltsUnderTheHeadingOfKilovolts_NameTheUnit) {
  const Written volts{
      .V = "V_kV", .edit = [](std::vector<double>& x) { x[1] *= 138e3; }, .base = {100, 60, 138}};
  EXPECT_THAT(findings_text(check_record(rewritten(example(1), volts), {100, 60})),
              ::testing::HasSubstr("a voltage in V taken as kV"));
}

TEST(RecordCheckTest, WarnsOfUnusualVoltageAndPower) {
  const auto kinds = [](const Written& w) {
    std::vector<std::string> all;
    for (const Finding& f : check_record(rewritten(example(1), w), {100, 60})) all.push_back(f.kind);
    return all;
  };
  EXPECT_THAT(kinds({}), ::testing::IsEmpty());
  EXPECT_THAT(kinds({.edit = [](auto& x) { x[1] *= 0.75; }}), ::testing::Contains("unusual_voltage"));
  EXPECT_THAT(kinds({.edit = [](auto& x) { x[3] *= 1e-3, x[4] *= 1e-3; }}),
              ::testing::Contains("small_power"));
}
TEST(RecordCheckTest, ReportsSlowRecord) {
  const record::Record r = example(1);
  const auto every = [&](std::size_t stride) {
    record::Record thin = r;
    for (auto* c : {&thin.t, &thin.V, &thin.theta, &thin.P, &thin.Q, &thin.f}) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < c->size(); k += stride) (*c)[kept++] = (*c)[k];
      c->resize(kept);
    }
    return findings_text(check_record(thin, {100, 60}));
  };
  ASSERT_NEAR(r.rate(), 60, 1e-6);
  EXPECT_THAT(every(2), ::testing::Not(::testing::HasSubstr("slow_rate")));
  EXPECT_THAT(every(4), ::testing::HasSubstr("warn slow_rate: 15 samples/s"));
}

TEST(RecordCheckTest, ChecksStepOfCurrentForMachinesOnly) {
  Written turned;
  turned.edit = [](std::vector<double>& x) { x[4] = -x[4]; };
  const record::Record r = rewritten(example(1), turned);
  EXPECT_THROW(raise_refusals(check_record(r, {100, 60})), InputError);
  EXPECT_NO_THROW(raise_refusals(check_record(r, {100, 60, false})));
}
TEST(RecordCheckTest, RefusesNegativeMagnitude) {
  const Written w{.edit = [](auto& x) { std::swap(x[1], x[2]); }};
  EXPECT_THAT(test::messages([&] { rewritten(example(1), w); }),
              ::testing::ElementsAre(::testing::HasSubstr("are their columns swapped?")));
}
bool warned(const std::vector<Finding>& findings, const std::string& kind) {
  return std::ranges::any_of(
      findings, [&](const Finding& f) { return f.severity == Severity::warn && f.kind == kind; });
}
TEST(RecordCheckTest, WarnsOfPreEventOfAFifthOfASecond) {
  const auto findings = check_record(record::stretch(example(1), 1.79, 1e9), {100, 60});
  EXPECT_TRUE(warned(findings, "short_pre_event")) << findings_text(findings);
  EXPECT_NO_THROW(raise_refusals(findings)) << findings_text(findings);
}
/// A dip of the frequency over 40 s that starts at the first sample; P and Q without noise or quantised.
record::Record dip(double noise, double step) {
  record::Record r;
  r.name = "dip";
  for (int k = 0; k < 1800; ++k) {
    const double t = k / 30.0, f = -0.002 * std::sin(std::numbers::pi * std::min(t / 40, 1.0));
    const double p = 0.7 - 5 * f + noise * std::sin(1e3 * t * t);
    r.t.push_back(t);
    r.f.push_back(f);
    r.theta.push_back(k == 0 ? 0 : r.theta.back() + 2 * std::numbers::pi * 60 * f / 30);
    r.V.push_back(1.02 + 0.2 * f);
    r.P.push_back(step > 0 ? step * std::round(p / step) : p);
    r.Q.push_back(0.1 - f);
  }
  return r;
}
TEST(RecordCheckTest, AcceptsEventsWithoutSwitching) {
  for (const double noise : {0.0, 1e-5, 1e-3}) {
    const auto findings = check_record(dip(noise, 0), {100, 60});
    EXPECT_NO_THROW(raise_refusals(findings)) << findings_text(findings);
  }
  const auto findings = check_record(dip(0, 0.005), {100, 60});
  EXPECT_NO_THROW(raise_refusals(findings)) << findings_text(findings);
  EXPECT_TRUE(warned(findings, "quantised_P")) << findings_text(findings);
  EXPECT_THAT(findings_text(findings),
              testing::HasSubstr("the noise is taken to be at least the quantisation noise"));
  record::Record coarse = dip(0, 0);
  for (double& v : coarse.V) v = 5e-4 * std::round(v / 5e-4);
  for (std::size_t k = 0; k < coarse.V.size(); ++k) coarse.V[k] += 5e-4 * static_cast<double>(k % 2);
  const std::string of_voltage = findings_text(check_record(coarse, {100, 60}));
  EXPECT_THAT(of_voltage,
              testing::HasSubstr("a voltage regulator turns the rounding error into a slow response"));
}
TEST(RecordCheckTest, DoesNotCheckIntegratedAngle) {
  record::Record r = example(1);
  r.theta_as_written.clear();
  r.angle = record::AngleSource::integrated;
  r.theta.front() = 0;
  for (std::size_t k = 1; k < r.t.size(); ++k)
    r.theta[k] = r.theta[k - 1] + 2 * std::numbers::pi * 60 * r.step() * (r.f[k] + r.f[k - 1]) / 2;
  EXPECT_NO_THROW(raise_refusals(check_record(r, {100, 60})));
}
TEST(RecordCheckTest, AcceptsUnwrappedRadians) {
  for (int i = 1; i <= 4; ++i)
    for (const bool with_frequency : {true, false}) {
      const Written w{.edit = [](auto& x) { x[2] += 5 * 2 * std::numbers::pi; },
                      .with_frequency = with_frequency};
      const auto findings = check_record(rewritten(example(i), w), {100, 60});
      if (i == 2 && !with_frequency)  // its angle hardly steps: degrees would be plausible too
        EXPECT_TRUE(refused(findings, "angle_unit"));
      else
        EXPECT_EQ(findings_text(findings), "") << "event " << i;
    }
}
TEST(RecordCheckTest, AcceptsTheExample) {
  for (int i = 1; i <= 4; ++i) {
    const record::Record r = example(i);
    EXPECT_EQ(findings_text(check_record(r, {100, 60})), "") << r.name;
    EXPECT_EQ(findings_text(check_record(rewritten(r, {}), {100, 60})), "") << r.name;
  }
}

}  // namespace
}  // namespace swingbank::validate::check
