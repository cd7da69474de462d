// Further PSS/E records (psse_folder.hpp): exciters, governors and loads after a line opens at 1 s.
// Swingbank's equations are integrated by PSS/E's method (psse_stepper.hpp).
#include <unistd.h>

#include <complex>
#include <numbers>
#include <tuple>

#include "sim/grid/load_choice.hpp"
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/network/branch_index.hpp"
#include "tests/sim/reference/psse_folder.hpp"
#include "tests/sim/reference/psse_stepper.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference::psse_controls {
namespace {

constexpr double kSwitching = 1.0, kStep = 0.005, kEnd = 20.0;  // [s]
/// Required limits: V in pu, rotor angle in degrees, other channels relative to their swing.
constexpr double kVoltage = 1e-4, kAngle = 0.01, kShare = 2e-3;
/// Substeps of an exciter with several states in series (psse_excitation_test.cpp).
constexpr int kInnerSteps = 10;

std::filesystem::path folder_of(const std::string& name) {
  return test::record_folder("psse_powersimulationsdynamics/" + name);
}
/// The network of a folder with this text as its .dyr.
grid::Grid grid_with(const std::filesystem::path& raw, const std::string& dynamics) {
  const auto dyr =
      std::filesystem::temp_directory_path() / ("swingbank-psse-" + std::to_string(getpid()) + ".dyr");
  std::ofstream(dyr) << dynamics;
  grid::Grid grid = grid::load_grid(raw, dyr, Conventions::psse());
  std::filesystem::remove(dyr);
  return grid;
}
network::Event trip(const grid::Grid& grid, int from, int to) {
  network::Event event;
  event.trips.push_back({network::branch_index(grid.network, from, to, "1"), kSwitching, {}});
  return event;
}
std::size_t plant_of(const grid::Grid& grid, const std::string& name) {
  return grid.plants[0].name == name ? 0 : 1;
}
double magnitude(const grid::Grid& grid, const double* v, int bus) {
  const auto i = static_cast<std::size_t>(grid.network.bus_index(bus));
  return std::hypot(v[2 * i], v[2 * i + 1]);
}
double degrees(const grid::Grid& grid, const double* v, int bus) {
  const auto i = static_cast<std::size_t>(grid.network.bus_index(bus));
  return std::atan2(v[2 * i + 1], v[2 * i]) * 180.0 / std::numbers::pi;
}

struct Column {
  std::string name;
  double limit;
  bool of_swing = true;
};
struct Run {
  const grid::Grid& grid;
  network::Event event;
  std::size_t plant;
  int exciter_steps = 1;
  double step = kStep, end = kEnd;
};

/// `see` returns the record's columns. The switching time, with two samples, is excluded.
template <class See>
void expect_agreement(const std::filesystem::path& file, const Run& run, const std::vector<Column>& columns,
                      const See& see) {
  std::vector<std::pair<double, std::vector<double>>> ours;
  test::step_as_psse(
      run.grid, run.event, run.plant, run.step, run.end,
      [&](double t, const Signals<double>& s, const double* x, const double* v) {
        if (std::abs(t - kSwitching) > 0.5 * run.step) ours.emplace_back(t, see(s, x, v));
      },
      run.exciter_steps);
  std::vector<std::vector<double>> theirs;
  for (const auto& row : test::read_table(file, false).rows)
    if (std::abs(row[0] - kSwitching) > 0.5 * run.step && row[0] < run.end + 0.5 * run.step)
      theirs.push_back(row);
  ASSERT_EQ(theirs.size(), ours.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    double low = 1e9, high = -1e9, worst = 0.0, at = 0.0;
    for (std::size_t k = 0; k < ours.size(); ++k) {
      ASSERT_NEAR(ours[k].first, theirs[k][0], 1e-3);
      const double value = theirs[k][c + 1], difference = std::abs(ours[k].second[c] - value);
      low = std::min(low, value);
      high = std::max(high, value);
      if (difference > worst) at = ours[k].first;
      worst = std::max(worst, difference);
    }
    const double measured = columns[c].of_swing ? worst / (high - low) : worst;
    testing::Test::RecordProperty(columns[c].name, testing::PrintToString(measured));
    std::cout << file.filename().string() << " " << columns[c].name << " " << measured << " at " << at
              << " s\n";
    EXPECT_LT(measured, columns[c].limit) << columns[c].name << " at " << at << " s";
  }
}

TEST(PsseRecords, Esst1aWithGensalAndHygov) {
  const auto folder = folder_of("ESST1A");
  // The EXST1 of the .dyr beside the record is another one; these are the values of the record's test.
  const grid::Grid grid = grid_with(
      folder / "TVC_System_32.raw",
      "1 'GENCLS' 1 0 0 /\n2 'GENSAL' 1 8.0 999 999 3.5 4.0 2.1 2.1 0.4 0.4 0.10 0.0 0.0/\n"
      "2 'ESST1A' 1 1 1 0.01 5 -5 14.142135623731 20 14.142135623731 20 200 0.1 6.3 2.1 6 0 0.5 0.01 0.01 0.01 2.8 /\n"
      "2 'HYGOV' 1 0.04 0.5 1.0 0.05 0.20 0.10 1.0 0.00 1 1.0 0.0 0.0/\n");
  expect_agreement(folder / "results_PSSe.csv", {grid, trip(grid, 1, 4), plant_of(grid, "2"), kInnerSteps},
                   {{"V2", kVoltage, false}, {"V3", kVoltage, false}, {"speed", kShare}, {"Efd", kShare}},
                   [&](const Signals<double>& s, const double*, const double* v) {
                     return std::vector{magnitude(grid, v, 2), magnitude(grid, v, 3), 1.0 + s.speed, s.Efd};
                   });
}

TEST(PsseRecords, Exac1WithGensalAndHygov) {
  const auto folder = folder_of("EXAC1");
  const grid::Grid grid =
      grid::load_grid(folder / "TVC_System_32.raw", folder / "TVC_System.dyr", Conventions::psse());
  constexpr std::size_t kVe = 5 + 4 + 3;  // after the states of GENSAL and HYGOV
  expect_agreement(folder / "results_PSSe.csv", {grid, trip(grid, 1, 4), plant_of(grid, "2"), kInnerSteps},
                   {{"V1", kVoltage, false},
                    {"V2", kVoltage, false},
                    {"V3", kVoltage, false},
                    {"V4", kVoltage, false},
                    {"speed", kShare},
                    {"VE", kShare}},
                   [&](const Signals<double>& s, const double* x, const double* v) {
                     std::vector<double> row;
                     for (int bus = 1; bus <= 4; ++bus) row.push_back(magnitude(grid, v, bus));
                     row.insert(row.end(), {s.speed, x[kVe]});
                     return row;
                   });
}

TEST(PsseRecords, SexsWithoutItsLag) {
  const auto folder = folder_of("SEXS_noTE");
  const grid::Grid grid =
      grid::load_grid(folder / "ThreeBusMulti.raw", folder / "ThreeBus_SEXS_noTE.dyr", Conventions::psse());
  expect_agreement(folder / "SEXS_RESULTS_NoTE.csv", {grid, trip(grid, 101, 102), plant_of(grid, "102")},
                   {{"V102", kVoltage, false}},
                   [](const Signals<double>& s, const double*, const double*) { return std::vector{s.V}; });
}

TEST(PsseRecords, IeeestWithItsFilter) {
  const auto folder = folder_of("IEEEST_filter");
  const grid::Grid grid = grid::load_grid(folder / "ThreeBusMulti.raw",
                                          folder / "ThreeBus_IEEEST_with_filter.dyr", Conventions::psse());
  expect_agreement(folder / "IEEEST_SEXS_RESULTS_FILT.csv",
                   {grid, trip(grid, 101, 102), plant_of(grid, "102")},
                   {{"Efd", kShare}, {"V102", kVoltage, false}},
                   [](const Signals<double>& s, const double*, const double*) {
                     return std::vector{s.Efd, s.V};
                   });
}

TEST(PsseRecords, Esac1a) {
  for (const std::string saturated : {"", "_SAT"}) {
    const auto folder = folder_of("AC1A");
    const grid::Grid grid = grid::load_grid(
        folder / "ThreeBusMulti.raw", folder / ("ThreeBus_ESAC1A" + saturated + ".dyr"), Conventions::psse());
    expect_agreement(folder / ("TEST_ESAC1A" + saturated + ".csv"),
                     {grid, trip(grid, 101, 102), plant_of(grid, "102"), kInnerSteps},
                     {{"angle", kAngle, false}, {"V102", kVoltage, false}},
                     [](const Signals<double>& s, const double* x, const double*) {
                       return std::vector{x[0] * 180.0 / std::numbers::pi, s.V};
                     });
  }
}

TEST(PsseRecords, GastWithEsac1a) {
  const auto folder = folder_of("GAST");
  const grid::Grid grid =
      grid::load_grid(folder / "ThreeBusMulti.raw", folder / "ThreeBus_GAST.dyr", Conventions::psse());
  expect_agreement(folder / "GAST_TEST.csv", {grid, trip(grid, 101, 102), plant_of(grid, "102"), kInnerSteps},
                   {{"angle", kAngle, false}, {"Efd", kShare}},
                   [](const Signals<double>& s, const double* x, const double*) {
                     return std::vector{x[0] * 180.0 / std::numbers::pi, s.Efd};
                   });
}

// These curves are PowerWorld's, not PSS/E's, hence exact integration. The governor makes an undamped swing
// grow. Swingbank's swing is 9.4 % larger at 5 s. With the delay it is 2.2 % larger: the polynomials of the
// delay are exact to s TD = 3j, and 6.5j occurs. Of the difference, 5.1 % are due to a droop in the curves
// (DegovCurvesContainADroop), the rest to PSS/E's classical machine, (Pm - D w - Pe)/(1 + w).
TEST(PsseRecords, DegovWithAndWithoutDelay) {
  constexpr double kRate = 240.0, kDegovEnd = 5.0;
  for (const std::string delay : {"nodelay", "delay"}) {
    const auto folder = folder_of("DEGOV");
    const grid::Grid grid = grid::load_grid(
        folder / "ThreeBusMulti.raw", folder / ("ThreeBus_DEGOV_" + delay + ".dyr"), Conventions::psse());
    ReferenceOptions options;
    options.t_end = kDegovEnd;
    options.rate = kRate;
    options.channels = {Channel::speed};
    const ReferenceRun run = run_reference(grid, trip(grid, 101, 102), options);
    const double* ours = run.at(static_cast<int>(plant_of(grid, "102")), 0);
    double low = 1e9, high = -1e9, worst = 0.0, at = 0.0;
    for (const auto& row : test::read_table(folder / ("degov_" + delay + "_speed_final.csv"), false).rows) {
      const double difference = std::abs(1.0 + ours[std::lround(row[0] * kRate)] - row[1]);
      low = std::min(low, row[1]);
      high = std::max(high, row[1]);
      if (difference > worst) at = row[0];
      worst = std::max(worst, difference);
    }
    std::cout << "DEGOV " << delay << " " << worst / (high - low) << " at " << at << " s\n";
    EXPECT_LT(worst / (high - low), delay == "delay" ? 0.025 : 0.1) << delay << " at " << at << " s";
  }
}

/// Speed of machine 102 in DEGOV's case, one sample every 1/240 s. A classical machine as PowerWorld
/// integrates it: 2H dw/dt = (Pm - D w)/(1 + w) - Te with Pm = (1 + w) exp(-s delay) throttle. The network is
/// solved in closed form; the governor is Swingbank's DEGOV1 with this droop.
std::vector<double> speed_of_diesel(const grid::Grid& grid, double droop, double delay) {
  using C = std::complex<double>;
  constexpr int kSteps = 10, kSamples = 1201;
  constexpr double h = 1.0 / (240.0 * kSteps), H = 8.0, D = 0.03;
  const auto voltage = [&](int bus) {
    return grid.flow.voltage[static_cast<std::size_t>(grid.network.bus_index(bus))];
  };
  const C line(grid.network.branches[0].r, grid.network.branches[0].x), jX(0.0, 0.25),
      V1 = voltage(101), V2 = voltage(102), V3 = voltage(103),
      consumes = std::conj(grid.network.loads[0].power) / std::norm(V3);
  const C before = (V2 - V1) / line + (V2 - V3) / line, E = V2 + jX * before;
  const double P = (V2 * std::conj(before)).real();
  const auto electrical = [&](double delta, bool open) {
    const C e = std::polar(std::abs(E), delta);
    if (!open) return P;
    const C v3 = (V1 / line + e / (line + jX)) / (1.0 / line + 1.0 / (line + jX) + consumes);
    return (e * std::conj((e - v3) / (line + jX))).real();
  };
  Signals<double> at = test::ControlBench::rated();
  at.P = at.Te = at.Tm = P;
  test::ControlBench governor("DEGOV1",
                              {{"M", 0},
                               {"T1", 0},
                               {"T2", 0},
                               {"T3", 0},
                               {"K", 18},
                               {"T4", 12},
                               {"T5", 5},
                               {"T6", 0.2},
                               {"TD", 0},
                               {"TMAX", 2},
                               {"TMIN", -0.1},
                               {"DROOP", droop}},
                              at);
  EXPECT_EQ(governor.refused, "");
  std::vector<double> speeds, throttle;
  const auto late = static_cast<std::ptrdiff_t>(std::lround(delay / h));
  double delta = std::arg(E), w = 0.0;
  for (int k = 0; k < kSamples * kSteps; ++k) {
    if (k % kSteps == 0) speeds.push_back(w);
    throttle.push_back(governor.state("throttle"));
    const auto from = static_cast<std::ptrdiff_t>(throttle.size()) - 1 - late;
    const double torque = from < 0 ? P : throttle[static_cast<std::size_t>(from)];
    const bool open = k >= std::lround(kSwitching / h);
    // Leapfrog: speed and angle are half a step, 0.2 ms, apart, which is 0.06 % of the swing.
    w += h / (2.0 * H) * (torque - D * w - electrical(delta, open));
    delta += h * 2.0 * std::numbers::pi * 60.0 * w;
    governor.in.speed = w;
    governor.run(h, h);
  }
  return speeds;
}

// Inferred, not documented: a droop of 0.0565 pu of the throttle, fitted to the first curve, reduces the
// differences from 5.1 and 3.3 % of the swing to 0.04 % in both curves. This test computes the delay exactly.
// DEGOV has no such parameter; the model or setting of PowerWorld behind the curves is unknown.
TEST(PsseRecords, DegovCurvesContainADroop) {
  for (const auto& [name, delay, without] :
       {std::tuple{"nodelay", 0.0, 0.04}, std::tuple{"delay", 1.0, 0.03}}) {
    const auto folder = folder_of("DEGOV");
    const grid::Grid grid = grid::load_grid(folder / "ThreeBusMulti.raw",
                                            folder / "ThreeBus_DEGOV_nodelay.dyr", Conventions::psse());
    const auto theirs =
        test::read_table(folder / ("degov_" + std::string(name) + "_speed_final.csv"), false).rows;
    const auto share = [&](double droop) {
      const std::vector<double> ours = speed_of_diesel(grid, droop, delay);
      double low = 1e9, high = -1e9, worst = 0.0;
      for (const auto& row : theirs) {
        worst = std::max(
            worst, std::abs(1.0 + ours[static_cast<std::size_t>(std::lround(row[0] * 240.0))] - row[1]));
        low = std::min(low, row[1]);
        high = std::max(high, row[1]);
      }
      std::cout << "DEGOV1 " << name << " DROOP " << droop << ": " << worst / (high - low) << "\n";
      return worst / (high - low);
    };
    EXPECT_LT(share(0.0565), 1e-3) << name;
    EXPECT_GT(share(0.0), without) << name;
  }
}

TEST(PsseRecords, LoadsAtConstantCurrentAndPower) {
  for (const auto& [file, load] :
       {std::pair{"constantcurrent", "*:ZIP:Pi=1,Qi=1"}, {"constantpower", "*:ZIP:Pp=1,Qp=1"}}) {
    const auto folder = folder_of("LOAD");
    grid::Grid grid =
        grid::load_grid(folder / "ThreeBusMulti.raw", folder / "ThreeBus_GENROU.dyr", Conventions::psse());
    Problems problems;
    grid::choose_load(grid, load, "--load", problems);
    problems.raise();
    expect_agreement(folder / (std::string(file) + ".csv"),
                     {grid, trip(grid, 101, 102), plant_of(grid, "102")},
                     {{"V102", kVoltage, false},
                      {"angle of V102", kAngle, false},
                      {"V103", kVoltage, false},
                      {"angle of V103", kAngle, false}},
                     [&](const Signals<double>&, const double*, const double* v) {
                       return std::vector{magnitude(grid, v, 102), degrees(grid, v, 102),
                                          magnitude(grid, v, 103), degrees(grid, v, 103)};
                     });
  }
}

}  // namespace
}  // namespace swingbank::sim::reference::psse_controls
