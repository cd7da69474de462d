#pragma once
// WTPTA1: pitch control of a wind turbine.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::pitch_control_wtpta1 {

struct Model {
  static constexpr std::string_view name = "WTPTA1", title = "pitch control of a wind turbine, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, WTGPT_A; "
                                        "PSS/E WTPTA1",
                                    dyr_name = "WTPTA1";
  static constexpr Slot slot = Slot::pitch_control;
  static constexpr std::string_view description = R"(
  wt - wref + Kcc (Pord - Pext) --> [ Kpw + Kiw/s, TetaMin to TetaMax ] --+
  Pord - Pext --------------------> [ Kpc + Kic/s, TetaMin to TetaMax ] --+--> [ 1/(1 + s Tpi), rate RTetaMin to
      RTetaMax, TetaMin to TetaMax ] --> pitch
  Both integrals stay within the limits; the second one starts at 0 or at the limit nearest to 0.
)";
  enum P { Kiw, Kpw, Kic, Kpc, Kcc, Tpi, TetaMax, TetaMin, RTetaMax, RTetaMin };
  static constexpr Source defaults_from = literature::andes("WTPTA1");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"Kiw", "Kiw", "deg/s/pu", 0.1, 0.0, 999.0, 0.0, "speed control, integral gain"},
      {"Kpw", "Kpw", "deg/pu", 0.0, 0.0, 999.0, 0.0, "speed control, proportional gain"},
      {"Kic", "Kic", "deg/s/pu", 0.1, 0.0, 999.0, 0.0, "power control, integral gain"},
      {"Kpc", "Kpc", "deg/pu", 0.0, 0.0, 999.0, 0.0, "power control, proportional gain"},
      {"Kcc", "Kcc", "pu/pu", 0.0, 0.0, 100.0, 0.0, "gain from power error to speed error"},
      {"Tpi", "Tpi", "s", 0.3, 0.0, 5.0, kNoNullValue, "time constant of the blades (0: none)"},
      upper_limit({"TetaMax", "TetaMax", "deg", 30.0, 0.0, 99.0, kNoNullValue, "largest angle"}),
      lower_limit({"TetaMin", "TetaMin", "deg", 0.0, 0.0, 30.0, kNoNullValue, "smallest angle"}),
      {"RTetaMax", "RTetaMax", "deg/s", 5.0, 0.0, 99.0, kNoNullValue, "fastest rise"},
      {"RTetaMin", "RTetaMin", "deg/s", -5.0, -99.0, 0.0, kNoNullValue, "fastest fall"}};
  static constexpr int dyr_columns[] = {Kiw, Kpw, Kic, Kpc, Kcc, Tpi, TetaMax, TetaMin, RTetaMax, RTetaMin};
  enum C { kiw, kpw, kic, kpc, kcc, iTpi, most, least, rise, fall, pord0, start, coefficients };
  enum X { by_speed, by_power, angle };
  static constexpr State states[] = {
      {.name = "by_speed", .unit = "deg", .meaning = "integral of the speed control", .bends = true},
      {.name = "by_power", .unit = "deg", .meaning = "integral of the power control", .bends = true},
      {"angle", "deg", "angle of the blades", 1.0, least, most}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_times({Tpi});
    values.require_ranges({{TetaMax, TetaMin}});
    values.refuse_negative({Kiw, Kpw, Kic, Kpc, Kcc, RTetaMax});
    values.refuse_positive({RTetaMin});
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{kiw, Kiw},
                                   {kpw, Kpw},
                                   {kic, Kic},
                                   {kpc, Kpc},
                                   {kcc, Kcc},
                                   {most, TetaMax},
                                   {least, TetaMin},
                                   {rise, RTetaMax},
                                   {fall, RTetaMin}})
      c[to] = p[from];
    c[iTpi] = inverse(p[Tpi]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), excess = s.Pord - c[pord0] - s.Pext, fast = s.wt - s.wref + c[kcc] * excess;
    const T both =
        renewable::regulator(c[kpw], c[kiw], fast, c[least], c[most], one, x[by_speed], dx[by_speed]) +
        renewable::regulator(c[kpc], c[kic], excess, c[least], c[most], one, x[by_power], dx[by_power]);
    dx[angle] = clamp((both - x[angle]) * c[iTpi], c[fall], c[rise]);
    s.pitch = clamp(select(c[iTpi] > T(0.0), x[angle], both), c[least], c[most]) - c[start];
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    c[start] = x[angle] = s.pitch;
    x[by_power] = clamp(T(0.0), c[least], c[most]);
    x[by_speed] = s.pitch - x[by_power];
    c[pord0] = s.Pord;
    const double turned = value_of(x[by_speed]);
    if (turned < value_of(c[least]) || turned > value_of(c[most]))
      return fmt::format(
          "an initial pitch of {:.4g} degrees needs an integral of the speed control "
          "outside TetaMin = {:g} to TetaMax = {:g} degrees",
          value_of(s.pitch), value_of(c[least]), value_of(c[most]));
    return {};
  }
};

}  // namespace swingbank::sim::effects::pitch_control_wtpta1
