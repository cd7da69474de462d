#pragma once
// Lead-lag with non-windup limits of its output (IEEE Std 421.5-2005, annex E): while the output is at a
// limit, the state approaches the limit with the lead's time constant.
#include "sim/core/blocks.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

/// (1 + s TC)/(1 + s TB) between limits, with `size` coefficients; TB = 0 passes the limited input.
struct LimitedLeadLag {
  enum { share, iTC, iTB, size };
  template <class T>
  static void prepare(const T& TC, const T& TB, T* c) {
    c[iTB] = inverse(TB);
    c[iTC] = inverse(TC);
    c[share] = TC * c[iTB];
  }
  template <class T>
  static T evaluate(const T* c, const T& x, const T& u, const T& low, const T& high, T& dx) {
    const T zero(0.0);
    const auto lagged = c[iTB] > zero, leads = c[iTC] > zero;
    const T free = select(lagged, x + c[share] * (u - x), u);
    const T y = clamp(free, low, high);
    // Within the limits y - x = (TC/TB) (u - x), so that both forms of the derivative agree.
    const T derivative = select(leads, (y - x) * c[iTC], (clamp(u, low, high) - x) * c[iTB]);
    dx = select(lagged, derivative, zero);
    return y;
  }
};

}  // namespace swingbank::sim::effects::shared
