// Near-zero impedances: bus ties, regulators without impedance and star legs of zero, in the power flow, the
// reference integrator and the SIMD kernel.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/batch/batch.hpp"
#include "sim/grid/event_choice.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/tie.hpp"
#include "sim/reference/reference.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The load of bus 103 is at bus 104, behind the added `branches` and `transformers`. A unit may be at bus
/// 105.
formats::RawCase case_with(const std::string& branches, const std::string& transformers,
                           const std::string& buses = "") {
  formats::RawCase c;
  c.buses += "104,'TIED',138.0,1,1,1,1,1.0,0.0,1.1,0.9,1.1,0.9\n" + buses;
  c.loads = "104,'1',1,1,1,150.0,30.0,0,0,0,0,1,1,0\n";
  c.branches += "101,102,'1',0.01,0.15,0.02,250,250,250,0,0,0,0,1,1,0,1,1\n" + branches;
  c.transformers = transformers;
  return c;
}
grid::Grid grid_of(const formats::RawCase& c) {
  const std::string round = "8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8";
  std::string dyr = "101 'GENCLS' 1 6.0 0.0 /\n102 'GENROU' 1 " + round +
                    " /\n102 'SEXS' 1 0.1 10.0 100.0 0.1 -4.0 5.0 /\n";
  if (c.generators.find("104,") != std::string::npos) dyr += "104 'GENCLS' 1 4.0 0.0 /\n";
  return grid::make_grid(formats::parse_raw(c.text(), "case.raw"), formats::parse_dyr(dyr, "case.dyr"),
                         "case.dyr", Conventions::psse());
}
std::string line(const char* ends, double r, double x) {
  return fmt::format("{},'1',{:.9g},{:.9g}\n", ends, r, x);
}
std::string transformer(const char* ends, double r, double x, double tap, double degrees) {
  return fmt::format("{},0,'1',1,1,1\n{:.9g},{:.9g},100\n{},0,{}\n1.0\n", ends, r, x, tap, degrees);
}
/// Legs of the star in per unit: X12 = a + b, X23 = b + c, X31 = c + a.
std::string three_windings(double a, double b, double c) {
  return fmt::format(
      "103,104,105,'1',1,1,1,0,0,2,'',1\n0,{:.12g},100,0,{:.12g},100,0,{:.12g},100,1.0,0\n1.0\n1.025\n1.0\n",
      a + b, b + c, c + a);
}
const std::string kFifth = "105,'FIFTH',20.0,1,1,1,1,1.0,0.0,1.1,0.9,1.1,0.9\n";

network::Event event_of(const grid::Grid& grid, const grid::EventTexts& texts) {
  Problems problems;
  network::Event event = grid::read_event(
      texts, grid, 3.0, [](grid::EventPart, const std::string& text) { return text; }, problems);
  EXPECT_TRUE(problems.empty()) << (problems.empty() ? "" : problems.list()[0].sentence());
  return event;
}
network::Event fault(const grid::Grid& grid, const std::string& text) {
  grid::EventTexts texts;
  texts.faults = {text};
  return event_of(grid, texts);
}
network::Event trip(const grid::Grid& grid, const std::string& text) {
  grid::EventTexts texts;
  texts.trips = {text};
  return event_of(grid, texts);
}
reference::ReferenceRun in_reference(const grid::Grid& grid, const network::Event& event) {
  reference::ReferenceOptions options;
  options.t_end = 3.0;
  options.rate = 60.0;
  options.buses.resize(grid.network.buses.size());
  std::iota(options.buses.begin(), options.buses.end(), 0);
  return reference::run_reference(grid, event, options);
}
Trajectory in_batch(const grid::Grid& grid, const network::Event& event) {
  batch::BatchOptions options;
  options.t_end = 3.0;
  options.rate = 60.0;
  options.lanes = 1;
  batch::Batch batch(grid, options);
  Trajectory out;
  bool given = false;
  batch.run(
      [&](batch::Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const batch::Job&, const Trajectory& run) { out = run; });
  return out;
}
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}
double apart(const Trajectory& a, const Trajectory& b) {
  double most = 0.0;
  EXPECT_EQ(a.rows(), b.rows());
  for (int i = 0; i < a.rows(); ++i)
    for (int k = 0; k < a.samples; ++k) most = std::max(most, std::abs(a.row(i)[k] - b.row(i)[k]));
  return most;
}

