#pragma once
// Power source of the exciters ESST4B, ESST3A, EXPIC1 and IEEET3: phasor sum of terminal voltage and current,
// rectified.
#include <fmt/format.h>

#include "base/constants.hpp"
#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

/// Compound source with the output VE FEX(KC Ifd/VE), at most VBMAX, where VE = |KP' V + j (KI + KP' XL) I|
/// and KP' = KP at angle THETAP [deg] (IEEE Std 421.5-2005, 7.3, 7.4 and annex D). It has `size`
/// coefficients.
struct CompoundSource {
  enum { voltage_r, voltage_i, current_r, current_i, commutation, most, size };
  template <class T>
  struct Values {
    T KP, KI, XL, THETAP, KC, VBMAX;
  };
  template <class T>
  static void prepare(const Values<T>& p, T* c) {
    T sine, cosine;
    sincos(p.THETAP * T(constants::degree), sine, cosine);
    c[voltage_r] = p.KP * cosine;
    c[voltage_i] = p.KP * sine;
    c[current_r] = T(0.0) - c[voltage_i] * p.XL;  // real part of j (KI + KP' XL)
    c[current_i] = p.KI + c[voltage_r] * p.XL;
    c[commutation] = p.KC;
    c[most] = p.VBMAX;
  }
  /// Returns the source's rectified voltage VB [pu].
  template <class T>
  static T voltage(const T* c, const Signals<T>& s) {
    using std::sqrt;
    const T re = c[voltage_r] * s.Vr - c[voltage_i] * s.Vi + c[current_r] * s.Ir - c[current_i] * s.Ii;
    const T im = c[voltage_r] * s.Vi + c[voltage_i] * s.Vr + c[current_r] * s.Ii + c[current_i] * s.Ir;
    const T square_2 = re * re + im * im, tiny(1e-12);
    const T VE = sqrt(select(square_2 > tiny, square_2, tiny));
    return clamp(rectified(VE, c[commutation] * s.Ifd), T(0.0), c[most]);
  }
  /// Returns the reason why an exciter cannot operate with VB, or "".
  template <class T>
  static std::string refuses(const T& VB, const Signals<T>& s) {
    if (value_of(VB) > 0.0) return {};
    return fmt::format("the source delivers no voltage (VB = {:.4f} pu) at V = {:.4f} pu, Ifd = {:.4f} pu",
                       value_of(VB), value_of(s.V), value_of(s.Ifd));
  }
};

}  // namespace swingbank::sim::effects::shared
