// Play-in is right if a simulated terminal voltage, played back, reproduces the simulated P and Q.
#include "validate/playin/play_in.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::playin {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  double w = 0;
  for (std::size_t k = 0; k < a.size(); ++k) w = std::max(w, std::abs(a[k] - b[k]));
  return w;
}

/// Largest error of P and Q over all plants that respond [pu on each machine's base].
double playback_error(const test::Simulated& s, int stride, bool one_sided) {
  double error = 0;
  for (int plant = 0; plant < static_cast<int>(s.grid.plants.size()); ++plant) {
    const record::Record r = test::record_of(s, plant, stride);
    const VoltageCurve curve(r, test::exact_switchings(s, plant, one_sided));
    const Playback back =
        play_in({s.grid.plants[static_cast<std::size_t>(plant)], s.grid.conventions}, r, curve);
    error = std::max({error, worst(back.P, r.P), worst(back.Q, r.Q)});
  }
  return error;
}

/// Saturated GENROU, bolted fault in the middle of the grid: one simulation for several tests.
const test::Simulated& genrou() {
  static const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0, 2.1);
  return s;
}

TEST(PlayInTest, ReproducesEverySimulatedGenrou) {
  // Spline error at 480/s: 5/384 h^4 V'''' with V'''' about 0.05 pu/(0.05 s)^4, times 1/X'' of about 4. This
  // is below 1e-8 pu.
  EXPECT_LT(playback_error(genrou(), 1, true), 1e-7);
}

TEST(PlayInTest, ReproducesEverySimulatedGentpjBehindATransformer) {
  EXPECT_LT(playback_error(test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0, 2.1, 480, {},
                                          test::put_behind_transformers),
                           1, true),
            1e-7);
}

/// Adds an exciter of high gain to every machine. After the fault its field voltage changes at hundreds of
/// pu/s and reaches a close ceiling within milliseconds: this is a corner inside an integration step that the
/// error control cannot resolve.
void put_fast_exciters(sim::grid::Grid& grid) {
  for (auto& plant : grid.plants)
    plant.controls.push_back({sim::library::compiled().find("SEXS"), {0.3, 10.0, 300.0, 0.02, -1.0, 3.5}});
}

TEST(PlayInTest, FieldVoltageReachesItsCeiling) {
  EXPECT_LT(playback_error(test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0, 2.1, 480, {},
                                          put_fast_exciters),
                           1, true),
            1e-6);
}

TEST(PlayInTest, ErrorFallsWithTheRate) {
  std::printf("samples/s   one-sided values known   extrapolated   [pu, worst of P and Q, 10 machines]\n");
  // Fourth order of the spline: the error at 120/s is 4^4 = 256 times that at 480/s. The bounds are about 3
  // times the measured values (6.4e-8, 1.2e-6, 4.1e-5; extrapolated 1.2e-6, 2.6e-5, 1.2e-3).
  const struct {
    int stride;
    double known, extrapolated;
  } rows[] = {{4, 2e-7, 4e-6}, {8, 4e-6, 8e-5}, {16, 1.2e-4, 3.5e-3}};
  for (const auto& row : rows) {
    const double known = playback_error(genrou(), row.stride, true),
                 extrapolated = playback_error(genrou(), row.stride, false);
    std::printf("%9.0f   %22.1e   %12.1e\n", 480.0 / row.stride, known, extrapolated);
    EXPECT_LT(known, row.known);
    EXPECT_LT(extrapolated, row.extrapolated);
  }
}

