#pragma once
// WTDTA1: drive train of a wind turbine, one mass or two.

#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::drive_train_wtdta1 {

struct Model {
  static constexpr std::string_view name = "WTDTA1", title = "drive train of a wind turbine, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, WTGT_A; "
                                        "PSS/E WTDTA1",
                                    dyr_name = "WTDTA1";
  static constexpr Slot slot = Slot::drive_train;
  static constexpr std::string_view description = R"(
  2 Ht dwt/dt = Paero/(1 + wt) - T      Ht = Htfrac H, Hg = H - Ht
  2 Hg dwg/dt = T - P/(1 + wg) - DAMP (wg - wg0)
  T = K twist + Dshaft (wt - wg)        d twist/dt = 2 pi f0 (wt - wg)      K: such that the masses swing at Freq1
  Htfrac = 0: one mass. Without WTARA1 the aerodynamic power is constant; without WTTQA1 the initial speed is rated.
)";
  enum P { H, DAMP, Htfrac, Freq1, Dshaft };
  static constexpr Source defaults_from = literature::andes("WTDTA1");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"H", "H", "s", 3.0, 0.1, 20.0, kNoNullValue, "inertia constant of both masses together"},
      {"DAMP", "DAMP", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per speed of the generator"},
      {"Htfrac", "Htfrac", "pu/pu", 0.5, 0.0, 1.0, kNoNullValue,
       "the turbine's part of the inertia (0: one mass)"},
      {"Freq1", "Freq1", "Hz", 1.8, 0.0, 10.0, kNoNullValue, "first torsional frequency",
       literature::psse("WTDTA1, a typical value")},
      {"Dshaft", "Dshaft", "pu", 1.0, 0.0, 20.0, kNoNullValue, "damping of the shaft"}};
  static constexpr int dyr_columns[] = {H, DAMP, Htfrac, Freq1, Dshaft};
  enum C { two, iTt, iTg, damp, stiff, dshaft, w0, base, coefficients };
  enum X { wt, wg, twist };
  static constexpr State states[] = {{"wt", "pu", "speed of the turbine, minus 1"},
                                     {"wg", "pu", "speed of the generator, minus 1"},
                                     {"twist", "rad", "twist of the shaft"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_positive({H}, "a shaft has inertia");
    values.refuse(!(p[Htfrac] >= 0 && p[Htfrac] < 1), Htfrac, "the generator needs a part of the inertia",
                  "give 0 for one mass, or a part below 1");
    values.refuse(p[Htfrac] > 0 && !(p[Freq1] > 0), Freq1, "the shaft between the masses needs a stiffness",
                  "give Freq1 > 0, or Htfrac = 0 for one mass");
    values.refuse_negative({DAMP, Dshaft});
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T zero(0.0), one(1.0), Ht = p[Htfrac] * p[H], Hg = p[H] - Ht;
    const auto several = p[Htfrac] > zero;
    c[two] = select(several, one, zero);
    c[iTt] = select(several, T(0.5) / select(several, Ht, one), zero);
    c[iTg] = T(0.5) / Hg;
    c[damp] = p[DAMP];
    c[dshaft] = p[Dshaft];
    c[base] = T(constants::turn * conventions.frequency);
    c[stiff] = T(2.0) * Ht * Hg / p[H] * square(T(constants::turn) * p[Freq1]) / c[base];
  }
  template <class T>
  static void publish(const T*, const T* x, Signals<T>& s) {
    s.wt = x[wt];
    s.wg = x[wg];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), wind = s.Paero / (one + x[wt]), load = s.P / (one + x[wg]) + c[damp] * (x[wg] - c[w0]);
    const T shaft = c[stiff] * x[twist] + c[dshaft] * (x[wt] - x[wg]);
    const auto several = c[two] > T(0.5);
    dx[wg] = (select(several, shaft, wind) - load) * c[iTg];
    dx[wt] = select(several, (wind - shaft) * c[iTt], dx[wg]);
    dx[twist] = c[base] * (x[wt] - x[wg]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T one(1.0), zero(0.0);
    x[wt] = x[wg] = c[w0] = s.wg;
    const auto several = c[two] > T(0.5);
    x[twist] = select(several, s.P / (one + s.wg) / select(several, c[stiff], one), zero);
    return {};
  }
};

}  // namespace swingbank::sim::effects::drive_train_wtdta1
