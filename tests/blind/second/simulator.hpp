#pragma once
// One machine against a Thevenin grid whose source and impedance are switched, integrated by the classical
// Runge-Kutta method with a fixed step. Nothing of the product's simulator is used here.
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "tests/blind/second/controls.hpp"
#include "tests/blind/second/machine.hpp"

namespace swingbank::blind_second {

/// The grid as the plant sees it from `start` on [s]: a source behind an impedance [pu on the machine's
/// base].
struct Stretch {
  double start = 0;
  Phasor source, impedance;
};
/// The source's frequency falls from `start` on towards nominal + depth [pu], with time constant tau [s].
struct FrequencyDip {
  double start = 1e9, depth = 0, tau = 3;
};

/// A drive that no list knows; `memory` are two states of its own, at 0 before the event. `within` lies on
/// the same side of every jump as the step that is made.
struct UnlistedDrive {
  using Memory = std::array<double, 2>;
  /// What is added to the mechanical power [pu].
  std::function<double(double t, double within, double w, const Memory&)> torque;
  /// What becomes of Efd.
  std::function<double(double within, double Efd, const Memory&)> field;
  /// Rates of the memory, by the deviation of the voltage from the one before the event.
  std::function<Memory(double dV, const Memory&)> rates;
  std::vector<double> instants;  ///< when it jumps [s]
};

struct Setup {
  MachineData machine;
  double hz = 60;
  double P = 0.7, Q = 0.1, V = 1.02;  ///< at the grid's side, before the event [pu]
  std::optional<Sexs> exciter;
  std::optional<Tgov1> governor;
  std::optional<Ieeest> stabiliser;
  Phasor transformer{};   ///< impedance of a step-up transformer of ratio 1 [pu on the machine's base]
  Phasor ct_error{1, 0};  ///< what the current transformers make of a current of 1
  UnlistedDrive unlisted;
  std::vector<Stretch> grid;  ///< the first one starts at 0; its source is set so that it holds P, Q, V
  FrequencyDip dip;
};

/// Samples at k/rate; at the grid's side, per unit on the machine's base.
struct Output {
  std::vector<double> t, V, theta, P, Q, w, Ifd, Efd, Pm;
};

/// `step` [s] must divide 1/rate.
Output simulate(const Setup& setup, double seconds, double rate = 60, double step = 1.0 / 2400);

/// The source that holds P, Q, V behind `impedance`, V having angle 0.
Phasor holding_source(const Setup& setup, Phasor impedance);

}  // namespace swingbank::blind_second
