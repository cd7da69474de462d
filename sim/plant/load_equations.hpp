#pragma once
// Equations of one load: its current is a function of the bus voltage and its states. Solvers that need
// sources behind constant impedances represent the load by E = V + z I, where z is its impedance at the
// operating point. A constant-impedance load has E = 0.
#include <optional>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Coefficients that follow those of the load's effect: impedance at the operating point [pu on
/// Consumer::mva].
enum LoadJoint { load_r, load_x, kLoadJoint };

/// Equations of one dynamic load.
template <class T>
class LoadEquations {
 public:
  /// Collects the equations of the load's effect.
  explicit LoadEquations(const Consumer& load)
      : ops_(load.block.effect->get<T>().load),
        joint_(load.block.effect->coefficients),
        states_(static_cast<int>(load.block.effect->states.size())) {}
  /// Returns the number of states.
  [[nodiscard]] int states() const { return states_; }
  /// Returns the number of coefficients.
  [[nodiscard]] int coefficients() const { return joint_ + kLoadJoint; }
  /// Returns the impedance at the operating point: r, then x [pu on Consumer::mva].
  [[nodiscard]] const T* impedance(const T* c) const { return c + joint_; }
  /// Computes the current Ir, Ii into the bus from Vr, Vi.
  void current(const T* c, const T* x, Signals<T>& s) const { ops_.current(c, x, s); }
  /// Computes the derivatives, after current(). Vpr, Vpi: voltage of the regulated bus.
  void derivative(const T* c, const T* x, const Signals<T>& s, T* dx) const { ops_.derivative(c, x, s, dx); }

 private:
  LoadOps<T> ops_;
  int joint_, states_;
};

/// Initialises a load at the voltage of its bus and at the voltage of its regulated bus [pu], if it regulates
/// another bus. Throws InputError if the load has no steady state there. T: double or a dual.
template <class T>
OperatingOf<T> load_operating_point(const Consumer& load, const std::vector<T>& parameters, Complex voltage,
                                    double base_mva, const Conventions& conventions,
                                    std::optional<Complex> regulated = {});

}  // namespace swingbank::sim::plant
