#pragma once
// WSIEG1: IEEEG1 with a valve curve, a backlash and limits set at the operating point.
#include "sim/effects/detail/gate_power.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"
#include "sim/effects/governor_ieeeg1.hpp"

namespace swingbank::sim::effects::governor_wsieg1 {

struct Model {
  using B = governor_ieeeg1::Model;
  using Curve = shared::GatePower<5>;
  static constexpr std::string_view
      name = "WSIEG1",
      title = "steam turbine with reheat stages and governor (WECC)",
      source = "PSS/E WSIEG1; IEEE PES-TR1 (2013), 2.3; backlash and limits: OpenIPSL, WSIEG1",
      dyr_name = "WSIEG1";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "IEEEG1";
  static constexpr std::string_view description = R"(
                                                           UO       PMAX
  b(w) --> [ K (1 + s T2)/(1 + s T1) ] --(-)--> (+) --> [ 1/T3 ]--> [ 1/s ] --valve--> [ backlash ] --gate
                            Pref + dPref --(+)   -gate     UC       PMIN
  gate --> [ NGV ] --> [ 1/(1 + s T4) ] --x4--> [ 1/(1 + s T5) ] --x5--> [ 1/(1 + s T6) ] --x6--> [ 1/(1 + s T7) ] --x7
  Pm = K1 x4 + K3 x5 + K5 x6 + K7 x7
  b(w): 0 within +-db1, beyond it w minus the nearer edge (err = 0 or db1: no step at the edge)
  backlash: the gate follows the valve at the distance db2 (0: none), with a lag of 20 ms for the integration
  NGV: linear between (GV1, PGV1) and (GV5, PGV5), up to the last ascending point; no points: PGV = gate
  IBLOCK: the operating point replaces PMIN = 0 (1), PMAX = 0 (2) or both (3)
  One shaft only: JBUS, M and the shares K2, K4, K6, K8 of a second generator are zero.
)";
  /// The parameters of IEEEG1 with its dead-band, then these.
  enum P {
    ERR = B::db + 1,
    DB2,
    GV1,
    PGV1,
    GV2,
    PGV2,
    GV3,
    PGV3,
    GV4,
    PGV4,
    GV5,
    PGV5,
    IBLOCK,
    parameter_count
  };
  static constexpr int kGates[] = {GV1, GV2, GV3, GV4, GV5}, kPowers[] = {PGV1, PGV2, PGV3, PGV4, PGV5};
  static constexpr Source defaults_from = B::defaults_from;
  static constexpr Source bounds_from = B::bounds_from;
  static constexpr Source kOpening = literature::own("five times the rated opening");
  static constexpr auto parameters = [] {
    std::array<Parameter, parameter_count> all{};
    for (int i = 0; i < B::db; ++i) all[static_cast<std::size_t>(i)] = B::parameters[i];
    all[B::db] = B::parameters[B::db];
    all[B::db].name = all[B::db].symbol = "db1";
    all[ERR] = {"err",
                "err",
                "pu",
                0.0,
                0.0,
                0.02,
                0.0,
                "step at the dead-band's edge (0 or db1: none)",
                shared::kNothing,
                shared::kDeadBand};
    all[DB2] = {"db2",
                "db2",
                "pu",
                0.0,
                0.0,
                0.1,
                0.0,
                "half width of the valve's backlash",
                shared::kNothing,
                literature::own("a tenth of the stroke")};
    constexpr std::string_view names[] = {"GV1",  "PGV1", "GV2",  "PGV2", "GV3",
                                          "PGV3", "GV4",  "PGV4", "GV5",  "PGV5"};
    for (int i = GV1; i <= PGV5; ++i)
      all[static_cast<std::size_t>(i)] = {
          names[i - GV1],
          names[i - GV1],
          "pu",
          0.0,
          0.0,
          99.0,
          kNoNullValue,
          (i - GV1) % 2 == 0 ? "opening of the valve (0: point not used)" : "power at that point",
          shared::kNothing,
          literature::own("99 marks a point that is never reached")};
    all[IBLOCK] = {"IBLOCK",
                   "IBLOCK",
                   "code",
                   0.0,
                   0.0,
                   3.0,
                   0.0,
                   "blocked at the operating point: 1 closing, 2 opening, 3 both",
                   shared::kNothing,
                   shared::kCode};
    return all;
  }();
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  enum C { play = B::coefficients, follow, curve, coefficients = curve + Curve::size };
  enum X { gate = B::last + 1 };
  static constexpr auto states = [] {
    std::array<State, gate + 1> all{};
    for (int i = 0; i < gate; ++i) all[static_cast<std::size_t>(i)] = B::states[i];
    all[gate] = {.name = "gate",
                 .unit = "pu",
                 .meaning = "valve behind its backlash",
                 .moved_by = {follow},
                 .bends = true};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    std::array<double, parameter_count> q;
    std::copy(p, p + parameter_count, q.begin());
    if (p[IBLOCK] >= 2 && p[B::PMAX] == 0.0) q[B::PMAX] = p[B::PMIN] + 1.0;  // set at the operating point
    B::check_valve({name, parameters, q.data(), where, problems}, q.data());
    B::check_shares(values, p[B::K1] + p[B::K3] + p[B::K5] + p[B::K7],
                    values.text(B::K1, B::K3, B::K5, B::K7));
    values.refuse(p[ERR] != 0.0 && p[ERR] != p[B::db], values.text(ERR, B::db), shared::kDeadBandStep,
                  "give err = 0 or err = db1");
    values.refuse_negative({DB2}, "a width cannot be negative");
    values.refuse(p[IBLOCK] != 0 && p[IBLOCK] != 1 && p[IBLOCK] != 2 && p[IBLOCK] != 3, IBLOCK,
                  "it is a code", "give 0, 1, 2 or 3");
    Curve::check(values, p, kGates, kPowers);
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(p, conventions, c);
    c[play] = p[DB2];
    c[follow] = select(p[DB2] > T(0.0), T(shared::kFollowRate), T(0.0));
    Curve::prepare(p, kGates, kPowers, c + curve);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T opening = clamp(x[B::valve], c[B::low], c[B::high]);
    dx[gate] = c[follow] * dead_band(opening - x[gate], c[play]);
    const T position = select(c[follow] > T(0.0), x[gate], opening);
    B::move_valve(c, x, position, s, dx);
    s.Tm = B::stages(c, x, Curve::value(c + curve, position), dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = B::steady(p, c, s, x);
    if (!why.empty()) return why;
    const T opening = Curve::opening(c + curve, c[B::Pref]), zero(0.0);
    c[B::Pref] = x[B::valve] = x[gate] = opening;
    const double code = value_of(p[IBLOCK]);
    if (code == 1.0 || code == 3.0) c[B::low] = select(p[B::PMIN] * p[B::PMIN] > zero, p[B::PMIN], opening);
    if (code == 2.0 || code == 3.0) c[B::high] = select(p[B::PMAX] * p[B::PMAX] > zero, p[B::PMAX], opening);
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_wsieg1