/// Largest interpolation error of V between samples of one segment, by polynomials through `points`
/// neighbours and by the spline of play-in. Evaluated from the fault's end to the end of the run. Samples at
/// 480/s are the reference.
struct VoltageError {
  double polynomial = 0, spline = 0;
};
VoltageError voltage_error(const test::Simulated& s, int stride, int points) {
  VoltageError worst_error;
  const int first = static_cast<int>(std::lround(s.t_off * s.before.rate)) + stride;
  for (int plant = 0; plant < static_cast<int>(s.grid.plants.size()); ++plant) {
    const auto phasor = [&](int k) { return std::polar(s.before.at(plant, 0)[k], s.before.at(plant, 1)[k]); };
    const record::Record r = test::record_of(s, plant, stride);
    const VoltageCurve curve(r, test::exact_switchings(s, plant, false));
    const int last = first + (s.before.samples - 1 - first) / stride * stride;
    for (int k = first; k <= last; ++k) {
      const int below = first + (k - first) / stride * stride;
      const int begin = std::clamp(below - (points / 2 - 1) * stride, first, last - (points - 1) * stride);
      Complex v = 0;
      for (int i = 0; i < points; ++i) {  // Lagrange
        double weight = 1;
        for (int j = 0; j < points; ++j)
          if (j != i) weight *= static_cast<double>(k - begin - j * stride) / ((i - j) * stride);
        v += weight * phasor(begin + i * stride);
      }
      worst_error.polynomial = std::max(worst_error.polynomial, std::abs(v - phasor(k)));
      worst_error.spline = std::max(worst_error.spline, std::abs(curve(2, k / s.before.rate) - phasor(k)));
    }
  }
  return worst_error;
}

TEST(PlayInTest, InterpolationErrorFallsWithOrderAndRate) {
  std::printf(
      "samples/s     linear      cubic    quintic     spline   [pu of V, 10 machines, after the fault]\n");
  double before[3] = {};
  for (const int stride : {16, 8, 4}) {
    double error[3], spline = 0;
    for (int i = 0; i < 3; ++i) {
      const VoltageError e = voltage_error(genrou(), stride, 2 * (i + 1));
      error[i] = e.polynomial;
      spline = e.spline;
    }
    std::printf("%9.0f   %8.1e   %8.1e   %8.1e   %8.1e\n", 480.0 / stride, error[0], error[1], error[2],
                spline);
    EXPECT_LT(error[1], error[0]);
    EXPECT_LT(error[2], error[1]);
    EXPECT_LT(spline,
              2 * error[1]);  // the spline has the order of the cubic; it uses all points, not four, and is
                              // no worse
    // Half the step divides the error by 2^order: 4, 16, 64. The largest error lies at a segment's end, where
    // all points are on one side and move with the step. Only about half of the factor is certain there.
    for (int i = 0; i < 3; ++i) {
      if (before[i] > 0) {
        EXPECT_GT(before[i] / error[i], 0.45 * std::pow(4.0, i + 1));
      }
      before[i] = error[i];
    }
  }
}

TEST(PlayInTest, ReproducesOtherConventionsAndModels) {
  EXPECT_LT(playback_error(
                test::simulate("ieee39_genrou", sim::Conventions::andes(), 4, 2.0, 2.15, 480, {0.01, 0.05}),
                1, true),
            1e-7);
  EXPECT_LT(playback_error(test::simulate("ieee39_gencls", sim::Conventions::psse(), 16, 2.0, 2.1), 1, true),
            1e-7);
}

TEST(PlayInTest, DetectsWrongParameter) {
  const record::Record r = test::record_of(genrou(), 2, 4);
  sim::plant::Plant wrong = genrou().grid.plants[2];
  wrong.machine.p[static_cast<std::size_t>(wrong.machine.effect->parameter_index("H"))] *= 1.1;
  const Playback back = play_in({wrong, genrou().grid.conventions}, r,
                                VoltageCurve(r, test::exact_switchings(genrou(), 2, true)));
  EXPECT_GT(worst(back.P, r.P),
            0.01);  // 10 % of H moves P by some per cent of the machine in its first swing
}

TEST(PlayInTest, StaysAtRest_WithoutAnEvent) {
  record::Record r;
  for (int k = 0; k <= 900; ++k) {
    r.t.push_back(k / 60.0);
    r.V.push_back(1.02);
    r.theta.push_back(0.3);
    r.P.push_back(0.8);
    r.Q.push_back(0.1);
  }
  const Playback back = play_in({genrou().grid.plants[0], genrou().grid.conventions}, r, VoltageCurve(r, {}));
  EXPECT_LT(worst(back.P, r.P),
            1e-10);  // only rounding: the start is a mean of equal numbers, and the initialisation is exact
  EXPECT_LT(worst(back.Q, r.Q), 1e-10);
}