/// Location of a near-zero impedance; `at` returns the case for R + jX there.
struct Place {
  const char* name;
  formats::RawCase (*at)(double r, double x);
};
class NearZeroImpedance : public ::testing::TestWithParam<Place> {};

// Up to 1e-6 pu all impedances give the same case. Above 1e-6 pu the results change with the impedance: rotor
// angles by up to 300 rad per pu and field currents by up to 300 pu per pu (two resistances in series, during
// the fault).
TEST_P(NearZeroImpedance, BehavesLikeZero) {
  constexpr double kSame = 1e-5, kPerImpedance = 300.0;
  const auto [name, at] = GetParam();
  const grid::Grid zero = grid_of(at(0.0, 0.0));
  const network::Event event = fault(zero, "104:1:1.1");
  const auto reference = in_reference(zero, event);
  ASSERT_EQ(reference.outcome, Outcome::stable);
  for (const auto& [r, x] : {std::pair{0.0, 0.0},
                             {0.0, 1e-9},
                             {0.0, 1e-7},
                             {0.0, 1e-6},
                             {1e-7, 0.0},
                             {1e-6, 0.0},
                             {6.25e-7, 6.25e-7},
                             {0.0, -1e-7},
                             {0.0, 2e-6},
                             {2e-6, 0.0},
                             {0.0, 1e-5}}) {
    const double same = kSame + kPerImpedance * std::max(0.0, r + x - 1e-6);
    const grid::Grid grid = grid_of(at(r, x));
    for (std::size_t b = 0; b < grid.flow.voltage.size(); ++b)
      EXPECT_LT(std::abs(grid.flow.voltage[b] - zero.flow.voltage[b]), same) << r << " " << x;
    const auto run = in_reference(grid, event);
    ASSERT_EQ(run.outcome, Outcome::stable) << r << " " << x;
    EXPECT_LT(apart(run, reference), same) << r << " " << x;
    EXPECT_LT(apart(run.bus_v, reference.bus_v), same) << r << " " << x;
    EXPECT_LT(apart(in_batch(grid, event), run), 1e-4) << r << " " << x;  // guaranteed by the SIMD kernel
  }
}
INSTANTIATE_TEST_SUITE_P(
    Places, NearZeroImpedance,
    ::testing::Values(
        Place{"BusTie", [](double r, double x) { return case_with(line("103,104", r, x), ""); }},
        Place{"Regulator",
              [](double r, double x) { return case_with("", transformer("103,104", r, x, 1.05, 0.0)); }},
        Place{"RegulatorFromTheLoad",
              [](double r, double x) { return case_with("", transformer("104,103", r, x, 0.95, 0.0)); }},
        Place{"PhaseShifter",
              [](double r, double x) { return case_with("", transformer("103,104", r, x, 1.0, 30.0)); }},
        Place{"TiesInSeries",
              [](double r, double x) {
                return case_with(line("103,105", r, x), transformer("105,104", r, x, 1.05, 0.0), kFifth);
              }},
        Place{"RingOfTies",
              [](double r, double x) {
                return case_with(line("103,105", r, x) + line("105,104", r, x) + line("103,104", r, x), "",
                                 kFifth);
              }},
        Place{"StarLeg", [](double, double x) { return case_with("", three_windings(0.1, x, 0.2), kFifth); }},
        Place{"TwoStarLegs",
              [](double, double x) { return case_with("", three_windings(x, x, 0.2), kFifth); }}),
    [](const auto& test) { return test.param.name; });

TEST(Ties, NegativeStarLegIsKept) {
  const grid::Grid grid = grid_of(case_with("", three_windings(0.1, -0.004, 0.2), kFifth));
  EXPECT_NEAR(grid.network.branches[4].x, -0.004, 1e-15);
  const network::Event event = fault(grid, "104:1:1.1");
  EXPECT_LT(apart(in_batch(grid, event), in_reference(grid, event)), 1e-4);
}

TEST(Ties, CarryTheCurrentOfTheRestOfTheBus) {
  for (const double x : {0.0, 1e-7, 1e-5}) {
    const grid::Grid grid = grid_of(case_with("", transformer("103,104", 0.0, x, 1.05, 0.0)));
    const network::Branch& tie = grid.network.branches.back();
    const network::BranchEnd end = network::branch_end(tie, false);
    const Complex v3 = grid.flow.voltage[2], v4 = grid.flow.voltage[3];
    const Complex load = v4 * std::conj(-(end.own * v4 + end.other * v3));
    EXPECT_NEAR(load.real(), 1.5, 1e-8) << x;
    EXPECT_NEAR(load.imag(), 0.3, 1e-8) << x;
    EXPECT_NEAR(std::abs(v3) / std::abs(v4), 1.05, 1e-4);
  }
}

