#pragma once
// Common parameters of the electrical controls REECA1, REECB1, REECC1 and REECD1: unit, default and range of
// each, and checks.
#include <array>
#include <string_view>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_control.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::renewable {

namespace record {

inline constexpr Parameter
    RemoteBus = {"RemoteBus", "remote bus",   "code", 0.0,
                 0.0,         999997.0,       0.0,    "regulated bus (0: the terminal)",
                 kAsEffect,   renewable::kBus},
    PFFLAG = {"PFFLAG",     "PFFLAG",
              "code",       0.0,
              0.0,          1.0,
              kNoNullValue, "1: constant power factor, 0: follows Qext",
              kAsEffect,    renewable::kFlag},
    VFLAG = {"VFLAG",      "VFLAG",
             "code",       1.0,
             0.0,          1.0,
             kNoNullValue, "source of Vcmd: 1 regulator of Q, 0 Qext",
             kAsEffect,    renewable::kFlag},
    QFLAG = {"QFLAG",      "QFLAG",
             "code",       0.0,
             0.0,          1.0,
             kNoNullValue, "source of Iq: 1 regulator of V, 0 Q/V",
             kAsEffect,    renewable::kFlag},
    PFLAG = {"PFLAG",      "PFLAG",
             "code",       0.0,
             0.0,          1.0,
             kNoNullValue, "1: Pext is multiplied by the generator's speed",
             kAsEffect,    renewable::kFlag},
    PQFLAG = {"PQFLAG",     "PQFLAG",
              "code",       0.0,
              0.0,          1.0,
              kNoNullValue, "current priority at Imax: 0 Q, 1 P",
              kAsEffect,    renewable::kFlag},
    Vdip = {"Vdip", "Vdip", "pu", -99.0, -99.0, 1.2, kNoNullValue, "voltage below which the dip logic acts"},
    Vup = {"Vup", "Vup", "pu", 99.0, 0.8, 99.0, kNoNullValue, "voltage above which the dip logic acts"},
    Trv = {"Trv", "Trv", "s", 0.02, 0.0, 1.0, kNoNullValue, "lag of the voltage measurement (0: none)"},
    dbd1 = {"dbd1", "dbd1", "pu", 0.0, -1.0, 0.0, 0.0, "lower edge of the dead-band of Iqv"},
    dbd2 = {"dbd2", "dbd2", "pu", 0.0, 0.0, 1.0, 0.0, "upper edge of the dead-band of Iqv"},
    Kqv = {"Kqv", "Kqv", "pu/pu", 0.0,
           0.0,   100.0, 0.0,     "gain from the voltage error to Iqv, the ride-through current"},
    Iqh1 = upper_limit({"Iqh1", "Iqh1", "pu", 1.1, 0.0, 99.0, kNoNullValue, "highest Iqv"}),
    Iql1 = lower_limit({"Iql1", "Iql1", "pu", -1.1, -99.0, 0.0, kNoNullValue, "lowest Iqv"}),
    Vref0 = {"Vref0", "Vref0", "pu", 0.0, 0.0, 1.5, kNoNullValue, "reference of Iqv (0: initial voltage)"},
    Tp = {"Tp", "Tp", "s", 0.05, 0.0, 10.0, kNoNullValue, "lag of the power measurement (0: none)"},
    Qmax = upper_limit({"Qmax", "Qmax", "pu", 0.44, -1.0, 99.0, kNoNullValue, "highest Qin"}),
    Qmin = lower_limit({"Qmin", "Qmin", "pu", -0.44, -99.0, 1.0, kNoNullValue, "lowest Qin"}),
    Vmax = upper_limit({"Vmax", "Vmax", "pu", 1.05, 0.5, 99.0, kNoNullValue, "highest Vcmd"}),
    Vmin = lower_limit({"Vmin", "Vmin", "pu", 0.9, -99.0, 1.2, kNoNullValue, "lowest Vcmd"}),
    Kqp = {"Kqp", "Kqp", "pu/pu", 0.0, 0.0, 100.0, 0.0, "regulator of Q, proportional gain"},
    Kqi = {"Kqi", "Kqi", "1/s", 0.01, 0.0, 500.0, 0.0, "regulator of Q, integral gain"},
    Kvp = {"Kvp", "Kvp", "pu/pu", 10.0, 0.0, 200.0, 0.0, "regulator of V, proportional gain"},
    Kvi = {"Kvi", "Kvi", "1/s", 60.0, 0.0, 1000.0, 0.0, "regulator of V, integral gain"},
    Tiq = {"Tiq", "Tiq", "s", 0.02, 0.0, 1.0, kNoNullValue, "lag of Iq (0: none)"},
    dPmax = {"dPmax", "dPmax", "pu/s", 99.0, 0.0, 999.0, kNoNullValue, "fastest rise of Pord"},
    dPmin = {"dPmin", "dPmin", "pu/s", -99.0, -999.0, 0.0, kNoNullValue, "fastest fall of Pord"},
    Pmax = upper_limit({"Pmax", "Pmax", "pu", 1.0, 0.0, 99.0, kNoNullValue, "highest Pord"}),
    Pmin = lower_limit({"Pmin", "Pmin", "pu", 0.0, -99.0, 1.0, kNoNullValue, "lowest Pord"}),
    Imax = upper_limit({"Imax", "Imax", "pu", 1.11, 0.1, 99.0, kNoNullValue, "largest current"}),
    Tpord = {"Tpord", "Tpord", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of Pord (0: none)"},
    Iqfrz = {"Iqfrz", "Iqfrz", "pu", 0.0, -2.0, 2.0, 0.0, "current in place of Iqv for Thld after a dip"},
    Thld = {"Thld", "Thld", "s", 0.0,
            -10.0,  10.0,   0.0, "time after a dip for which Iqfrz (> 0) or Iqv (< 0) is added"},
    Thld2 = {"Thld2", "Thld2", "s", 0.0,
             0.0,     10.0,    0.0, "time after a dip for which the limit of Ipcmd is kept"};

}  // namespace record

// Groups of parameters with the same order in every electrical control, from index `first` on.

/// Parameters of the voltage dip, the measured voltage and the ride-through current Iqv.
template <int first>
struct RideThrough {
  enum { Vdip = first, Vup, Trv, dbd1, dbd2, Kqv, Iqh1, Iql1, Vref0 };
  static constexpr std::array ride_through = {record::Vdip, record::Vup,  record::Trv,
                                              record::dbd1, record::dbd2, record::Kqv,
                                              record::Iqh1, record::Iql1, record::Vref0};
};
/// Parameters of the measured power, and of the limits and regulators of Q and V.
template <int first>
struct Regulators {
  enum { Tp = first, Qmax, Qmin, Vmax, Vmin, Kqp, Kqi, Kvp, Kvi };
  static constexpr std::array regulators = {record::Tp,   record::Qmax, record::Qmin,
                                            record::Vmax, record::Vmin, record::Kqp,
                                            record::Kqi,  record::Kvp,  record::Kvi};
};
/// Parameters of the reactive current's lag, the ordered power and the largest current.
template <int first>
struct Orders {
  enum { Tiq = first, dPmax, dPmin, Pmax, Pmin, Imax, Tpord };
  static constexpr std::array orders = {record::Tiq,  record::dPmax, record::dPmin, record::Pmax,
                                        record::Pmin, record::Imax,  record::Tpord};
};

inline constexpr int kMostPoints = 10;
inline constexpr std::string_view kReactivePoints[] = {"Vq1", "Iq1", "Vq2", "Iq2", "Vq3",  "Iq3", "Vq4",
                                                       "Iq4", "Vq5", "Iq5", "Vq6", "Iq6",  "Vq7", "Iq7",
                                                       "Vq8", "Iq8", "Vq9", "Iq9", "Vq10", "Iq10"},
                                  kActivePoints[] = {"Vp1", "Ip1", "Vp2", "Ip2", "Vp3",  "Ip3", "Vp4",
                                                     "Ip4", "Vp5", "Ip5", "Vp6", "Ip6",  "Vp7", "Ip7",
                                                     "Vp8", "Ip8", "Vp9", "Ip9", "Vp10", "Ip10"};
/// Returns voltages and currents of N points of the limit of Iq, then of the limit of Ip. The defaults are
/// constant limits `most_q` and `most_p` [pu].
template <int N>
constexpr std::array<Parameter, 4 * N> limit_points(double most_q, double most_p) {
  static_assert(N <= kMostPoints);
  std::array<Parameter, 4 * N> all{};
  for (int i = 0; i < 4 * N; ++i) {
    const bool active = i >= 2 * N, voltage = i % 2 == 0;
    const int k = i % (2 * N);
    const auto name = (active ? kActivePoints : kReactivePoints)[k];
    const double current = active ? most_p : most_q;
    Parameter& record = all[static_cast<std::size_t>(i)];
    record = {name, name, "pu", 0.0, voltage ? -1.0 : 0.0, 99.0, kNoNullValue, ""};
    if (k < 4) record.default_value = !voltage ? current : k == 0 ? -1.0 : 2.0;
    if (voltage)
      record.meaning =
          active ? "voltage of a point of the limit of Ip" : "voltage of a point of the limit of Iq";
    else
      record.meaning = active ? "active current at that point" : "reactive current at that point";
  }
  return all;
}
/// Concatenates arrays of parameter definitions.
template <std::size_t... N>
constexpr auto joined(const std::array<Parameter, N>&... parts) {
  std::array<Parameter, (N + ...)> all{};
  std::size_t at = 0;
  const auto add = [&](const auto& part) {
    for (const Parameter& one : part) all[at++] = one;
  };
  (add(parts), ...);
  return all;
}

/// Returns the Model's parameters as values of the common control.
template <class Model, class T>
ElectricalControl::Values<T> electrical_values(const T* p) {
  using M = Model;
  ElectricalControl::Values<T> v;
  v.pf = value_of(p[M::PFFLAG]) > 0.5;
  v.vflag = value_of(p[M::VFLAG]) > 0.5;
  v.qflag = value_of(p[M::QFLAG]) > 0.5;
  v.active_first = value_of(p[M::PQFLAG]) > 0.5;
  v.vdip = p[M::Vdip];
  v.vup = p[M::Vup];
  v.trv = p[M::Trv];
  v.dbd1 = p[M::dbd1];
  v.dbd2 = p[M::dbd2];
  v.kqv = p[M::Kqv];
  v.iqh1 = p[M::Iqh1];
  v.iql1 = p[M::Iql1];
  v.vref0 = p[M::Vref0];
  v.tp = p[M::Tp];
  v.qmax = p[M::Qmax];
  v.qmin = p[M::Qmin];
  v.vmax = p[M::Vmax];
  v.vmin = p[M::Vmin];
  v.kqp = p[M::Kqp];
  v.kqi = p[M::Kqi];
  v.kvp = p[M::Kvp];
  v.kvi = p[M::Kvi];
  v.tiq = p[M::Tiq];
  v.dpmax = p[M::dPmax];
  v.dpmin = p[M::dPmin];
  v.pmax = p[M::Pmax];
  v.pmin = p[M::Pmin];
  v.imax = p[M::Imax];
  v.tpord = p[M::Tpord];
  return v;
}

/// Checks the common parameters.
template <class M>
void check_electrical(const shared::ValueCheck& values) {
  values.require_switches({M::PFFLAG, M::VFLAG, M::QFLAG, M::PQFLAG});
  values.require_times({M::Trv, M::Tp, M::Tiq, M::Tpord});
  values.require_ranges({{M::Vup, M::Vdip},
                         {M::Iqh1, M::Iql1},
                         {M::Qmax, M::Qmin},
                         {M::Vmax, M::Vmin},
                         {M::dPmax, M::dPmin},
                         {M::Pmax, M::Pmin}});
  values.refuse_negative({M::dbd2, M::Kqv, M::Kqp, M::Kqi, M::Kvp, M::Kvi, M::Imax});
  values.refuse_positive({M::dbd1});
}

}  // namespace swingbank::sim::effects::renewable
