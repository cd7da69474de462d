// REECD1: equality with REECB1 while the parts that REECB1 lacks are inactive, compensated voltage, currents
// kept after a voltage dip, blocking, tables.
#include <cmath>

#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using Values = ControlBench::Changes;

/// A converter at rated voltage: 0.8 pu of active and `reactive` pu of reactive current.
Signals<double> at_rated(double reactive = 0.1) {
  Signals<double> s;
  s.Vr = s.V = s.Vc = s.Vpr = s.Vp = 1.0;
  s.Ir = s.P = s.Tm = s.Pneed = s.Pord = 0.8;
  s.Ii = -reactive;
  s.Q = s.Efd = s.Qneed = reactive;
  return s;
}

TEST(Reecd1, EqualsReecb1_WhenItsOwnPartsAreOff) {
  for (const Values& flags : {Values{{"QFLAG", 1.0}, {"VFLAG", 1.0}, {"Kqp", 0.2}},
                              {{"QFLAG", 1.0}, {"VFLAG", 0.0}},
                              {{"QFLAG", 0.0}, {"PQFLAG", 1.0}}}) {
    Values common = {{"Kqv", 2.0}, {"dbd1", -0.05}, {"dbd2", 0.05}, {"Imax", 1.0}, {"Vref0", 1.0}};
    for (const auto& [name, x] : flags) common[name] = x;
    Values mine = common;
    mine["VCMPFLAG"] = 0.0;
    if (flags.at("QFLAG") == 1.0 && flags.at("VFLAG") == 0.0) mine["Vref1"] = 1.0;
    ControlBench b("REECB1", common, at_rated()), d("REECD1", mine, at_rated());
    ASSERT_TRUE(d.problems.empty());
    ASSERT_EQ(d.refused, b.refused);
    EXPECT_LT(d.largest_derivative(), 1e-12);
    for (const double V : {0.97, 0.9, 0.8, 1.03, 1.0}) {
      for (ControlBench* bench : {&b, &d}) {
        bench->in.V = V;
        bench->in.Pext = 0.2 * (1.0 - V);
        bench->in.Q = 0.1 - 0.2 * (1.0 - V);
        bench->run(0.1);
      }
      EXPECT_DOUBLE_EQ(d.out().Tm, b.out().Tm) << V;
      EXPECT_DOUBLE_EQ(d.out().Efd, b.out().Efd) << V;
    }
  }
}

TEST(Reecd1, RegulatesTheVoltageBehindItsImpedanceOrWithDroop) {
  const Values regulates = {{"QFLAG", 1.0}, {"VFLAG", 0.0}, {"Kvp", 0.0},
                            {"Kvi", 5.0},   {"Tr1", 0.1},   {"Kc", 0.2}};
  for (const double flag : {1.0, 0.0}) {
    Values v = regulates;
    v["VCMPFLAG"] = flag;
    v["Rc"] = 0.02;
    v["Xc"] = 0.1;
    ControlBench bench("REECD1", v, at_rated());
    ASSERT_EQ(bench.refused, "");
    const auto compensated = [&](double ir, double ii) {
      const std::complex<double> behind =
          1.0 - std::complex<double>(0.02, 0.1) * std::complex<double>(ir, ii);
      return flag == 1.0 ? std::abs(behind) : 1.0 - 0.2 * ii;
    };
    EXPECT_NEAR(bench.state("Vcomp"), compensated(0.8, -0.1), 1e-14);
    bench.in.Ii = -0.3;
    bench.in.Q = 0.3;
    bench.run(1.0);
    const double off = compensated(0.8, -0.1) - compensated(0.8, -0.3),
                 seen = 1.0 - 0.1 * (1.0 - std::exp(-10.0));
    EXPECT_NEAR(bench.out().Efd, 0.1 + 5.0 * off * seen, 1e-9);  // integral of the filtered error (0.1 s)
  }
}

