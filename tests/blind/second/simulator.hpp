#pragma once
// One machine against a Thevenin grid with switched source and impedance, integrated by the classical
// Runge-Kutta method with a fixed step. Independent of the product's simulator.
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "tests/blind/second/controls.hpp"
#include "tests/blind/second/machine.hpp"

namespace swingbank::blind_second {

/// Thevenin equivalent from `start` on [s]: a source behind an impedance [pu on the machine's base].
struct Stretch {
  double start = 0;
  Phasor source, impedance;
};
/// From `start` on, the source's frequency falls towards nominal + depth [pu] with time constant tau [s].
struct FrequencyDip {
  double start = 1e9, depth = 0, tau = 3;
};

/// An unlisted disturbance. `Memory`: its two states, 0 before the event. `within`: a time inside the current
/// integration step, which shows on which side of an input's step t lies.
struct UnlistedDisturbance {
  using Memory = std::array<double, 2>;
  /// Addition to the mechanical power [pu].
  std::function<double(double t, double within, double w, const Memory&)> torque;
  /// Modified Efd [pu].
  std::function<double(double within, double Efd, const Memory&)> field;
  /// Derivatives of the memory; dV is the deviation of the voltage from its pre-event value.
  std::function<Memory(double dV, const Memory&)> rates;
  std::vector<double> step_times;  ///< times of its steps [s]
};

struct Setup {
  MachineData machine;
  double hz = 60;
  double P = 0.7, Q = 0.1, V = 1.02;  ///< at the grid's side, before the event [pu]
  std::optional<Sexs> exciter;
  std::optional<Tgov1> governor;
  std::optional<Ieeest> stabiliser;
  Phasor transformer{};   ///< impedance of a step-up transformer of ratio 1 [pu on the machine's base]
  Phasor ct_error{1, 0};  ///< output of the current transformers at an input of 1
  UnlistedDisturbance unlisted;
  std::vector<Stretch> grid;  ///< the first starts at 0; its source is set to give P, Q, V
  FrequencyDip dip;
};

/// Samples at k/rate on the grid's side, per unit on the machine's base.
struct Output {
  std::vector<double> t, V, theta, P, Q, w, Ifd, Efd, Pm;
};

/// Simulates `seconds` [s]. `step` [s] must divide 1/rate.
Output simulate(const Setup& setup, double seconds, double rate = 60, double step = 1.0 / 2400);

/// Returns the source voltage that gives P, Q, V behind `impedance`; V has angle 0.
Phasor source_voltage(const Setup& setup, Phasor impedance);

}  // namespace swingbank::blind_second
