#pragma once
// One consumer's equations: its current follows from the bus voltage and its states. For solvers that work
// with sources behind constant impedances it is one too: E = V + z I, where z is the impedance the load has
// at the operating point, so that a constant-impedance load is E = 0.
#include <optional>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Own coefficients of a load, after its effect's: the impedance at the operating point [pu on
/// Consumer::mva].
enum LoadJoint { load_r, load_x, kLoadJoint };

template <class T>
class LoadEquations {
 public:
  explicit LoadEquations(const Consumer& load)
      : ops_(load.block.effect->get<T>().load),
        joint_(load.block.effect->coefficients),
        states_(static_cast<int>(load.block.effect->states.size())) {}
  [[nodiscard]] int states() const { return states_; }
  [[nodiscard]] int coefficients() const { return joint_ + kLoadJoint; }
  [[nodiscard]] const T* impedance(const T* c) const { return c + joint_; }
  /// Vr, Vi -> Ir, Ii into the bus.
  void current(const T* c, const T* x, Signals<T>& s) const { ops_.current(c, x, s); }
  /// After current(); Vpr, Vpi: of the bus that it regulates.
  void derivative(const T* c, const T* x, const Signals<T>& s, T* dx) const { ops_.derivative(c, x, s, dx); }

 private:
  LoadOps<T> ops_;
  int joint_, states_;
};

/// Brings a load to the voltage of its bus and of the bus that it regulates, where that is another [pu];
/// throws InputError if it cannot be held there. T: double or a dual.
template <class T>
OperatingOf<T> load_operating_point(const Consumer& load, const std::vector<T>& parameters, Complex voltage,
                                    double base_mva, const Conventions& conventions,
                                    std::optional<Complex> regulated = {});

}  // namespace swingbank::sim::plant
