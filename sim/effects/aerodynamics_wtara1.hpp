#pragma once
// WTARA1: aerodynamics of a wind turbine, quadratic in the pitch angle.

#include "sim/core/effect.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::aerodynamics_wtara1 {

struct Model {
  static constexpr std::string_view name = "WTARA1", title = "aerodynamics of a wind turbine, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, WTGAR_A; "
                                        "PSS/E WTARA1",
                                    dyr_name = "WTARA1";
  static constexpr Slot slot = Slot::aerodynamics;
  static constexpr std::string_view description = R"(
  Paero = P0 - Ka pitch (pitch - Theta0)       pitch [degrees]; P0, Theta0: at the operating point
)";
  enum P { Ka, Theta0 };
  static constexpr Source defaults_from = literature::andes("WTARA1, but 0.007 for its gain");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"Ka", "Ka", "pu/deg^2", 0.007, 0.0, 1.0, 0.0, "reduction of the aerodynamic power by the pitch angle"},
      {"Theta0", "Theta0", "deg", 0.0, -5.0, 30.0, kNoNullValue, "initial pitch angle"}};
  static constexpr int dyr_columns[] = {Ka, Theta0};
  enum C { ka, theta0, p0, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse_negative({Ka});
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[ka] = p[Ka];
    c[theta0] = p[Theta0];
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    s.Paero = c[p0] - c[ka] * (c[theta0] + s.pitch) * s.pitch;
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T*) {
    c[p0] = s.P;
    s.pitch = c[theta0];
    return {};
  }
};

}  // namespace swingbank::sim::effects::aerodynamics_wtara1
