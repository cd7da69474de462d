#pragma once
// A single converter behind an impedance: its steady state at 1 pu, its current and derivatives at a voltage.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim {

using Changes = std::vector<std::pair<const char*, double>>;

struct BehindImpedance {
  BehindImpedance(const char* name, const Changes& changes, std::complex<double> power = {0.6, 0.2})
      : effect(*library::compiled().find(name)), ops(effect.get<double>()) {
    p = effect.default_parameters();
    for (const auto& [parameter, value] : changes)
      p.at(static_cast<std::size_t>(effect.parameter_index(parameter))) = value;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    m.resize(static_cast<std::size_t>(effect.scratch));
    effect.check(nullptr, p.data(), "test", problems);
    s.Vr = 1.0, s.Vi = 0.0, s.Ir = power.real(), s.Ii = -power.imag();
    ops.prepare(p.data(), Conventions::psse(), c.data());
    refused = ops.machine.steady(p.data(), c.data(), s, x.data());
  }
  /// Components of the current: in phase with `axis`, and lagging it by 90 degrees.
  std::complex<double> current(std::complex<double> v, std::complex<double> axis) {
    s.Vr = v.real(), s.Vi = v.imag();
    ops.machine.current(c.data(), x.data(), m.data(), s);
    return std::conj(std::complex<double>(s.Ir, s.Ii) * std::conj(axis) / std::abs(axis));
  }
  std::vector<double> derivatives(std::complex<double> v) {
    std::vector<double> dx(x.size());
    current(v, 1.0);
    ops.machine.electrical(c.data(), x.data(), m.data(), s);
    ops.machine.derivative(c.data(), x.data(), m.data(), s, dx.data());
    return dx;
  }
  const Effect& effect;
  const Ops<double>& ops;
  std::vector<double> p, c, x, m;
  Signals<double> s;
  Problems problems;
  std::string refused;
};

inline void expect_near(std::complex<double> is, std::complex<double> should, double within) {
  EXPECT_NEAR(std::abs(is - should), 0.0, within) << is << " for " << should;
}

}  // namespace swingbank::sim