TEST(Reecd1, AfterADipItKeepsOrFreezesTheReactiveCurrent) {
  for (const double thld : {0.5, -0.5}) {
    ControlBench bench(
        "REECD1", {{"Vdip", 0.85}, {"Kqv", 2.0}, {"Thld", thld}, {"Iqfrz", 0.15}, {"Trv", 0.0}}, at_rated());
    ASSERT_EQ(bench.refused, "");
    bench.in.V = 0.7;
    bench.run(0.1);
    const double in_dip = 0.1 + 2.0 * 0.3;  // its lag is frozen
    EXPECT_NEAR(bench.out().Efd, in_dip, 1e-9);
    bench.in.V = 0.99;
    bench.run(0.45);
    EXPECT_NEAR(bench.out().Efd, thld > 0 ? in_dip : 0.15, 1e-6);
    bench.run(0.5);
    EXPECT_NEAR(bench.out().Efd, 0.1 / 0.99 + 2.0 * 0.01, 1e-6);
  }
}

TEST(Reecd1, AfterADipItKeepsTheActiveCurrent) {
  ControlBench bench("REECD1", {{"Vdip", 0.85}, {"Thld2", 0.5}, {"Trv", 0.0}, {"Imax", 0.9}}, at_rated(0.0));
  bench.in.V = 0.7;
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Tm, 0.9, 1e-9);  // demand: 0.8/0.7
  bench.in.V = 1.0;
  bench.run(0.45);
  EXPECT_NEAR(bench.out().Tm, 0.9, 1e-6);
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-9);
}

TEST(Reecd1, BlocksOutsideItsVoltageRangeAndForADelayAfterwards) {
  ControlBench bench("REECD1", {{"Vblkl", 0.5}, {"Vblkh", 1.3}, {"Tblk", 0.3}, {"Trv", 0.0}, {"Kqv", 2.0}},
                     at_rated());
  ASSERT_EQ(bench.refused, "");
  for (const double V : {0.3, 1.4}) {
    bench.in.V = V;
    bench.run(0.1);
    EXPECT_NEAR(bench.out().Tm, 0.0, 1e-12) << V;
    EXPECT_NEAR(bench.out().Efd, 0.0, 1e-12) << V;
    bench.in.V = 1.0;
    bench.run(0.28);
    EXPECT_NEAR(bench.out().Tm, 0.0, 1e-9) << V;
    bench.run(0.05);
    EXPECT_NEAR(bench.out().Tm, 0.8, 1e-6) << V;
  }
  EXPECT_NE(ControlBench("REECD1", {{"Vblkl", 1.01}}, at_rated()).refused.find("blocks"), std::string::npos);
}

TEST(Reecd1, TablesHaveTenPoints) {
  Values v = {{"Trv", 0.0}, {"Imax", 3.0}};
  for (int k = 1; k <= 10; ++k) {
    v["Vp" + std::to_string(k)] = 0.1 * k;
    v["Ip" + std::to_string(k)] = 0.1 * k * k / 10.0;
  }
  ControlBench bench("REECD1", v, at_rated());
  ASSERT_EQ(bench.refused, "");
  for (const auto& [V, most] :
       {std::pair{0.35, (0.09 + 0.16) / 2}, {0.75, (0.49 + 0.64) / 2}, {0.05, 0.01}}) {
    bench.in.V = V;
    EXPECT_NEAR(bench.out().Tm, most, 1e-12) << V;
  }
  v["Vp3"] = 0.0;  // the table ends with its second point
  ControlBench short_one("REECD1", {{"Trv", 0.0}, {"Vp3", 0.0}, {"Ip3", 9.0}}, at_rated());
  EXPECT_EQ(short_one.refused, "");
  EXPECT_NE(ControlBench("REECD1", v, at_rated()).refused, "");  // limit from the table: 0.04 pu
}

TEST(Reecd1, ABatteryDrawsUpToKe) {
  ControlBench bench("REECD1", {{"Ke", 0.5}, {"Pmin", -1.0}, {"Imax", 1.0}}, at_rated(0.0));
  bench.in.Pext = -1.6;
  bench.run(1.0);
  EXPECT_NEAR(bench.out().Tm, -0.5 * 1.0, 1e-9);  // half of the smallest limit, Imax
}

TEST(Reecd1, RefusesParametersThatCannotBeIntegrated) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] :
       {Change{"VCMPFLAG", 2.0}, {"Tr1", -1.0}, {"Tblk", -1.0}, {"Ke", 1.5}, {"Vblkh", -1.0}, {"Iq3", -0.1}})
    EXPECT_EQ(ControlBench("REECD1", {{name, value}}, at_rated()).problems.list().size(), 1u) << name;
}

}  // namespace
}  // namespace swingbank::sim::test
