#pragma once
// One evaluation of a plant's equations, for any scalar: both integrators, play-in and initialisation use it.
// Order: emf -> (the network answers with Ir, Ii) -> electrical -> controls in slot order -> machine derivative.
#include <vector>

#include "sim/solve/grid.hpp"

namespace swingbank::sim {

template <class T>
class PlantEquations {
 public:
  explicit PlantEquations(const Plant& plant) : machine_(&plant.machine.effect->get<T>().machine) {
    scratch_ = plant.machine.effect->scratch;
    coefficients_ = plant.machine.effect->coefficients;
    states_ = static_cast<int>(plant.machine.effect->states.size());
    for (const auto& block : plant.controls) {
      controls_.push_back({&block.effect->get<T>().control, coefficients_, states_});
      coefficients_ += block.effect->coefficients;
      states_ += static_cast<int>(block.effect->states.size());
    }
  }
  [[nodiscard]] int states() const { return states_; }
  [[nodiscard]] int coefficients() const { return coefficients_; }
  [[nodiscard]] int scratch() const { return scratch_; }
  [[nodiscard]] bool has_controls() const { return !controls_.empty(); }

  /// Voltage behind the source impedance, network frame [pu].
  void emf(const T* c, const T* x, T* m, T& er, T& ei) const { machine_->emf(c, x, m, er, ei); }

  /// Given s.Ir, s.Ii, the held s.Efd, s.Tm and, where there are controls, s.V.., s.P, s.Q: fills every other signal.
  void signals(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    machine_->electrical(c, x, m, s);
    for (const auto& k : controls_) k.ops->evaluate(c + k.c, x + k.x, s, dx + k.x);
  }
  /// signals() and the derivative of every state.
  void derivative(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    signals(c, x, m, s, dx);
    machine_->derivative(c, x, m, s, dx);
  }
  /// Terminal voltage and power from the emf and the current, behind r + jx.
  static void terminal(const T& er, const T& ei, const T& r, const T& xs, Signals<T>& s) {
    using std::sqrt;
    s.Vr = er - r * s.Ir + xs * s.Ii;
    s.Vi = ei - r * s.Ii - xs * s.Ir;
    s.V = sqrt(s.Vr * s.Vr + s.Vi * s.Vi);
    s.P = s.Vr * s.Ir + s.Vi * s.Ii;
    s.Q = s.Vi * s.Ir - s.Vr * s.Ii;
  }

 private:
  struct Control {
    const ControlOps<T>* ops;
    int c, x;
  };
  const MachineOps<T>* machine_;
  std::vector<Control> controls_;
  int coefficients_ = 0, states_ = 0, scratch_ = 0;
};

}  // namespace swingbank::sim
