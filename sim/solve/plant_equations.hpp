#pragma once
// One plant's equations, whatever effects it is made of, in the order every integrator evaluates them:
//   emf -> (network: terminal voltage and current) -> machine.electrical -> controls in order of Slot ->
//   machine.derivative
// States and coefficients of a plant lie back to back, machine first, as in Operating.
#include <vector>

#include "sim/solve/grid.hpp"

namespace swingbank::sim {

template <class T>
class PlantEquations {
 public:
  explicit PlantEquations(const Plant& plant) : machine_(plant.machine.effect->get<T>().machine) {
    states_ = static_cast<int>(plant.machine.effect->states.size());
    coefficients_ = plant.machine.effect->coefficients;
    scratch_ = plant.machine.effect->scratch;
    for (const Block& block : plant.controls) {
      controls_.push_back({block.effect->get<T>().control, states_, coefficients_});
      states_ += static_cast<int>(block.effect->states.size());
      coefficients_ += block.effect->coefficients;
    }
  }
  [[nodiscard]] int states() const { return states_; }
  [[nodiscard]] int coefficients() const { return coefficients_; }
  [[nodiscard]] int scratch() const { return scratch_; }

  /// Voltage er + j ei behind the machine's impedance [pu, network frame]. m: scratch() values, kept for
  /// derivative().
  void emf(const T* c, const T* x, T* m, T& er, T& ei) const { machine_.emf(c, x, m, er, ei); }

  /// Needs Vr, Vi, Ir, Ii [pu on the machine's base], and in s.Efd and s.Tm the values held where no exciter
  /// or governor sets them. Fills every other signal, and dx with states() derivatives [1/s].
  void derivative(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    terminal(s);
    signals(c, x, m, s, dx);
    machine_.derivative(c, x, m, s, dx);
  }
  /// The same where nothing but the machine reads the terminal: no V, P, Q; only Ir and Ii are needed.
  void machine_derivative(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    machine_.electrical(c, x, m, s);
    machine_.derivative(c, x, m, s, dx);
  }
  /// After terminal(s): every other signal; dx gets the controls' derivatives.
  void signals(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    machine_.electrical(c, x, m, s);
    for (const Control& k : controls_) k.ops.evaluate(c + k.coefficient, x + k.state, s, dx + k.state);
  }
  [[nodiscard]] bool has_controls() const { return !controls_.empty(); }

  /// Vr, Vi at the terminal from the voltage e behind r + jx and the current in s.
  static void voltage(const T& er, const T& ei, const T& r, const T& x, Signals<T>& s) {
    s.Vr = er - r * s.Ir + x * s.Ii;
    s.Vi = ei - r * s.Ii - x * s.Ir;
  }
  /// P, Q and V from terminal voltage and current.
  static void terminal(Signals<T>& s) {
    using std::sqrt;
    s.P = s.Vr * s.Ir + s.Vi * s.Ii;
    s.Q = s.Vi * s.Ir - s.Vr * s.Ii;
    s.V = sqrt(s.Vr * s.Vr + s.Vi * s.Vi + T(1e-24));  // a dual needs a slope at V = 0
    s.Vs = T(0.0);
    s.Vlimiter = T(0.0);
  }

 private:
  struct Control {
    ControlOps<T> ops;
    int state, coefficient;
  };
  MachineOps<T> machine_;
  std::vector<Control> controls_;
  int states_ = 0, coefficients_ = 0, scratch_ = 0;
};

}  // namespace swingbank::sim
