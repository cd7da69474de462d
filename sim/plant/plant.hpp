#pragma once
// One plant by itself: its blocks, and the operating point they are brought to.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::plant {

/// An effect with its parameter values, in the order of effect->parameters.
struct Block {
  const Effect* effect = nullptr;
  std::vector<double> p;
};
/// Where a plant's control measures (Elsewhere of its effect), in the network.
struct FarPlace {
  int bus = -1;         ///< index of the bus whose voltage it regulates; -1: the plant's grid side
  int branch = -1;      ///< index of the branch whose flow counts; -1: the plant's own
  bool at_from = true;  ///< measured at this branch's `from` side
};
/// What lies between the plant's grid side and the point where its control measures: voltage and current
/// there are a V + b I and c V + d I [pu on the machine's base].
struct TwoPort {
  Complex a = 1.0, b = 0.0, c = 0.0, d = 1.0;
};
/// One generator: the machine and what stands around it.
struct Plant {
  std::string name;    ///< "30" or "30/2": bus number, and id where a bus has several machines
  int bus = -1;        ///< index into Network::buses
  double mva = 100.0;  ///< machine base
  Complex generation;  ///< P + jQ at the operating point [pu on the network's base]
  Block machine;
  Block transformer;            ///< none: effect == nullptr; the bus is then the machine's terminal
  std::vector<Block> controls;  ///< in order of Slot
  std::vector<Block> measurements;
  int generator = -1;  ///< index into Network::generators
  FarPlace far_place;
  std::optional<TwoPort> beyond;  ///< none: the control's point is the grid side
  /// What its control measures there at the operating point [pu; power and current on `mva`]; where neither
  /// bus nor branch is another's, nothing.
  std::optional<Far<double>> far;
};
/// A load with a model of its own; every other load is a constant impedance.
struct Consumer {
  std::string name;     ///< "8" or "8/2": bus number, and id where a bus has several loads
  int bus = -1;         ///< index into Network::buses
  int load = -1;        ///< index into Network::loads
  int regulated = -1;   ///< index of the bus whose voltage it regulates; -1: its own, or none
  double mva = 100.0;   ///< base of its parameters
  Complex consumption;  ///< P + jQ at the operating point [pu on the network's base]
  Block block;
};

/// When the plant's effects jump in time, sorted [s].
std::vector<double> instants_of(const Plant& plant);
/// Effects see at most the end of their segment less this, so that a jump at its end stays in the next [s].
constexpr double kBeforeSwitching = 1e-9;

/// A plant brought to its operating point. T: double, or a dual where derivatives are wanted.
template <class T>
struct OperatingOf {
  std::vector<T> c;  ///< coefficients: machine, Joint (equations.hpp), controls
  std::vector<T> x;  ///< states: machine, controls
  T Efd, Tm;         ///< held where exciter or governor slot is empty
  Signals<T> s;      ///< every signal at the operating point
};
using Operating = OperatingOf<double>;

/// Back-initialises one plant exactly (saturation included) from the voltage at its bus [pu] and generation
/// [pu on base_mva]: machine first, then controls in order of Slot. Every derivative is evaluated there;
/// throws InputError where an effect cannot hold the point, a state lies outside its limits or a derivative
/// exceeds 1e-9.
Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions);
/// The same with the values of every block given as T, in the order of block_parameters().
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, double base_mva, const Conventions& conventions);
/// The same with the generation P, Q given as T [pu on the machine's base]; plant.generation is not read.
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, const T& P, const T& Q, const Conventions& conventions);

}  // namespace swingbank::sim::plant
