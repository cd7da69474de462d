// DERA1 against hand calculations: ride-through, tripping and reconnection, frequency response, current
// priority, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim {
namespace {

using DeraChanges = std::vector<std::pair<const char*, double>>;
constexpr double kActive = 0.6, kReactive = 0.15;  ///< at the start [pu]

struct Distributed {
  explicit Distributed(const DeraChanges& changes = {}, std::complex<double> power = {kActive, kReactive}) {
    p = effect.default_parameters();
    p.at(static_cast<std::size_t>(effect.parameter_index("vtripFlag"))) = 1.0;
    for (const auto& [name, value] : changes)
      p.at(static_cast<std::size_t>(effect.parameter_index(name))) = value;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    m.resize(static_cast<std::size_t>(effect.scratch));
    effect.check(nullptr, p.data(), "test", problems);
    set(1.0);
    s.Ir = power.real(), s.Ii = -power.imag();
    ops.prepare(p.data(), Conventions::psse(), c.data());
    refused = ops.machine.steady(p.data(), c.data(), s, x.data());
  }
  void set(std::complex<double> v) { s.Vr = v.real(), s.Vi = v.imag(); }
  std::vector<double> derivatives(const std::vector<double>& at) {
    std::vector<double> dx(at.size());
    ops.machine.current(c.data(), at.data(), m.data(), s);
    s.V = std::hypot(s.Vr, s.Vi);
    ops.machine.electrical(c.data(), at.data(), m.data(), s);
    ops.machine.derivative(c.data(), at.data(), m.data(), s, dx.data());
    return dx;
  }
  /// Integrates for `duration` [s] at the voltage v(t), t from 0, by the midpoint rule with steps far below
  /// every time constant.
  void run(double duration, const std::function<std::complex<double>(double)>& v) {
    constexpr double h = 2e-5;
    const long steps = std::lround(duration / h);
    for (long k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) * h;
      set(v(t));
      auto half = x;
      const auto first = derivatives(x);
      for (std::size_t i = 0; i < x.size(); ++i) half[i] += 0.5 * h * first[i];
      set(v(t + 0.5 * h));
      const auto mid = derivatives(half);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = limited(i, x[i] + h * mid[i]);
    }
    set(v(duration));
  }
  void run(double duration, double magnitude) {
    run(duration, [&](double) { return std::complex<double>(magnitude); });
  }
  double limited(std::size_t i, double value) const {
    const State& state = effect.states[i];
    if (state.low >= 0) value = std::max(value, c[static_cast<std::size_t>(state.low)]);
    if (state.high >= 0) value = std::min(value, c[static_cast<std::size_t>(state.high)]);
    return value;
  }
  double state(std::string_view name) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (effect.states[i].name == name) return x[i];
    throw std::out_of_range(std::string(name));
  }
  std::complex<double> power() {
    ops.machine.current(c.data(), x.data(), m.data(), s);
    return std::complex<double>(s.Vr, s.Vi) * std::complex<double>(s.Ir, -s.Ii);
  }
  const Effect& effect = *library::compiled().find("DERA1");
  const Ops<double>& ops = effect.get<double>();
  std::vector<double> p, c, x, m;
  Signals<double> s;
  Problems problems;
  std::string refused;
};

TEST(ConverterDera1, StaysAtOperatingPointAndRidesThroughASag) {
  Distributed der;
  ASSERT_TRUE(der.problems.empty());
  ASSERT_EQ(der.refused, "");
  for (const double d : der.derivatives(der.x)) EXPECT_NEAR(d, 0.0, 1e-12);
  der.run(1.0, 0.9);
  // The voltage exceeds the dead-band of 0.05 pu by 0.05 pu, at 5 pu/pu; the power recovers.
  EXPECT_NEAR(der.power().real(), kActive, 1e-6);
  EXPECT_NEAR(der.state("Iq"), kReactive / 0.9 + 0.25, 1e-6);
  EXPECT_EQ(der.state("least"), 0.49);
}

TEST(ConverterDera1, LowVoltageTripsAPartAndAFractionReconnects) {
  const DeraChanges sags = {{"Kqv", 0.0}, {"freqFlag", 0.0}, {"Imax", 2.0}};
  Distributed brief(sags);
  brief.run(0.2, 0.465);  // the measured voltage is below Vl1 for 0.14 s
  EXPECT_NEAR(brief.state("M"), 0.5, 5e-3);
  brief.run(0.5, 1.0);
  EXPECT_NEAR(brief.state("M"), 1.0, 1e-6);
  EXPECT_NEAR(brief.power().real(), kActive, 1e-6);
  EXPECT_NEAR(brief.state("low1"), 0.0, 1e-9);  // the timer is reset for the next sag

  Distributed lasting(sags);
  lasting.run(0.4, 0.465);
  lasting.run(0.5, 1.0);
  EXPECT_NEAR(lasting.state("M"), 0.5 + 0.7 * 0.5, 1e-6);
  EXPECT_NEAR(lasting.power().real(), 0.85 * kActive, 1e-6);
  EXPECT_NEAR(lasting.power().imag(), 0.85 * kReactive, 1e-6);
  lasting.run(0.4, 0.479);  // a shallower sag trips nothing more
  EXPECT_NEAR(lasting.state("M"), 0.5 + 0.7 * (0.479 - 0.465) / 0.05, 1e-6);
}

TEST(ConverterDera1, HighVoltageMirrorsLowVoltage) {
  Distributed der({{"freqFlag", 0.0}, {"Kqv", 0.0}, {"Vrfrac", 0.5}});
  der.run(0.4, 1.16);
  EXPECT_NEAR(der.state("M"), 0.8, 1e-6);
  der.run(0.5, 1.0);
  EXPECT_NEAR(der.state("M"), 0.8 + 0.5 * 0.2, 1e-6);
  der.run(0.4, 1.25);
  der.run(0.5, 1.0);
  EXPECT_NEAR(der.state("M"), 0.0, 1e-6);
}

