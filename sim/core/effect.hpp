#pragma once
// The effect contract. An effect is one header in sim/effects that declares a `struct Model` with
//   name, title, source, slot           what it is, where its equations come from, where it sits in a plant
//   parameters[], states[]              one record each; nowhere else is a parameter declared
//   dyr_name, dyr_columns[]             PSS/E .dyr model name and column order, if it has one
//   check(), unphysical()               singular values (refused always), orderings (refused in physical
//   draws) prepare<T>()                        parameters -> coefficients, so that no division stays in the
//   loop equations<T>                        see MachineOps and ControlOps below steady<T>()
//   back-initialisation from the operating point
// CMake finds the header and writes the registry; nothing is edited. T runs over `Scalars`.
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "sim/core/problem.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Where an effect sits in a plant; also the order in which a plant's blocks are evaluated.
enum class Slot { machine, stabiliser, limiter, exciter, governor };
std::string_view slot_name(Slot slot);

constexpr double kNoNeutral = std::numeric_limits<double>::quiet_NaN();

/// One parameter of an effect. `low` and `high` bound what is physically possible; a dataset's sampling box
/// stands in its own config and is checked against them. `neutral` is the value at which the parameter's
/// influence vanishes (NaN: there is none).
struct Parameter {
  std::string_view name;    ///< identifier in configs, HDF5 and tables: "Xdp"
  std::string_view symbol;  ///< as engineers write it: "X'd"
  std::string_view unit;    ///< "pu", "s"
  double standard, low, high, neutral;
  std::string_view meaning;
};

struct State {
  std::string_view name, unit, meaning;
  double weight =
      1.0;  ///< of this state's error in step control: a speed error counts through the angle it causes
};

/// What simulators do differently, chosen by the origin of the data (docs/decisions.md).
struct Conventions {
  bool speed_voltage = true;     ///< the flux linkages' voltage is scaled by speed: E'' = (1 + w) psi''
  bool mechanical_power = true;  ///< the governor sets power, so torque is (Pm - D w)/(1 + w); else torque
  double frequency = 60.0;       ///< system frequency [Hz]
  static constexpr Conventions psse(double hz = 60.0) { return {true, true, hz}; }
  static constexpr Conventions andes(double hz = 60.0) { return {false, false, hz}; }
};

/// Everything the blocks of one plant exchange; per unit on the machine's own base, network frame for r, i.
template <class T>
struct Signals {
  T Vr{}, Vi{}, V{};  ///< terminal voltage and its magnitude [pu]
  T Ir{}, Ii{};       ///< current injected into the network [pu]
  T P{}, Q{};         ///< power out of the machine [pu]
  T speed{};          ///< speed deviation [pu]
  T Te{}, Tm{};       ///< electrical and mechanical torque (or power, see Conventions) [pu]
  T Ifd{}, Efd{};     ///< field current and voltage, 1 pu on the air-gap line [pu]
  T Vs{};             ///< stabiliser output [pu]
  T Vlimiter{};       ///< limiters' sum into the voltage error [pu]
};

/// Equations of a machine (state 0 is the rotor angle, state 1 the speed deviation): voltage `e` behind the
/// constant impedance r + jx, both on the machine's base. x: states; c: coefficients; m: scratch shared by
/// the three calls of one evaluation.
template <class T>
struct MachineOps {
  void (*source_impedance)(const T* p, T& r, T& x) = nullptr;
  void (*emf)(const T* c, const T* x, T* m, T& er, T& ei) = nullptr;
  void (*electrical)(const T* c, const T* x, T* m, Signals<T>& s) = nullptr;  ///< Ir, Ii -> speed, Te, Ifd
  void (*derivative)(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) = nullptr;
  /// Given Vr, Vi, Ir, Ii: fills the states, s.Efd and s.Tm, and coefficients fixed by the operating point.
  std::string (*steady)(const T* p, T* c, Signals<T>& s, T* x) = nullptr;
};

/// Equations of a control: reads and writes signals, gives the derivative of its states.
template <class T>
struct ControlOps {
  void (*evaluate)(const T* c, const T* x, Signals<T>& s, T* dx) = nullptr;
  /// Given all signals at the operating point: fills states and references (kept in c). Returns why it
  /// cannot.
  std::string (*steady)(const T* p, T* c, Signals<T>& s, T* x) = nullptr;
};

template <class T>
struct Ops {
  void (*prepare)(const T* p, const Conventions& conventions, T* c) = nullptr;
  MachineOps<T> machine;  ///< filled where slot == machine
  ControlOps<T> control;  ///< filled elsewhere
};

template <class Tuple>
struct OpsFor;
template <class... T>
struct OpsFor<std::tuple<T...>> {
  using type = std::tuple<Ops<T>...>;
};

/// One registered effect, its types erased.
struct Effect {
  std::string_view name, title, source, dyr_name;
  Slot slot;
  std::span<const Parameter> parameters;
  std::span<const State> states;
  std::span<const int> dyr_columns;   ///< parameter index of each .dyr column
  int raw_resistance, raw_reactance;  ///< parameters that PSS/E keeps in the .raw (ZR, ZX), or -1
  int coefficients, scratch;
  void (*check)(const double* p, const std::string& where, Problems& problems);
  std::string_view (*unphysical)(const double* p);  ///< empty, or the ordering that is violated
  OpsFor<Scalars>::type ops;

  template <class T>
  [[nodiscard]] const Ops<T>& get() const {
    return std::get<Ops<T>>(ops);
  }
  [[nodiscard]] int parameter_index(std::string_view parameter) const;  ///< -1 if unknown
  [[nodiscard]] std::vector<double> standard_parameters() const;
};

/// Every effect, in the order of the file names. Generated: sim/effects/*.hpp.
std::span<const Effect> all_effects();
/// nullptr if there is none of that name (case matters not).
const Effect* find_effect(std::string_view name);
/// Names of all effects for error messages: "GENCLS, GENROU".
std::string effect_names();

// ---- used by the generated registry only -------------------------------------------------------------
template <class M, class T>
Ops<T> make_ops() {
  Ops<T> o;
  o.prepare = &M::template prepare<T>;
  if constexpr (M::slot == Slot::machine) {
    o.machine = {&M::template source_impedance<T>, &M::template emf<T>, &M::template electrical<T>,
                 &M::template derivative<T>, &M::template steady<T>};
  } else {
    o.control = {&M::template evaluate<T>, &M::template steady<T>};
  }
  return o;
}
template <class M, class... T>
std::tuple<Ops<T>...> make_all_ops(std::tuple<T...>*) {
  return {make_ops<M, T>()...};
}

template <class M>
Effect make_effect() {
  return {M::name,          M::title,        M::source,
          M::dyr_name,      M::slot,         M::parameters,
          M::states,        M::dyr_columns,  M::raw_resistance,
          M::raw_reactance, M::coefficients, M::scratch,
          &M::check,        &M::unphysical,  make_all_ops<M>(static_cast<Scalars*>(nullptr))};
}

}  // namespace swingbank::sim
