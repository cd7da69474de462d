#pragma once
// Phasors as input of measurement effects.
#include <gtest/gtest.h>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::test {

constexpr double kPi = 3.14159265358979323846;

/// Smooth swing of a few Hz at a plant's terminal, `seconds` long; the frequency is consistent with V's
/// angle.
inline Phasors swing(double rate, double seconds = 4.0) {
  Phasors p{rate, 60.0, {}, {}, {}};
  for (int k = 0; k <= static_cast<int>(seconds * rate); ++k) {
    const double t = k / rate, w = 2 * kPi;
    p.V.push_back(std::polar(1.02 + 0.03 * std::sin(w * 0.9 * t), 0.2 + 0.3 * std::sin(w * 1.1 * t)));
    p.I.push_back(std::polar(0.8 + 0.2 * std::sin(w * 1.3 * t), -0.1 + 0.4 * std::sin(w * 0.7 * t + 1.0)));
    p.df.push_back(0.3 * w * 1.1 * std::cos(w * 1.1 * t) / (w * 60.0));
  }
  return p;
}

inline const Effect& effect(const char* name) { return *library::compiled().find(name); }

/// Output of the instrument with these parameters.
inline Phasors measured(const Effect& e, const std::vector<double>& p, Phasors phasors,
                        std::uint64_t seed = 1) {
  e.measure(p.data(), seed, phasors);
  return phasors;
}
inline Phasors measured(const char* name, const std::vector<double>& p, const Phasors& phasors,
                        std::uint64_t seed = 1) {
  return measured(effect(name), p, phasors, seed);
}

}  // namespace swingbank::sim::test