TEST(ConverterDera1, NothingReconnectsAfterTvl0BelowVl0) {
  Distributed brief({{"freqFlag", 0.0}}), lasting({{"freqFlag", 0.0}});
  brief.run(0.12, 0.2);
  EXPECT_LT(brief.state("M"), 0.1);
  brief.run(1.0, 1.0);
  EXPECT_NEAR(brief.state("M"), 1.0, 1e-6);
  lasting.run(0.3, 0.2);
  lasting.run(1.0, 1.0);
  EXPECT_NEAR(lasting.state("M"), 0.0, 1e-6);
  EXPECT_NEAR(std::abs(lasting.power()), 0.0, 1e-6);
}

/// Voltage of a grid whose frequency deviates by `deviation` pu from the rated one.
std::complex<double> turning_voltage(double deviation, double t) {
  return std::polar(1.0, 2 * std::numbers::pi * 60.0 * deviation * t);
}

TEST(ConverterDera1, PowerFollowsHighFrequencyAtItsRate) {
  Distributed der;
  const auto v = [](double t) { return turning_voltage(0.005, t); };
  der.run(0.1, v);
  EXPECT_NEAR(der.state("Pset"), kActive - 0.5 * 0.1,
              0.01);  // dPmin, after the lag of the frequency measurement
  der.run(3.0, [&](double t) { return v(t + 0.1); });
  EXPECT_NEAR(der.power().real(), kActive - 20.0 * (0.005 - 0.0006), 1e-4);
  // Dup = 0: no response to low frequency.
  Distributed low;
  low.run(2.0, [](double t) { return turning_voltage(-0.005, t); });
  EXPECT_NEAR(low.power().real(), kActive, 1e-6);
}

TEST(ConverterDera1, FrequencyTripsUnlessTheVoltageIsLow) {
  const DeraChanges trips = {{"ftripFlag", 1.0}, {"freqFlag", 0.0}, {"Kqv", 0.0}};
  const auto under = [](double t) { return turning_voltage(55.0 / 60.0 - 1.0, t); };
  Distributed brief(trips), lasting(trips), low(trips);
  brief.run(0.15, under);
  brief.run(0.5, [&](double) { return under(0.15); });
  EXPECT_NEAR(brief.state("M"), 1.0, 1e-6);
  lasting.run(0.3, under);
  lasting.run(0.5, [&](double) { return under(0.3); });
  EXPECT_NEAR(lasting.state("M"), 0.0, 1e-6);
  low.run(0.3, [&](double t) { return 0.7 * under(t); });
  low.run(0.5, [&](double) { return under(0.3); });
  EXPECT_NEAR(low.state("M"), 1.0, 1e-6);
}

TEST(ConverterDera1, FlagSetsCurrentPriorityAtImax) {
  for (const bool p_first : {false, true}) {
    Distributed der({{"freqFlag", 0.0}, {"vtripFlag", 0.0}, {"Imax", 0.8}, {"pqFlag", p_first ? 1.0 : 0.0}});
    der.run(1.0, 0.8);  // demands: 0.75 and 0.9375 pu
    const double asked_p = kActive / 0.8, asked_q = kReactive / 0.8 + 5.0 * 0.15;
    EXPECT_GT(std::hypot(asked_p, asked_q), 0.8);
    EXPECT_NEAR(std::hypot(der.state("Ip"), der.state("Iq")), 0.8, 1e-6);
    EXPECT_NEAR(der.state(p_first ? "Ip" : "Iq"), p_first ? asked_p : 0.8, 1e-6);
  }
}

TEST(ConverterDera1, ActiveCurrentRisesByItsRate) {
  Distributed der({{"freqFlag", 0.0}, {"rrpwr", 0.5}, {"tvl0", 99.0}, {"tvl1", 99.0}, {"Kqv", 0.0}});
  der.run(0.5, 0.2);
  EXPECT_NEAR(der.state("Ip"), 0.0, 1e-6);  // decreases without delay
  der.run(0.1, 1.0);
  const double early = der.state("Ip");
  der.run(0.5, 1.0);
  EXPECT_NEAR(der.state("Ip") - early, 0.25, 1e-6);
}

TEST(ConverterDera1, OnlyBatteriesDrawPower) {
  EXPECT_NE(Distributed({}, {-0.3, 0.0}).refused.find("genFlag"), std::string::npos);
  Distributed battery({{"genFlag", 0.0}, {"Pmin", -1.1}}, {-0.3, 0.0});
  EXPECT_EQ(battery.refused, "");
  battery.run(1.0, 0.9);
  EXPECT_NEAR(battery.power().real(), -0.3, 1e-6);
}

TEST(ConverterDera1, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(Distributed({{"Imax", 0.5}}).refused.find("Imax"), std::string::npos);
  EXPECT_NE(Distributed({{"Vl1", 1.02}}).refused.find("Vl1"), std::string::npos);
  EXPECT_NE(Distributed({{"ftripFlag", 1.0}, {"fh", 59.0}}).refused.find("fh"), std::string::npos);
  EXPECT_EQ(Distributed({{"Vl0", 0.5}, {"Trf", 0.0}, {"Tv", -1.0}, {"pqFlag", 2.0}, {"Vrfrac", 1.5}})
                .problems.list()
                .size(),
            5u);
  EXPECT_TRUE(Distributed({{"Vl0", 0.5}, {"vtripFlag", 0.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim
