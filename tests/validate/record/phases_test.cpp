// Phasors of three phases in text columns: they become the positive sequence, in any unit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kDegreeOfPhasor = std::numbers::pi / 180;

/// 1.02 pu at 10 degrees of 138 kV, 80 + j20 MW. `v`, `va`, `i`, `ia`: headings of magnitudes and angles; {}
/// is replaced by the phase.
struct Streamed {
  std::string v = "V{}_mag", va = "V{}_Ang", i = "I{}_mag", ia = "I{}_Ang";
  double volts = 1e3, amperes = 1e3, degrees = 1;  ///< values per kV, kA and degree
  std::array<const char*, 3> phases = {"a", "b", "c"};
  double order = -120;        ///< angle from one phase to the next
  bool between = false;       ///< voltages between phases
  double unbalance = 0;       ///< negative sequence [pu]
  std::string others = {};    ///< further headings; each column has the value 60
  std::size_t leave_out = 9;  ///< phase (0 to 2) without columns
};
std::string text_of(const Streamed& s) {
  std::string text = "t_s";
  const auto each = [&](auto action) {
    for (std::size_t p = 0; p < 3; ++p)
      if (p != s.leave_out) action(p);
  };
  each([&](std::size_t p) {
    for (const auto* form : {&s.v, &s.va, &s.i, &s.ia})
      text += "," + fmt::format(fmt::runtime(*form), s.phases[p]);
  });
  text += s.others + "\n";
  const double kv = 1.02 * 138 / std::sqrt(3.0), ka = std::hypot(80.0, 20.0) / (std::sqrt(3.0) * 1.02 * 138);
  const double lag = std::atan2(20.0, 80.0) / kDegreeOfPhasor;
  for (int k = 0; k < 60; ++k) {
    text += fmt::format("{:.6f}", k / 60.0);
    each([&](std::size_t p) {
      const double turn = s.order * static_cast<double>(p);
      Complex v = std::polar(kv, (10 + turn) * kDegreeOfPhasor) +
                  std::polar(s.unbalance * kv, -turn * kDegreeOfPhasor);
      if (s.between) v *= std::polar(std::sqrt(3.0), std::numbers::pi / 6);
      text += fmt::format(",{:.9f},{:.9f},{:.9f},{:.9f}", std::abs(v) * s.volts,
                          std::arg(v) / kDegreeOfPhasor * s.degrees, ka * s.amperes,
                          (10 - lag + turn) * s.degrees);
    });
    for (const char c : s.others)
      if (c == ',') text += ",60";
    text += "\n";
  }
  return text;
}
void expect_sequence(const Streamed& s, const RecordBase& base = kTestBase) {
  const Record r = parse_record(text_of(s), "r.csv", base);
  expect_values(r);
  EXPECT_NEAR(r.theta[5], 10 * kDegreeOfPhasor, 1e-6) << s.v;
}

TEST(ThreePhasePhasors, NamesAndUnits) {
  expect_sequence({});
  expect_sequence({.others = ",freq,ROCOF"});
  expect_sequence({.degrees = kDegreeOfPhasor});
  expect_sequence({.volts = 1, .amperes = 1});
  expect_sequence({.v = "V{}_M", .va = "V{}_A", .i = "I{}_M", .ia = "I{}_A", .phases = {"A", "B", "C"}});
  expect_sequence({.v = "Ph{} Voltage Magnitude",
                   .va = "Ph{} Voltage Angle",
                   .i = "Ph{} Current Magnitude",
                   .ia = "Ph{} Current Angle",
                   .phases = {"A", "B", "C"}});
  expect_sequence({.v = "V{}_kV",
                   .va = "V{}_deg",
                   .i = "I{} (A)",
                   .ia = "I{} (deg)",
                   .volts = 1,
                   .phases = {"L1", "L2", "L3"}});
  expect_sequence(
      {.v = "G2.V{}PM", .va = "G2.V{}PA", .i = "G2.I{}PM", .ia = "G2.I{}PA", .phases = {"A", "B", "C"}});
  expect_sequence(
      {.v = "V Mag {}", .va = "V Ang {}", .i = "I Mag {}", .ia = "I Ang {}", .phases = {"R", "S", "T"}});
  EXPECT_THAT(parse_record(text_of({}), "r.csv", kTestBase).notes,
              AllOf(Contains(HasSubstr("'Va_mag' names no unit")), Contains(HasSubstr("indicate V.")),
                    Contains(HasSubstr("positive sequence of the phasors Va_mag, Vb_mag, Vc_mag"))));
}
TEST(ThreePhasePhasors, RejectUnbalance) { expect_sequence({.unbalance = 0.05}); }
TEST(ThreePhasePhasors, VoltagesBetweenPhases) {
  for (const std::size_t missing : {9U, 2U}) {
    const Streamed s{.v = "V{}_kV",
                     .va = "V{}_deg",
                     .i = "V{}_x",
                     .ia = "V{}_y",
                     .volts = 1,
                     .phases = {"ab", "bc", "ca"},
                     .between = true,
                     .others = ",P_MW,Q_Mvar",
                     .leave_out = missing};
    const Record r = parse_record(text_of(s), "r.csv", kTestBase);
    EXPECT_NEAR(r.V[5], 1.02, 1e-6);
    EXPECT_NEAR(r.theta[5], 10 * kDegreeOfPhasor, 1e-6);
  }
}
TEST(ThreePhasePhasors, YieldToRecordedPositiveSequence) {
  const Streamed s{.others = ",V_kV,theta_deg,P_MW,Q_Mvar"};
  const Record r = parse_record(text_of(s), "r.csv", kTestBase);
  EXPECT_NEAR(r.V[5], 60.0 / 138, 1e-9);
  EXPECT_NEAR(r.P[5], 0.3, 1e-9);
  EXPECT_THAT(r.ignored, Contains("Vb_mag"));
}
TEST(ThreePhasePhasors, ReportFaults) {
  const auto faults = [](const Streamed& s) {
    return test::messages([&] { parse_record(text_of(s), "r.csv", kTestBase); });
  };
  EXPECT_THAT(faults({.order = 120}),
              ElementsAre(AllOf(HasSubstr("phase sequence is A-C-B"), HasSubstr("Va_mag"))));
  EXPECT_THAT(faults({.volts = 7}),
              ElementsAre(AllOf(HasSubstr("'Va_mag'"), HasSubstr("neither in V nor in kV"))));
  EXPECT_THAT(faults({.degrees = 0.5}),
              ElementsAre(AllOf(HasSubstr("'Va_Ang'"), HasSubstr("120 degrees apart"))));
  EXPECT_THAT(faults({.leave_out = 1}), Contains(HasSubstr("no column V_pu")));
}

}  // namespace
}  // namespace swingbank::validate::record
