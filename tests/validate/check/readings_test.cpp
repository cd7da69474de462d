// Records with wrong signs, delays or phases, found by playback; records compared with the case's dispatch.
#include "validate/check/readings.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::check {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A unit of the 39-bus grid and its record of a fault, 60 samples/s, noise of 0.1 %.
struct ReadingsTest : ::testing::Test {
  static constexpr int kPlant = 3;
  test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131);
  plant::PlantModel model;
  record::Record sound = test::record_of(s, kPlant, 8, 0.001);
  ReadingsTest() {
    model.name = "right";
    model.plant = s.grid.plants[kPlant];
    model.conventions = s.grid.conventions;
    model.record_base = sound.base;
  }
  [[nodiscard]] std::string kind(const record::Record& r) const {
    const auto found = better_reading(r, model);
    return found ? found->kind : "";
  }
  [[nodiscard]] record::Record scaled(double factor) const {
    record::Record r = sound;
    for (auto* power : {&r.P, &r.Q})
      for (double& x : *power) x *= factor;
    return r;
  }
};

TEST_F(ReadingsTest, AcceptsSoundRecord) { EXPECT_EQ(kind(sound), ""); }
TEST_F(ReadingsTest, MirroredAngleIsReported) {
  record::Record r = sound;
  for (double& a : r.theta) a = -a;
  const auto found = better_reading(r, model);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, "angle_sign");
  EXPECT_THAT(found->problem.sentence(),
              AllOf(HasSubstr("the sign of the angle reversed"), HasSubstr("the record was not changed"),
                    HasSubstr("theta=-NAME")));
  for (double& q : r.Q) q = -q;
  EXPECT_THAT(better_reading(r, model)->problem.sentence(), HasSubstr("of the angle and of Q reversed"));
}
TEST_F(ReadingsTest, ThirdOfThePowerIsReported) {
  EXPECT_EQ(kind(scaled(1.0 / 3)), "one_phase");
  model.dispatch = {sound.P[0] / 3 * sound.base.mva, sound.Q[0] / 3 * sound.base.mva, sound.V[0]};
  EXPECT_EQ(kind(scaled(1.0 / 3)), "") << "this power equals the unit's dispatch in the case";
}
TEST_F(ReadingsTest, LatePowerIsReportedWithItsDelay) {
  constexpr std::size_t kLate = 12;
  record::Record r = sound;
  for (auto* power : {&r.P, &r.Q}) {
    power->insert(power->begin(), kLate, power->front());
    power->resize(sound.P.size());
  }
  const auto found = better_reading(r, model);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, "time_skew");
  EXPECT_THAT(found->problem.sentence(), HasSubstr("P and Q 200 ms earlier (12 samples)"));
}
TEST_F(ReadingsTest, SignsAndExchangedColumnsAreReported) {
  record::Record r = sound;
  for (double& q : r.Q) q = -q;
  EXPECT_EQ(kind(r), "q_sign");
  for (double& p : r.P) p = -p;
  EXPECT_EQ(kind(r), "power_sign");
  r = sound;
  std::swap(r.P, r.Q);
  EXPECT_EQ(kind(r), "swapped_channels");
}
/// The record has no angle, the case no dispatch, and the model is too wrong to decide by playback. Then the
/// steps of |V| and Q decide.
TEST(SignsWithoutAngle, ReversedAndExchangedPowersAreReported) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  PlantFacts facts = plant_facts(model);
  facts.dispatch.reset();
  const auto finding = [&](const record::Record& r) -> std::string {
    for (const Finding& f : check_record(r, facts))
      if (f.kind == "q_sign" || f.kind == "power_sign" || f.kind == "swapped_channels")
        return fmt::format("{} {}: {}", f.kind, f.severity == Severity::warn ? "warning" : "refusal",
                           f.problem.sentence());
    return {};
  };
  for (int i = 1; i <= 4; ++i) {
    record::Record r = record::read_record(
        test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", i)), model.record_base);
    r.angle = record::AngleSource::none;
    EXPECT_EQ(finding(r), "") << i;
    record::Record other = r;
    for (double& q : other.Q) q = -q;
    EXPECT_THAT(finding(other), AllOf(HasSubstr("q_sign warning: Q rises with V"), HasSubstr("Q=-NAME")))
        << i;
    for (double& p : other.P) p = -p;
    EXPECT_THAT(finding(other), AllOf(HasSubstr("power_sign warning: P = -"), HasSubstr("P=-NAME,Q=-NAME")))
        << i;
    other = r;
    for (double& p : other.P) p = -p;
    EXPECT_THAT(finding(other), HasSubstr("power_sign warning: P = -")) << i;
    facts.dispatch = {-40, 10, 1};  // a pump
    EXPECT_EQ(finding(other), "") << i;
    facts.dispatch.reset();
    other = r;
    std::swap(other.P, other.Q);
    if (i == 4) continue;  // in event 4, P rises at the voltage dip, as Q does
    EXPECT_THAT(finding(other), HasSubstr("P and Q are exchanged")) << i;
  }
}
/// The example's model lacks the exciter of the recorded machine: a model error, not a wrong reading of the
/// record.
TEST(ReadingsOfAWrongModel, AreNotReported) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  for (int i = 1; i <= 4; ++i) {
    const auto file = test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", i));
    const auto found = better_reading(record::read_record(file, model.record_base), model);
    EXPECT_FALSE(found) << found->problem.sentence();
  }
}
TEST(ReadingsOfAWrongModel, PowerAThousandTimesTooSmallIsReported) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  for (int i = 1; i <= 4; ++i) {
    const auto file = test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", i));
    for (auto power : {&record::Record::P, &record::Record::Q}) {
      record::Record r = record::read_record(file, model.record_base);
      for (double& x : r.*power) x /= 1000;
      const auto found = better_reading(r, model);
      ASSERT_TRUE(found) << i;
      EXPECT_EQ(found->kind, "power_unit") << i << found->problem.sentence();
      EXPECT_THAT(found->problem.sentence(), HasSubstr("may be in another unit")) << i;
    }
  }
}

