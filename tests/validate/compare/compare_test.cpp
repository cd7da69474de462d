#include "validate/compare/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <random>

#include "sim/library/library.hpp"
#include "tests/validate/compare/example.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/compare/report.hpp"

namespace swingbank::validate::compare {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names(const std::vector<Window>& windows) {
  std::vector<std::string> all;
  for (const auto& w : windows) all.push_back(w.name);
  return all;
}

/// The right model of a simulated event, switching times between samples, noise 0.1 %: the residual must be
/// noise.
struct RightModel {
  test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131);
  plant::PlantModel model;
  record::Record record;
  RightModel() {
    model.name = "right";
    model.plant = s.grid.plants[3];
    model.conventions = s.grid.conventions;
    record = test::record_of(s, 3, 8, 0.001);
    model.record_base = record.base;
  }
};

TEST(CompareTest, RightModelLeavesOnlyNoise) {
  const RightModel right;
  const EventComparison e = compare_event(right.model, right.record);
  EXPECT_TRUE(e.detected);
  EXPECT_TRUE(e.fitted);
  for (const auto& c : e.channels) {
    EXPECT_NEAR(c.noise, 0.001, 0.0003);  // 120 samples; the noise of V adds to that of P and Q
    // RMS values of a few samples scatter by 1/sqrt(2 n): 30 % for the 6 samples of the fault.
    for (const auto& w : c.windows) EXPECT_LT(w.in_noise, 1.7);
    EXPECT_GT(c.whole.in_noise, 0.8);
  }
}
TEST(CompareTest, RightModelIsAdequate) {
  const RightModel right;
  std::vector<EventComparison> events = {compare_event(right.model, right.record)};
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  EXPECT_EQ(a.exceeding, 0);
  EXPECT_THAT(a.sentence, HasSubstr("Adequate"));
}
/// A record in a simulator's output format, on the system's base; the machine is large.
struct WithoutNoise : RightModel {
  WithoutNoise() {
    record = test::record_of(s, 3, 8, 0);
    const double scale = record.base.mva / 100;
    record.base.mva = model.record_base.mva = 100;
    for (auto* power : {&record.P, &record.Q})
      for (double& value : *power) value *= scale;
  }
};
TEST(CompareTest, JudgesRightAndWrongModel_WithoutNoise) {
  WithoutNoise exact;
  std::vector<EventComparison> events = {compare_event(exact.model, exact.record)};
  EXPECT_TRUE(events[0].fitted);
  EXPECT_NEAR(events[0].switchings[0].time, exact.s.t_on, 1e-3);
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  auto& machine = exact.model.plant.machine;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("H"))] *= 1.03;
  std::vector<EventComparison> wrong = {compare_event(exact.model, exact.record)};
  EXPECT_FALSE(judge(wrong).adequate);
}
// Quantisation in steps of 1 % of the machine's MVA, without noise. The rounding error of a slow swing is
// slow, hence not white.
TEST(CompareTest, AllowsForQuantisation) {
  WithoutNoise coarse;
  const double step = 0.01 * coarse.model.plant.mva / 100;
  for (auto* power : {&coarse.record.P, &coarse.record.Q})
    for (double& value : *power) value = std::round(value / step) * step;
  std::vector<EventComparison> events = {compare_event(coarse.model, coarse.record)};
  const Adequacy right = judge(events);
  EXPECT_TRUE(right.adequate) << right.sentence;
  coarse.model.plant.machine
      .p[static_cast<std::size_t>(coarse.model.plant.machine.effect->parameter_index("H"))] *= 1.2;
  events = {compare_event(coarse.model, coarse.record)};
  EXPECT_FALSE(judge(events).adequate);
}
TEST(CompareTest, ExcludesLostFrames) {
  RightModel right;
  for (const std::size_t k : {std::size_t{60}, std::size_t{300}, std::size_t{301}}) {
    right.record.lost.resize(right.record.t.size(), 0);
    right.record.lost[k] = 1;
    right.record.P[k] += 0.5;  // arbitrary value
  }
  std::vector<EventComparison> events = {compare_event(right.model, right.record)};
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  EXPECT_EQ(std::ranges::count(events[0].left_out, 1), 3);
}
TEST(CompareTest, PlaysInPower_WithoutAngleAndFrequency) {
  RightModel right;
  right.record.theta.assign(right.record.t.size(), 0.0);
  right.record.angle = record::AngleSource::none;
  right.record.switched = {right.s.t_on, right.s.t_off};
  std::vector<EventComparison> events = {compare_event(right.model, right.record)};
  ASSERT_FALSE(events[0].channels.empty());
  EXPECT_EQ(events[0].channels[0].name, "V");
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
}
// Noise of P and Q in the fault and switching times known to half a sample cause an error of V afterwards. It
// must not count as a model error.
TEST(CompareTest, WidensBoundsAfterFaults_WhenPowerIsPlayedIn) {
  plant::PlantModel model = example_model();
  model.plant.controls.push_back({sim::library::compiled().find("SEXS"), {0.1, 10, 100, 0.05, -4.0, 5.0}});
  const auto events = [&] {
    std::vector<EventComparison> all;
    for (const char* name : {"avr_ev3.csv", "avr_ev4.csv"}) {
      record::Record r = record::read_record(
          test::source(std::string("configs/records/record-example/") + name), model.record_base);
      r.angle = record::AngleSource::none;
      for (auto* unknown : {&r.theta, &r.f, &r.speed, &r.Efd, &r.Ifd}) unknown->clear();
      r.theta.assign(r.t.size(), 0.0);
      all.push_back(compare_event(model, std::move(r)));
    }
    return all;
  };
  auto right = events();
  EXPECT_TRUE(judge(right).adequate) << judge(right).sentence;
  model.plant.controls.front().p[2] = 30;  // K
  auto wrong = events();
  EXPECT_FALSE(judge(wrong).adequate);
}
TEST(CompareTest, PlaysInAngleIntegratedFromFrequency) {
  RightModel right;
  const record::Record whole = test::record_of(right.s, 3, 8);
  const auto angle_step = [&](double at) {  // step of the voltage's angle over the sample interval
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(whole.t, at) - whole.t.begin());
    return (whole.theta[k] - whole.theta[k - 1]) - (whole.theta[k - 1] - whole.theta[k - 2]);
  };
  const double on = angle_step(right.s.t_on), off = angle_step(right.s.t_off);
  ASSERT_GT(std::abs(on), 0.05);
  constexpr double kFrequencyNoise = 1e-3 / 60;  // 1 mHz
  right.record = test::by_frequency(right.record, {right.s.t_on, right.s.t_off}, kFrequencyNoise);
  std::vector<EventComparison> events = {compare_event(right.model, right.record)};
  ASSERT_EQ(events[0].switchings.size(), 2U);
  constexpr double kSubtransient = 0.04;  // changes the angle in the samples next to a switching
  EXPECT_NEAR(events[0].switchings[0].turn, on, kSubtransient);
  EXPECT_NEAR(events[0].switchings[1].turn, off, kSubtransient);
  EXPECT_THAT(events[0].notes, ::testing::Contains(HasSubstr("were fitted at the switching times")));
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  auto& machine = right.model.plant.machine;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("H"))] *= 1.1;
  std::vector<EventComparison> wrong = {compare_event(right.model, right.record)};
  EXPECT_FALSE(judge(wrong).adequate) << "phase jumps at switching times must not hide the model error";
}
/// In a converter that regulates Q, the voltage's noise passes two integrals and moves Q by several times its
/// own noise. This slow noise contains no information on the start of the fault. If it is taken for white
/// noise, it shifts the fault by 5 ms.
TEST(CompareTest, SlowNoiseDoesNotMoveTheSwitchingTimes) {
  const auto converter = [](sim::grid::Grid& grid) {
    test::put_converter(grid, "Tfltr=0.0175,Tfv=0.057,Kp=1.7,Ki=0.9", "Vdip=0.88,Kqi=0.09");
  };
  const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0006, 2.1131, 480,
                                           {0.005, 0.03}, converter);
  plant::PlantModel model;
  model.plant = s.grid.plants[3];
  model.conventions = s.grid.conventions;
  const record::Record record = test::record_of(s, 3, 4, 0.003);
  model.record_base = record.base;
  std::vector<EventComparison> events = {compare_event(model, record)};
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  ASSERT_EQ(events[0].switchings.size(), 2U);
  EXPECT_NEAR(events[0].switchings[0].time, s.t_on, 5e-4);
}
TEST(CompareTest, WrongModelDoesNotMoveTheStart) {
  RightModel right;
  auto& machine = right.model.plant.machine;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("Xd"))] *= 1.3;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("Xdp"))] *= 1.3;
  const EventComparison e = compare_event(right.model, right.record);
  ASSERT_TRUE(e.fitted);
  const auto mean = [&](const std::vector<double>& x) {
    const auto n = static_cast<std::ptrdiff_t>(e.playback.start.samples);
    return std::accumulate(x.begin(), x.begin() + n, 0.0) / static_cast<double>(n);
  };
  EXPECT_NEAR(e.playback.start.P, mean(right.record.P), 1e-9);
  EXPECT_NEAR(e.playback.start.Q, mean(right.record.Q), 1e-9);
}
TEST(CompareTest, AcceptsPreEventOfAFifthOfASecond) {
  RightModel right;
  right.record = record::stretch(right.record, 1.8, 1e9);
  std::vector<EventComparison> events = {compare_event(right.model, right.record)};
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
}
TEST(CompareTest, ReportsTheBeginningInUtc) {
  EventComparison e = example_event();
  EXPECT_THAT(csv_playback(e).substr(0, 200), ::testing::Not(HasSubstr("utc")));
  e.record.epoch = 1714607940.5;
  EXPECT_THAT(csv_playback(e).substr(0, 400), HasSubstr(",utc\n"));
  EXPECT_THAT(csv_playback(e).substr(0, 400), HasSubstr("2024-05-01T23:59:00.500000Z"));
}
/// Filters a record of 480/s with the P-class filter of IEEE C37.118.1 (a triangle over two cycles), samples
/// it at 60/s, and adds noise as record_of does.
record::Record filtered(const record::Record& fine, double noise) {
  constexpr int kHalf = 7, kStride = 8;
  std::mt19937_64 generator(8);
  std::normal_distribution<double> normal;
  record::Record r;
  r.name = fine.name;
  r.base = fine.base;
  for (int k = kStride; k + kStride < fine.samples(); k += kStride) {
    Complex v = 0, i = 0;
    for (int j = -kHalf; j <= kHalf; ++j) {
      const auto at = static_cast<std::size_t>(k + j);
      const double weight = (1 - std::abs(j) / (kHalf + 1.0)) / (kHalf + 1.0);
      const Complex u = std::polar(fine.V[at], fine.theta[at]);
      v += weight * u;
      i += weight * std::conj(Complex(fine.P[at], fine.Q[at]) / u);
    }
    const Complex power = v * std::conj(i);
    r.t.push_back(fine.t[static_cast<std::size_t>(k)]);
    r.V.push_back(std::abs(v) + 0.1 * noise * normal(generator));
    r.theta.push_back(std::arg(v) + 0.1 * noise * normal(generator));
    r.P.push_back(power.real() + noise * normal(generator));
    r.Q.push_back(power.imag() + noise * normal(generator));
  }
  return r;
}
TEST(CompareTest, JudgesRightAndWrongModel_BehindAFilter) {
  RightModel right;
  const record::Record record = filtered(test::record_of(right.s, 3, 1), 0.001);
  std::vector<EventComparison> events = {compare_event(right.model, record)};
  EXPECT_GE(std::ranges::count(events[0].left_out, 1), 4);  // two steps, at least two samples each
  EXPECT_NEAR(events[0].switchings.front().time, 2.0062, 0.002);
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
  right.model.plant.machine
      .p[static_cast<std::size_t>(right.model.plant.machine.effect->parameter_index("H"))] *= 1.15;
  std::vector<EventComparison> off = {compare_event(right.model, record)};
  EXPECT_FALSE(judge(off).adequate);
}
/// Behind a regulator the residual caused by noise of V is slow and larger than the channels' own noise.
TEST(CompareTest, AllowsForVoltageNoiseBehindARegulator) {
  plant::PlantModel model = example_model();
  const sim::Effect* sexs = sim::library::compiled().find("SEXS");
  model.plant.controls.push_back({sexs, {0.1, 10, 100, 0.05, -4.0, 5.0}});  // the true exciter
  std::vector<EventComparison> events;
  for (const char* name : {"avr_ev1.csv", "avr_ev2.csv", "avr_ev3.csv", "avr_ev4.csv"})
    events.push_back(compare_event(
        model, record::read_record(test::source(std::string("configs/records/record-example/") + name),
                                   model.record_base)));
  const Adequacy a = judge(events);
  EXPECT_TRUE(a.adequate) << a.sentence;
}
/// A time constant of a hundredth of a sample interval needs more steps than a fit allows, but no more than a
/// single play-in allows.
TEST(CompareTest, KeepsThePlayInWhenTheFitFails) {
  RightModel right;
  right.model.plant.controls.push_back(
      {sim::library::compiled().find("TGOV1"), {0.5, 1e-4, 2.0, -1.0, 1.0, 10.0, 0.0, 0.0}});
  const EventComparison e = compare_event(right.model, right.record);
  EXPECT_FALSE(e.fitted);
  ASSERT_EQ(e.channels.size(), 2U);
  for (const auto& c : e.channels)
    EXPECT_LT(c.whole.in_noise, 10) << c.name;  // with the middles of the intervals: 5.2, 2.9
  ASSERT_FALSE(e.notes.empty());
  EXPECT_THAT(e.notes.front(), HasSubstr("the fit within these intervals failed"));
  EXPECT_THAT(e.notes.front(), HasSubstr("playback failed"));
}
TEST(CompareTest, ReportsInadequateModel) {
  std::vector<EventComparison> events = {example_event({2.0, 2.1})};
  const Adequacy a = judge(events);
  EXPECT_FALSE(a.adequate);
  EXPECT_THAT(a.sentence, HasSubstr("Not adequate"));
  // The missing exciter raises the field voltage; P before the event is right.
  EXPECT_THAT(a.sentence, HasSubstr("Efd"));
  EXPECT_FALSE(events[0].channels[0].map.rows[0].all.exceeds());
}
TEST(CompareTest, GivesNoVerdictOnUnstableModel) {
  WithoutNoise unstable;
  auto& machine = unstable.model.plant.machine;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("D"))] = -60;
  std::vector<EventComparison> events = {compare_event(unstable.model, unstable.record)};
  const Adequacy a = judge(events);
  EXPECT_FALSE(a.adequate) << a.sentence;
  EXPECT_GT(a.vague, 0);
  EXPECT_THAT(a.sentence, HasSubstr("Undecided"));
  EXPECT_THAT(a.sentence, HasSubstr("by more than 10 times the nominal value"));
}
TEST(CompareTest, CountsABinOnce_WhenItExceedsItsBoundAndIsUninformative) {
  std::vector<EventComparison> events(1);
  events[0].channels.emplace_back().map.whole = {.values = 10, .rms = 1000, .normalised = 100};
  const Adequacy a = judge(events);
  EXPECT_EQ(a.exceeding, 1);
  EXPECT_EQ(a.vague, 1);
  EXPECT_EQ(a.ruling.value, 1);
  EXPECT_EQ(a.bins, 1);
}
TEST(CompareTest, ComparesRecordedChannels) {
  const EventComparison e = example_event({2.0, 2.1});
  std::vector<std::string> channels;
  for (const auto& c : e.channels) channels.push_back(c.name);
  EXPECT_THAT(channels, ElementsAre("P", "Q", "speed", "Efd", "Ifd"));
  EXPECT_NEAR(e.channels[2].noise, 2e-5, 4e-6);  // true value; 121 samples: 3 s.e. are 19 %
}
TEST(CompareTest, PlaysInPower_OnRequest) {
  const RightModel right;
  CompareOptions options;
  options.input = PlaybackInput::power;
  std::vector<EventComparison> events = {compare_event(right.model, right.record, options)};
  const Adequacy a = judge(events);
  const EventComparison& e = events[0];
  EXPECT_EQ(e.channels[0].name, "V");
  EXPECT_EQ(e.channels[1].name, "frequency");
  EXPECT_FALSE(e.channels[1].judged);
  // Noise of 1e-4 pu on V causes noise of 1e-3 pu on Q, through an X'' of some tenths of a pu.
  EXPECT_LT(e.channels[0].noise, 5e-4);
  EXPECT_TRUE(a.adequate) << a.sentence;
  RightModel wrong;
  wrong.model.plant.machine
      .p[static_cast<std::size_t>(wrong.model.plant.machine.effect->parameter_index("Tdop"))] *= 0.5;
  std::vector<EventComparison> off = {compare_event(wrong.model, wrong.record, options)};
  EXPECT_FALSE(judge(off).adequate);
}
TEST(CompareTest, UntilTruncatesTheRecord) {
  const EventComparison e = example_event({2.0, 2.1}, {.play_in = {.until = 6.0}});
  EXPECT_NEAR(e.record.t.back(), 6.0, 1e-6);
  EXPECT_EQ(e.channels[0].residual.size(), e.record.t.size());
  EXPECT_THAT(test::messages([] { example_event({}, {.play_in = {.until = 0.3}}); }),
              ElementsAre(HasSubstr("a later --until")));
}
TEST(CompareTest, DetectsWrongParameter_WithFittedSwitchingTimes) {
  RightModel wrong;
  wrong.model.plant.machine
      .p[static_cast<std::size_t>(wrong.model.plant.machine.effect->parameter_index("H"))] *= 1.3;
  const EventComparison e = compare_event(wrong.model, wrong.record);
  CompareOptions unmoved;
  unmoved.fit_switchings = false;
  const EventComparison middle = compare_event(wrong.model, wrong.record, unmoved);
  EXPECT_TRUE(e.fitted);
  EXPECT_GT(e.channels[0].whole.in_noise, 3);
  EXPECT_LT(e.channels[0].whole.in_noise, middle.channels[0].whole.in_noise);
  // The fitted start of the fault does not move to hide the error. Otherwise the error would count as noise.
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    EXPECT_NEAR(e.channels[c].noise, middle.channels[c].noise, 0.01 * middle.channels[c].noise);
}
TEST(CompareTest, MissingExciterAppearsInQ) {
  // The record's plant has an exciter, the model has none: Q is off by tens of Mvar for seconds, P by far
  // less.
  const EventComparison e = example_event({2.0, 2.1});
  const auto& p = e.channels[0];
  const auto& q = e.channels[1];
  EXPECT_NEAR(p.noise, 0.002, 0.0005);  // true value: 0.2 % of 100 MVA
  EXPECT_NEAR(q.noise, 0.002, 0.0005);
  EXPECT_LT(q.windows[0].in_noise, 1.1);
  EXPECT_GT(q.windows[2].in_noise, 50);
  EXPECT_GT(q.windows[3].in_noise, 50);
  EXPECT_LT(p.windows[4].in_noise, 1.5);
  EXPECT_GT(q.whole.rms, 10 * p.whole.rms);
}
TEST(CompareTest, WindowsFollowTheSwitchings) {
  const EventComparison e = example_event();
  EXPECT_THAT(names(e.windows),
              ElementsAre("pre-event", "fault", "0–1 s after", "1–5 s after", "> 5 s after"));
  EXPECT_EQ(e.channels[0].windows[0].samples, 121);  // 0 to 2 s at 60/s, both included
  EXPECT_EQ(e.channels[0].windows[1].samples, 6);
  int sum = 0;
  for (const auto& w : e.channels[0].windows) sum += w.samples;
  EXPECT_EQ(sum, e.record.samples());
  EXPECT_THAT(names(event_windows(e.record, {{.time = 2.0}}, 1.0)),
              ElementsAre("pre-event", "0–1 s after", "1–5 s after", "> 5 s after"));
  // Without switching no window is "after" an event.
  EXPECT_THAT(names(event_windows(e.record, {}, 14.5)),
              ElementsAre("0–14.5 s of the record", "14.5–15.5 s of the record"));
  EXPECT_THAT(names(event_windows(e.record, {}, 1)),
              ElementsAre("0–1 s of the record", "1–2 s of the record", "2–6 s of the record",
                          "> 6 s of the record"));
}
TEST(CompareTest, ResidualIsModelledMinusMeasured) {
  const EventComparison e = example_event();
  const auto& q = e.channels[1];
  EXPECT_DOUBLE_EQ(q.residual[500], q.modelled[500] - q.measured[500]);
  double worst = 0;
  for (const double r : q.residual) worst = std::max(worst, std::abs(r));
  EXPECT_EQ(q.whole.worst, worst);
}

}  // namespace
}  // namespace swingbank::validate::compare
