#pragma once
// Common part of the controlled-current sources REGCA1, REGCB1, REGCC1, CSVGN1 and DERA1: reactance in the
// network equations, zero internal voltage, frequency of the terminal. A Model has the coefficients iTfreq
// and per_angle and the states Vrlag and Vilag.
#include <cmath>

#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct ControlledCurrent {
  static constexpr Slot slot = Slot::machine;
  static constexpr bool converter = true;
  static constexpr Parameter kTfreq = {"Tfreq",
                                       "Tfreq",
                                       "s",
                                       0.02,
                                       1e-3,
                                       1.0,
                                       kNoNullValue,
                                       "lag of the frequency measurement",
                                       literature::own("about a cycle")};
  static constexpr State kVrlag = {"Vrlag", "pu", "lagged voltage, real part", 0.1},
                         kVilag = {"Vilag", "pu", "lagged voltage, imaginary part", 0.1};
  /// Reactance of the source in the network equations [pu]. Any value gives exact results (decision 37); a
  /// large one gives fast convergence of the network iteration.
  static constexpr double kReactance = 10.0;
  static constexpr double kNoFrequency =
      1e-3;  ///< voltage below which the measured frequency fades to f0 [pu]

  template <class T>
  static void source_impedance(const T*, T& r, T& x) {
    r = T(0.0);
    x = T(kReactance);
  }
  /// Sets the internal voltage to zero, which is also the terminal voltage of a disconnected source.
  template <class T>
  static void emf(const T*, const T*, T*, T& er, T& ei) {
    er = ei = T(0.0);
  }

 protected:
  template <class T>
  static void prepare_frequency(const T& time_constant, const Conventions& conventions, T* c) {
    c[Model::iTfreq] = T(1.0) / time_constant;
    c[Model::per_angle] = frequency_per_angle(c[Model::iTfreq], conventions.frequency);
  }
  /// Sets the signals of a current source without a turbine. `squared`: |V|^2 [pu].
  template <class T>
  static void terminal(const T* c, const T* x, const T& squared, Signals<T>& s) {
    const T least(kNoFrequency * kNoFrequency);  // at a bolted fault V is rounding error only
    s.speed = bus_frequency(s.Vr, s.Vi, select(squared > least, squared, least), x[Model::Vrlag],
                            x[Model::Vilag], c[Model::per_angle]);
    s.Te = s.Vr * s.Ir + s.Vi * s.Ii;
    s.Ifd = s.Pext = s.Qext = s.wt = s.wg = s.wref = s.pitch = s.Paero = T(0.0);
    s.Pord = s.Te;
  }
  template <class T>
  static void follow_voltage(const T* c, const T* x, const Signals<T>& s, T* dx) {
    dx[Model::Vrlag] = (s.Vr - x[Model::Vrlag]) * c[Model::iTfreq];
    dx[Model::Vilag] = (s.Vi - x[Model::Vilag]) * c[Model::iTfreq];
  }
  template <class T>
  static void steady_voltage(const Signals<T>& s, T* x) {
    x[Model::Vrlag] = s.Vr;
    x[Model::Vilag] = s.Vi;
  }
};

}  // namespace swingbank::sim::effects::shared