struct DispatchTest : ReadingsTest {
  const double mw = sound.base.mva;
  DispatchTest() { model.dispatch = {sound.P[0] * mw, sound.Q[0] * mw, sound.V[0]}; }
  [[nodiscard]] std::string dispatch_warning(const record::Record& r) const {
    for (const Finding& f : check_record(r, plant_facts(model)))
      if (f.kind == "dispatch") {
        EXPECT_EQ(f.severity, Severity::warn);
        return f.problem.sentence();
      }
    return {};
  }
};
TEST_F(DispatchTest, AcceptsSameOperatingPoint) { EXPECT_EQ(dispatch_warning(sound), ""); }
TEST_F(DispatchTest, RatioAndItsLikelyCauseAreReported) {
  EXPECT_THAT(dispatch_warning(scaled(1.0 / 3)),
              AllOf(HasSubstr("0.33 times the case's"), HasSubstr("one phase")));
  EXPECT_THAT(dispatch_warning(scaled(1 / std::numbers::sqrt3)),
              AllOf(HasSubstr("0.58 times"), HasSubstr("sqrt(3)")));
  EXPECT_THAT(dispatch_warning(scaled(0.45)),
              AllOf(HasSubstr("0.45 times"), HasSubstr("another unit or base")));
}
TEST_F(DispatchTest, PowerFactorAngleIsReported) {
  record::Record r = sound;
  for (std::size_t k = 0; k < r.t.size(); ++k) {  // P + jQ = V I e^j(theta - phi), phi: power factor angle
    const Complex s0(sound.P[k], sound.Q[k]);
    const Complex made = std::polar(std::abs(s0), 1.3 - std::arg(s0));
    r.P[k] = made.real(), r.Q[k] = made.imag();
  }
  EXPECT_THAT(dispatch_warning(r), AllOf(HasSubstr("1.00 times"), HasSubstr("power-factor angle")));
}

TEST(WrongMachineBase, RemedyNamesTheMachinesMva) {
  record::Record r = record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), {});
  r.per_unit_power = false;
  for (auto* power : {&r.P, &r.Q})
    for (double& x : *power) x *= 10;
  const auto findings = check_record(r, {100, 60});
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].kind, "wrong_base");
  EXPECT_THAT(
      findings[0].problem.sentence(),
      AllOf(HasSubstr("times base_mva = 100"), HasSubstr("base_mva in [plant] is probably the system's base"),
            HasSubstr("write the machine's MVA")));
}
TEST(ShortRecord, WarningNamesTheJudgedPart) {
  const record::Record r =
      record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), {});
  const auto findings = check_record(record::stretch(r, 1.7, 3.58), {100, 60});
  EXPECT_NO_THROW(raise_refusals(findings));
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].kind, "short_record");
  EXPECT_THAT(findings[0].problem.sentence(), AllOf(HasSubstr("1.87 s"), HasSubstr("reactances")));
}

}  // namespace
}  // namespace swingbank::validate::check