TEST(PlayInTest, OffNominalFrequencyRotatesTheFrame) {
  const test::Simulated& s = genrou();
  record::Record r = test::record_of(s, 3, 4);
  const Playback still = play_in({s.grid.plants[3], s.grid.conventions}, r,
                                 VoltageCurve(r, test::exact_switchings(s, 3, false)));
  const double drift = 2 * std::numbers::pi * 0.02;  // 20 mHz
  for (std::size_t k = 0; k < r.t.size(); ++k) r.theta[k] += drift * r.t[k];
  const Playback turning = play_in({s.grid.plants[3], s.grid.conventions}, r,
                                   VoltageCurve(r, test::exact_switchings(s, 3, false)));
  EXPECT_NEAR(turning.start.drift, drift, 1e-6);
  // At 120/s the phasors turn by 1 mrad per sample. The spline error of this rotation, of order h^4, is a few
  // 1e-6 pu.
  EXPECT_LT(worst(turning.P, still.P), 1e-5);
}

/// Ten seconds before a switching, with this angle, rising P and V, and noise.
record::Record before_an_event(double (*angle)(double t)) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1e-5);
  record::Record r;
  for (int k = 0; k <= 900; ++k) {
    const double t = k / 60.0;
    r.t.push_back(t);
    r.V.push_back(1.02 + 1e-4 * t + noise(random));
    r.theta.push_back(angle(t) + noise(random));
    r.P.push_back(0.8 + 5e-3 * t + noise(random));
    r.Q.push_back(0.1 + noise(random));
  }
  return r;
}

TEST(PlayInTest, StartsOnTheTrajectoryOfADriftingGrid) {
  const record::Record r = before_an_event([](double t) { return 0.3 + 0.02 * t - 0.004 * t * t; });
  const OperatingPoint start = pre_event_point(r, {{10.0, 0.0}}, 1.0);
  EXPECT_NEAR(start.drift, 0.02, 1e-5);
  EXPECT_NEAR(std::abs(start.voltage), 1.02, 1e-5);
  EXPECT_NEAR(std::arg(start.voltage), 0.3, 1e-5);
  EXPECT_NEAR(start.P, 0.8, 1e-5);
  EXPECT_NEAR(start.Q, 0.1, 1e-5);
}
TEST(PlayInTest, LinearOrSwingingAngleIsNotDrift) {
  for (const auto angle : {+[](double t) { return 0.3 + 0.02 * t; },
                           +[](double t) { return 0.3 + 0.01 * std::sin(2 * std::numbers::pi * 0.7 * t); }}) {
    const OperatingPoint start = pre_event_point(before_an_event(angle), {{10.0, 0.0}}, 1.0);
    EXPECT_NEAR(start.P, 0.825, 1e-5);  // mean value
  }
}

TEST(PlayInTest, UsesTheRecordsOwnBase) {
  const test::Simulated& s = genrou();
  record::Record own = test::record_of(s, 1, 4), system = own;
  system.base.mva = 100;
  const double factor = own.base.mva / 100;
  for (auto* channel : {&system.P, &system.Q})
    for (auto& v : *channel) v *= factor;
  const auto at = test::exact_switchings(s, 1, true);
  const Playback a = play_in({s.grid.plants[1], s.grid.conventions}, own, VoltageCurve(own, at));
  const Playback b = play_in({s.grid.plants[1], s.grid.conventions}, system, VoltageCurve(system, at));
  for (std::size_t k = 0; k < a.P.size(); ++k) ASSERT_NEAR(a.P[k] * factor, b.P[k], 1e-9);
}

TEST(PlayInTest, RefusesARecordWithoutPreEvent) {
  record::Record r = test::record_of(genrou(), 0, 8);
  r.t.resize(40);
  EXPECT_THAT(test::messages([&] { pre_event_point(r, {{.time = r.t[2]}}, 1.0); }),
              ElementsAre(HasSubstr("3 samples before the event")));
}

}  // namespace
}  // namespace swingbank::validate::playin
