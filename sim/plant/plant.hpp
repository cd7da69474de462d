#pragma once
// One plant: its blocks and its operating point.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::plant {

/// An effect with its parameter values, in the order of effect->parameters.
struct Block {
  const Effect* effect = nullptr;  ///< effect; null: none
  std::vector<double> p;           ///< parameter values, in the units of the effect's records
};
/// Remote measuring point of a plant control in the network, given by the parameters in Effect::elsewhere.
struct FarPlace {
  int bus = -1;         ///< index of the regulated bus; -1: the plant's grid side
  int branch = -1;      ///< index of the measured branch; -1: the plant's own power and current
  bool at_from = true;  ///< true: measured at the `from` side of this branch
};
/// Two-port between the plant's grid side and the point where its control measures. Voltage and current at
/// that point are a V + b I and c V + d I [pu on the machine's base].
struct TwoPort {
  Complex a = 1.0, b = 0.0, c = 0.0, d = 1.0;  ///< chain parameters [pu]
};
/// One generating plant: machine, transformer, controls, measurements.
struct Plant {
  std::string name;                 ///< "30" or "30/2": bus number, and id where a bus has several machines
  int bus = -1;                     ///< index into Network::buses
  double mva = 100.0;               ///< machine base [MVA]
  Complex generation;               ///< P + jQ at the operating point [pu on the network's base]
  Block machine;                    ///< synchronous machine or converter
  Block transformer;                ///< none: effect == nullptr; the bus is then the machine's terminal
  std::vector<Block> controls;      ///< in order of Slot
  std::vector<Block> measurements;  ///< instruments between grid and record
  int generator = -1;               ///< index into Network::generators
  FarPlace far_place;               ///< remote measuring point of its plant control
  std::optional<TwoPort> beyond;    ///< network up to the measuring point; none: measured at the grid side
  /// The remote measurement at the operating point [pu; power and current on `mva`]. Empty if the control
  /// measures at the plant.
  std::optional<Far<double>> far;
};
/// A load with a dynamic model. Every other load is a constant impedance.
struct Consumer {
  std::string name;     ///< "8" or "8/2": bus number, and id where a bus has several loads
  int bus = -1;         ///< index into Network::buses
  int load = -1;        ///< index into Network::loads
  int regulated = -1;   ///< index of the bus whose voltage it regulates; -1: its own bus, or none
  double mva = 100.0;   ///< base of its parameters [MVA]
  Complex consumption;  ///< P + jQ at the operating point [pu on the network's base]
  Block block;          ///< effect and parameters of the load
};

/// Sorts the plant's controls by slot, the order of their evaluation.
void sort_controls(Plant& plant);
/// Returns the switching times of the plant's effects, sorted [s].
std::vector<double> switching_times_of(const Plant& plant);
/// Margin before a segment's end [s]. Effects are evaluated no later than this margin before the end, so that
/// a step at the end belongs to the next segment.
constexpr double kBeforeSwitching = 1e-9;

/// Initial state of a plant at its operating point. T: double, or a dual where derivatives are needed.
template <class T>
struct OperatingOf {
  std::vector<T> c;  ///< coefficients: machine, Joint (equations.hpp), controls
  std::vector<T> x;  ///< states: machine, controls
  T Efd, Tm;         ///< [pu]; each is constant if the slot of exciter or governor is empty
  Signals<T> s;      ///< every signal at the operating point
};
/// Operating point in double precision.
using Operating = OperatingOf<double>;

/// Initialises one plant exactly, including saturation, from the voltage at its bus [pu] and its generation
/// [pu on base_mva]. The machine is first, then the controls in order of Slot (of a converter: in reverse).
/// Throws InputError if an effect has no steady state, a state is outside its limits, the controls' Efd or Tm
/// differs from the machine's, or a derivative exceeds 1e-9.
Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions);
/// As operating_point(), with the values of every block given as T, in the order of block_parameters().
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, double base_mva, const Conventions& conventions);
/// As operating_point_of(), with the generation P, Q given as T [pu on the machine's base]; plant.generation
/// is not read.
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, const T& P, const T& Q, const Conventions& conventions);

}  // namespace swingbank::sim::plant