TEST(Ties, FaultOnEitherSideIsTheSame) {
  const grid::Grid grid = grid_of(case_with(line("103,104", 0.0, 1e-8), ""));
  const auto here = in_reference(grid, fault(grid, "103:1:1.1")),
             there = in_reference(grid, fault(grid, "104:1:1.1"));
  EXPECT_LT(apart(here, there), 5e-5);  // 1e-6 pu of impedance to the fault
}

/// Opening a tie has the same result as opening a line: the load behind it is shed.
TEST(Ties, OpenAndCloseAgain) {
  const grid::Grid grid = grid_of(case_with(line("103,104", 0.0, 1e-8), ""));
  const network::Event event = trip(grid, "103:104:1:1:1.2");
  const auto run = in_reference(grid, event);
  ASSERT_EQ(run.outcome, Outcome::stable);
  EXPECT_LT(apart(in_batch(grid, event), run), 1e-4);
  const double* v = run.bus_v.data() + 3 * run.samples;
  EXPECT_EQ(v[66], 0.0);
  EXPECT_GT(v[120], 0.9);
}

TEST(Ties, UnitBehindATieRunsLikeOneAtTheBus) {
  const std::string unit = ",'1',50.0,0.0,100,-100,1.0,0,100,0,0.2,0,0,1,1,100,318,0,1,1\n";
  formats::RawCase tied = case_with(line("103,104", 0.0, 1e-9), "");
  tied.buses.replace(tied.buses.find("'TIED',138.0,1"), 14, "'TIED',138.0,2");
  tied.generators += "104" + unit;
  formats::RawCase whole = tied;
  whole.branches.erase(whole.branches.find("103,104"));
  for (const char* before : {"101,103", "102,103"})
    whole.branches.replace(whole.branches.find(before) + 4, 3, "104");
  whole.buses.erase(whole.buses.find("103,'SOUTH'"),
                    whole.buses.find("104,") - whole.buses.find("103,'SOUTH'"));
  const grid::Grid a = grid_of(tied), b = grid_of(whole);
  const auto run = in_reference(a, fault(a, "104:1:1.1")), same = in_reference(b, fault(b, "104:1:1.1"));
  EXPECT_LT(apart(run, same), 5e-5);  // 1e-6 pu of impedance between them
  EXPECT_LT(apart(in_batch(a, fault(a, "104:1:1.1")), same), 1e-4);
}

TEST(CutOffBus, LosesItsLoadWithARemark) {
  grid::Grid grid = grid_of(case_with(line("103,104", 0.0, 0.05), ""));
  const network::Event event = trip(grid, "103:104:1:1");
  const auto run = in_reference(grid, event);
  EXPECT_EQ(run.outcome, Outcome::stable);
  EXPECT_LT(apart(in_batch(grid, event), run), 1e-4);
  const double* v = run.bus_v.data() + 3 * run.samples;
  EXPECT_GT(v[60], 0.9);  // the value before the switching
  EXPECT_EQ(v[61], 0.0);
  // The units lose this load: 150 MW and the losses on its path.
  const auto total = [&](int k) {
    double sum = 0.0;
    for (int i = 0; i < 2; ++i)
      sum +=
          run.at(i, static_cast<int>(std::ranges::find(run.channels, Channel::P) - run.channels.begin()))[k];
    return sum;
  };
  EXPECT_NEAR(total(60) - total(61), 1.5, 0.1);
  grid::note_shed_loads(grid, event);
  EXPECT_THAT(formats::places(grid.network, "separates from every generator"),
              ElementsAre("bus 104 at 1 s: 150.00 MW, 30.00 Mvar"));
}

TEST(CutOffBus, IsRefused_WhenNoGeneratorIsLeft) {
  const grid::Grid grid = grid_of(case_with(line("103,104", 0.0, 0.05), ""));
  grid::EventTexts texts;
  texts.generator_trips = {"101:1", "102:1"};
  const network::Event event = event_of(grid, texts);
  EXPECT_THAT(formats::sentences_of([&] { in_reference(grid, event); }),
              HasSubstr("the trips leave no generator"));
  EXPECT_THAT(formats::sentences_of([&] { in_batch(grid, event); }),
              HasSubstr("the trips leave no generator"));
}

}  // namespace
}  // namespace swingbank::sim
