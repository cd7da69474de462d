#pragma once
// Interface of an effect: a dynamic model component, defined by one header in sim/effects. The header
// declares a `struct Model` with
//   name, title, source, slot     identity, source of the equations, place in the plant
//   description                   block diagram and equations as text; printed by `swingbank effects NAME`
//   parameters[], states[]        one record each; the only declaration of a parameter
//   defaults_from, bounds_from    sources of defaults and bounds if a parameter's record gives none
//   dyr_name, dyr_columns[]       PSS/E .dyr model name and column order ("" and none if it has none)
//   check()                       refuses values at which the equations fail, such as a divisor of 0
//   unphysical()                  optional: refuses random draws that no machine has, such as Xd < X'd
//   coefficients, scratch         numbers of coefficients and, of a machine, of scratch values
//   raw_resistance, raw_reactance of a machine, optional: parameters that PSS/E keeps in the .raw
//   variant_of                    optional: name of the effect of which it is a variant
//   prepare<T>()                  computes coefficients from parameters, so that no time step divides
//   equations of its kind         MachineOps, ControlOps, TransformerOps or LoadOps below
//   steady<T>()                   back-initialisation from the operating point
//   converter                     of a source, optional: true if it is a controlled current source
//   takes_commands                of a converter, optional: false if it has its own control
//   at_shunt                      of a load, optional: layout of its .dyr records for switched shunts
//   publish<T>()                  of a control, optional: writes outputs that are states, before evaluation
//   afterwards<T>()               of a control, optional: derivatives that need the field voltage
//   guards, guard<T>()            of a control, optional: functions that are zero where its derivatives jump
//   remark()                      optional: warning about values that request unmodelled behaviour
//   elsewhere                     of a plant control, optional: parameters that select its measuring point
//   switching_times()             optional: switching times of its equations
//   closed_form()                 of a machine, optional: its parameters from measurements, without a search
//   measure(), memory()           of a measurement: its operation on phasors, and its memory [s]
//   angle_lag()                   of a frequency measurement, optional: lag of the angle integrated from it
// CMake finds the header and generates the registry. T runs over `Scalars`.
#include <algorithm>
#include <array>
#include <complex>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/problem.hpp"
#include "sim/core/literature.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Place of an effect in a plant. The order is also the evaluation order of the controls.
enum class Slot {
  machine,         ///< the source: a synchronous machine or a converter (Effect::converter)
  transformer,     ///< between the machine's terminal and the grid
  compensator,     ///< outputs Vc, the compensated voltage that the exciter regulates
  setpoint,        ///< outputs dVref, dPref, dGref
  governor,        ///< outputs Tm
  shaft,           ///< changes Tm after the governor: torques on the shaft that do not depend on the governor
  stabiliser,      ///< outputs Vs; after the governor, because accelerating power needs Tm
  limiter,         ///< adds to Vlimiter
  exciter,         ///< outputs Efd
  plant_control,   ///< outputs Pext, Qext; this and the next five slots exist in converters only
  torque_control,  ///< outputs Pext and wref from the turbine's speed
  pitch_control,   ///< outputs pitch
  aerodynamics,    ///< outputs Paero
  drive_train,     ///< outputs wt, wg
  electrical_control,  ///< outputs the current commands in Tm and Efd
  load,                ///< a consumer at a bus
  measurement,         ///< between the grid and the record
};
/// All slots, in the order of Slot.
inline constexpr std::array kSlots = {Slot::machine,       Slot::transformer,    Slot::compensator,
                                      Slot::setpoint,      Slot::governor,       Slot::shaft,
                                      Slot::stabiliser,    Slot::limiter,        Slot::exciter,
                                      Slot::plant_control, Slot::torque_control, Slot::pitch_control,
                                      Slot::aerodynamics,  Slot::drive_train,    Slot::electrical_control,
                                      Slot::load,          Slot::measurement};
/// Returns the name of a slot, "governor".
std::string_view slot_name(Slot slot);
/// Whether effects in this slot are controls, whose equations are ControlOps.
constexpr bool is_control(Slot slot) { return slot >= Slot::compensator && slot <= Slot::electrical_control; }
/// Whether a control in this slot belongs to a converter. Set-points exist for both kinds of source.
constexpr bool is_of_converter(Slot slot) {
  return slot >= Slot::plant_control && slot <= Slot::electrical_control;
}
/// Whether a plant may have several effects in this slot, because their outputs add.
constexpr bool is_shared(Slot slot) {
  return slot == Slot::setpoint || slot == Slot::limiter || slot == Slot::shaft || slot == Slot::measurement;
}
/// Returns the slot whose control alone reads the outputs of a control in `slot`. Returns none if the machine
/// or several controls read these outputs.
constexpr std::optional<Slot> reader_of(Slot slot) {
  switch (slot) {
    case Slot::compensator:
    case Slot::stabiliser:
    case Slot::limiter:
      return Slot::exciter;
    default:
      return std::nullopt;
  }
}

/// Marks a parameter without a null value (a value at which the effect has no influence).
constexpr double kNoNullValue = std::numeric_limits<double>::quiet_NaN();
/// Placeholder for `default_from` in a parameter's record: the default's source is the effect's
/// defaults_from.
constexpr Source kAsEffect = {};

/// One parameter of an effect. `low` and `high` bound the usual range (sim/plant/usual.hpp); check() refuses
/// values with which the equations cannot be evaluated. A dataset's sampling box must lie within the range.
/// At `null_value` the effect has no influence; this value may lie outside the usual range (NaN: none). The
/// unit "code" marks an integer choice, which is neither sampled nor fitted. If a source is empty, the
/// effect's defaults_from or bounds_from applies.
struct Parameter {
  std::string_view name;                        ///< identifier in configs, HDF5 and tables: "Xdp"
  std::string_view symbol;                      ///< usual notation: "X'd"
  std::string_view unit;                        ///< "pu", "s"
  double default_value, low, high, null_value;  ///< default; usual range; null value (NaN: none) [unit]
  std::string_view meaning;                     ///< definition, for tables and `swingbank effects`
  Source default_from = {}, bounds_from = {};   ///< sources of the default and of the range
  int limit = 0;  ///< +1: upper limit of a signal, -1: lower limit, 0: not a limit
  /// Whether the parameter is an integer choice (unit "code"), which is neither sampled nor fitted.
  [[nodiscard]] constexpr bool is_code() const { return unit == "code"; }
};

/// Returns `p`, marked as the upper limit of a signal.
constexpr Parameter upper_limit(Parameter p) {
  p.limit = 1;
  return p;
}
/// Returns `p`, marked as the lower limit of a signal.
constexpr Parameter lower_limit(Parameter p) {
  p.limit = -1;
  return p;
}

/// Indices of the parameters with which a plant control selects a remote measuring point. Parameter value 0:
/// at the plant. Index -1: the effect has no such parameter.
struct Elsewhere {
  int bus = -1;                          ///< number of the regulated bus
  int from = -1, to = -1, circuit = -1;  ///< branch whose flow is measured at bus `from`
};

/// One state variable of an effect, with its limits and its weight in step size control.
struct State {
  std::string_view name, unit, meaning;  ///< identifier, unit and definition
  /// Weight of the state's error in step size control. The weight of a speed converts its error into an angle
  /// error.
  double weight = 1.0;
  /// Indices of the coefficients with the non-windup limits, -1: none. The integrator clamps the state at its
  /// limits: at a limit, it replaces a derivative that points outwards by zero.
  int low = -1, high = -1;  ///< coefficient indices of lower and upper limit
  /// Coefficients that multiply the derivative. While all named coefficients are zero, the state keeps its
  /// steady-state value, whatever the signals. A state without such coefficients is always integrated.
  struct Movers {
    int first = -1, second = -1;  ///< indices of the coefficients, -1: none
  };
  Movers moved_by = {};  ///< the state is constant while these are zero
  /// Index of a coefficient that multiplies `weight` if the coefficient exceeds 1; -1: none.
  int weighed_by = -1;
  /// Whether the derivative has kinks that `low` and `high` do not describe. The error estimate of every step
  /// then includes the error that a kink may cause.
  bool bends = false;
};

/// Conventions that differ between simulators (decision 07), and the system data that an effect needs.
struct Conventions {
  bool speed_voltage = true;     ///< voltage of the flux linkages scales with speed: E'' = (1 + w) psi''
  bool mechanical_power = true;  ///< true: governor outputs power, torque = (Pm - D w)/(1 + w); false: torque
  double frequency = 60.0;       ///< system frequency [Hz]
  double mva = 100.0;            ///< base of the machine [MVA], set by operating_point
  /// Conventions of PSS/E at a system frequency [Hz].
  static constexpr Conventions psse(double hz = 60.0) { return {false, true, hz}; }
  /// Conventions of ANDES at a system frequency [Hz].
  static constexpr Conventions andes(double hz = 60.0) { return {false, false, hz}; }
};

/// Remote measurement of a plant control: voltage of the selected bus, and current and power of the selected
/// branch [pu], positive out of the plant. A plant without a grid has no other bus; the values are then
/// measured at the plant's grid side, as are the plant's records.
template <class T>
struct Far {
  T Vr{}, Vi{}, Ir{}, Ii{}, P{}, Q{};
  ///< voltage and current in the network frame [pu]; power out of the plant [pu]
};

/// Signals exchanged by the blocks of one plant, per unit on the machine's own base. The suffixes r and i
/// mark real and imaginary parts in the network frame. For a converter, Tm is the active current command and
/// Efd the reactive current command, positive while the converter delivers Q [pu]. Code that estimates or
/// records Tm and Efd therefore serves both kinds of source.
template <class T>
struct Signals {
  T Vr{}, Vi{}, V{};   ///< voltage at the machine's terminal and its magnitude [pu]
  T Ir{}, Ii{};        ///< current out of the machine [pu]
  T P{}, Q{};          ///< power out of the machine [pu]
  T speed{};           ///< speed deviation [pu]
  T Te{}, Tm{};        ///< electrical and mechanical torque (or power, see Conventions) [pu]
  T Ifd{}, Efd{};      ///< field current and voltage, 1 pu on the air-gap line [pu]
  T Vc{};              ///< regulated voltage: V unless a compensator changes it [pu]
  T Vs{};              ///< stabiliser output [pu]
  T Vlimiter{};        ///< sum of the limiters' inputs to the voltage error [pu]
  T dVref{}, dPref{};  ///< changes of the exciter's and the governor's reference [pu]
  /// Change of the governor's reference [pu]: of speed if the reference enters before the droop, else of
  /// power.
  T dGref{};
  T t{};  ///< time [s], limited to just before the end of the integrated segment (kBeforeSwitching)
  /// Voltage at the grid's side of the step-up transformer [pu]. For a load, Vpr and Vpi are the voltage of
  /// the bus that it regulates (Consumer::regulated), by default its own bus.
  T Vpr{}, Vpi{}, Vp{};  ///< in the network frame, and its magnitude [pu]
  // Signals of converter controls only:
  /// References of P and of Q (or V, by the control's flags), relative to the operating point [pu].
  T Pext{}, Qext{};      ///< changes of the references of P and Q [pu]
  T Pneed{}, Qneed{};    ///< values of these references at the operating point, computed by steady() [pu]
  T wt{}, wg{}, wref{};  ///< speed of turbine and generator and its reference, minus 1 [pu]
  /// Blade pitch relative to the operating point (in steady(): absolute) [degrees]; aerodynamic power [pu].
  T pitch{}, Paero{};  ///< [degrees], [pu]
  T Pord{};            ///< power order of the electrical control [pu]
  Far<T> far{};        ///< remote measurement, read if the plant control names a bus or a branch
};

/// Equations of a machine: voltage `e` behind the constant impedance r + jx, both on the machine's base.
/// State 0 of a synchronous machine is the rotor angle, state 1 the speed deviation. x: states; c:
/// coefficients; m: scratch memory shared by the functions of one evaluation.
template <class T>
struct MachineOps {
  /// Parameters -> source impedance r + jx [pu on the machine's base].
  void (*source_impedance)(const T* p, T& r, T& x) = nullptr;
  /// States -> internal voltage er + j ei in the network frame [pu].
  void (*emf)(const T* c, const T* x, T* m, T& er, T& ei) = nullptr;
  void (*electrical)(const T* c, const T* x, T* m, Signals<T>& s) = nullptr;  ///< Ir, Ii -> speed, Te, Ifd
  /// States and signals -> derivatives dx of all states [1/s].
  void (*derivative)(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) = nullptr;
  /// From Vr, Vi, Ir, Ii: computes the states, s.Efd, s.Tm and the coefficients that depend on the operating
  /// point. Returns the reason of a failure, empty on success.
  std::string (*steady)(const T* p, T* c, Signals<T>& s, T* x) = nullptr;
  /// Optional, for machines without a constant impedance (saliency, saturated reactances): Vr, Vi -> Ir, Ii.
  /// It is called after emf(). For such a machine, source_impedance() gives only the constant impedance that
  /// represents it in the network matrix.
  void (*current)(const T* c, const T* x, T* m, Signals<T>& s) = nullptr;
};

/// Equations of a control, which reads and writes signals and computes the derivatives of its states.
/// `user_model` is the data of a user-defined model, else nullptr.
template <class T>
struct ControlOps {
  /// States and signals -> outputs in the signals, and derivatives dx [1/s].
  void (*evaluate)(const void* user_model, const T* c, const T* x, Signals<T>& s, T* dx) = nullptr;
  /// From all signals at the operating point: computes states and references (kept in c). Returns the reason
  /// of a failure, empty on success.
  std::string (*steady)(const void* user_model, const T* p, T* c, Signals<T>& s, T* x) = nullptr;
  /// Optional: writes those outputs that equal states. It runs before any control is evaluated, so that
  /// controls earlier in the order can read them.
  void (*publish)(const T* c, const T* x, Signals<T>& s) = nullptr;
  /// Optional: computes the guards, smooth functions of states and signals; Effect::guards is their number. A
  /// derivative of the effect jumps where one of them passes zero.
  void (*guard)(const T* c, const T* x, const Signals<T>& s, T* g) = nullptr;
  /// Optional: completes derivatives after all controls are evaluated, from outputs of later controls such as
  /// the field voltage. dx holds the values written by evaluate().
  void (*afterwards)(const T* c, const T* x, const Signals<T>& s, T* dx) = nullptr;
};

/// Step-up transformer: ideal ratio (grid side / machine side) and impedance on the machine's base.
template <class T>
struct TransformerOps {
  /// Parameters -> series impedance r + jx [pu on the machine's base] and ratio [pu].
  void (*impedance)(const T* p, T& r, T& x, T& ratio) = nullptr;
};

/// A load. Its current into the bus (negative while it consumes) is a function of the bus voltage and its
/// states, per unit on Consumer::mva. `steady` receives Vr, Vi, Vpr, Vpi, Ir, Ii.
template <class T>
struct LoadOps {
  void (*current)(const T* c, const T* x, Signals<T>& s) = nullptr;  ///< Vr, Vi -> Ir, Ii
  /// States and bus voltage -> derivatives dx [1/s].
  void (*derivative)(const T* c, const T* x, const Signals<T>& s, T* dx) = nullptr;
  /// Computes states and coefficients from the operating point. Returns the reason of a failure, empty on
  /// success.
  std::string (*steady)(const T* p, T* c, Signals<T>& s, T* x) = nullptr;
};

/// Output of an instrument: uniform samples of voltage [pu], current out of the plant [pu] and reported
/// frequency deviation [pu]. NaN marks a missing sample.
struct Phasors {
  double rate = 60.0, frequency = 60.0;    ///< samples per second; system frequency [Hz]
  std::vector<std::complex<double>> V, I;  ///< [sample]: voltage, current out of the plant [pu]
  std::vector<double> df;                  ///< [sample]: reported frequency deviation [pu]
};

/// Equations of one effect for the scalar type T (double, SIMD batch or dual). A function that this kind of
/// effect does not have is null.
template <class T>
struct Ops {
  /// Parameters p and conventions -> coefficients c; called once per simulation.
  void (*prepare)(const T* p, const Conventions& conventions, T* c) = nullptr;
  MachineOps<T> machine;          ///< filled where slot == machine
  ControlOps<T> control;          ///< filled where is_control(slot)
  TransformerOps<T> transformer;  ///< filled where slot == transformer
  LoadOps<T> load;                ///< filled where slot == load
};

template <class Tuple>
struct OpsFor;
/// Equations of one effect for each scalar type of a tuple.
template <class... T>
struct OpsFor<std::tuple<T...>> {
  using type = std::tuple<Ops<T>...>;  ///< tuple of Ops<T>, one for each T
};

struct Recording;

/// Layout of .dyr records of switched shunts that differ from "bus, 'MODEL', id, parameters". A record named
/// `of_first` is for the first switched shunt of a bus and has the regulated bus in the id's place. A record
/// named `by_id` has the id, followed by the regulated bus. After the first `columns` fields, each of
/// `beside` further shunts has two fields: whether it is switched, and its id.
struct ShuntRecord {
  std::string_view of_first, by_id;          ///< model names of the two layouts, empty: none
  int regulated;                             ///< parameter with the number of the regulated bus
  std::size_t columns;                       ///< number of columns before the further shunts
  std::size_t beside;                        ///< number of further shunts
  static constexpr std::size_t of_each = 2;  ///< fields of each further shunt
  /// Returns the number of fields of the further shunts, which the reader skips.
  [[nodiscard]] constexpr std::size_t passed_over() const { return beside * of_each; }
};

/// One registered effect, with its types erased.
struct Effect {
  std::string_view name, title, source, description, dyr_name;
  ///< identity, documentation and PSS/E model name (empty: none)
  Slot slot;                              ///< place in the plant
  std::span<const Parameter> parameters;  ///< parameters, in the order of all parameter arrays
  std::span<const State> states;          ///< state variables, in the order of all state arrays
  std::span<const int> dyr_columns;       ///< parameter index of each .dyr column
  int raw_resistance, raw_reactance;      ///< parameters that PSS/E keeps in the .raw (ZR, ZX), or -1
  int coefficients, scratch;              ///< numbers of coefficients c and of scratch values m
  int guards = 0;                         ///< number of functions that guard() computes
  bool converter = false;                 ///< of a source: true if it is a controlled current source
  bool takes_commands = true;             ///< of a converter: false if it has its own control
  /// Layout of the .dyr records of a load that belong to switched shunts, else nullptr.
  const ShuntRecord* at_shunt = nullptr;
  Elsewhere elsewhere = {};  ///< parameters that select a remote measuring point
  /// Adds a problem for each singular parameter value, with which the equations cannot be evaluated. `where`:
  /// place in the messages.
  void (*check)(const void* user_model, const double* p, const std::string& where, Problems& problems);
  std::string_view (*unphysical)(const double* p);  ///< returns the violated ordering, or empty
  /// Returns a warning about values that request unmodelled behaviour, empty if there are none; nullptr: no
  /// such check.
  std::string (*remark)(const double* p) = nullptr;
  /// Returns the times at which the equations jump [s]; nullptr: never.
  std::vector<double> (*switching_times)(const void* user_model, const double* p);
  /// Applies the instrument to the phasors at its input; `seed` determines its random numbers. Only for
  /// measurements.
  void (*measure)(const double* p, std::uint64_t seed, Phasors& phasors);
  /// Returns the memory [s]: the longest time between an output sample of measure() and an input that affects
  /// it, before or after the sample. nullptr: 0.
  double (*memory)(const double* p);
  /// Returns the lag T [s] of an angle that is integrated from the reported frequency: the true angle is
  /// theta + T d(theta)/dt. nullptr: 0.
  double (*angle_lag)(const double* p) = nullptr;
  OpsFor<Scalars>::type ops;                         ///< equations for every scalar type
  std::shared_ptr<const void> user_model = nullptr;  ///< data of a user-defined model
  /// Returns estimates of all parameters by linear least squares from a record without noise, best first;
  /// none if the record is insufficient. Parameters that the record does not determine are taken from
  /// `known`. nullptr: no such method is known.
  std::vector<std::vector<double>> (*closed_form)(const Recording& record, const double* known) = nullptr;

  /// Returns the equations for the scalar type T.
  template <class T>
  [[nodiscard]] const Ops<T>& get() const {
    return std::get<Ops<T>>(ops);
  }
  [[nodiscard]] int parameter_index(std::string_view parameter) const;  ///< -1 if unknown
  /// Returns the defaults of all parameters, in their units.
  [[nodiscard]] std::vector<double> default_parameters() const;
};

/// Returns the name of the effect's slot, or "converter" if the effect is a converter.
std::string_view kind_name(const Effect& effect);
/// Returns why a control is incompatible with a plant's machine or converter ("governor belongs to a
/// synchronous machine, ..."); empty if it is compatible.
std::string slot_conflict(const Effect& source, const Effect& control);

// ---- used by the generated registry only -------------------------------------------------------------
/// \cond
template <class M, class T>
Ops<T> make_ops() {
  Ops<T> o;
  if constexpr (requires { &M::template prepare<T>; }) o.prepare = &M::template prepare<T>;
  if constexpr (M::slot == Slot::machine) {
    o.machine = {&M::template source_impedance<T>, &M::template emf<T>, &M::template electrical<T>,
                 &M::template derivative<T>, &M::template steady<T>};
    if constexpr (requires { &M::template current<T>; }) o.machine.current = &M::template current<T>;
  } else if constexpr (M::slot == Slot::transformer) {
    o.transformer = {&M::template impedance<T>};
  } else if constexpr (M::slot == Slot::load) {
    o.load = {&M::template current<T>, &M::template derivative<T>, &M::template steady<T>};
  } else if constexpr (is_control(M::slot)) {
    o.control = {+[](const void*, const T* c, const T* x, Signals<T>& s, T* dx) {
                   M::template evaluate<T>(c, x, s, dx);
                 },
                 +[](const void*, const T* p, T* c, Signals<T>& s, T* x) {
                   return M::template steady<T>(p, c, s, x);
                 }};
    if constexpr (requires { &M::template publish<T>; }) o.control.publish = &M::template publish<T>;
    if constexpr (requires { &M::template guard<T>; }) o.control.guard = &M::template guard<T>;
    if constexpr (requires { &M::template afterwards<T>; }) o.control.afterwards = &M::template afterwards<T>;
  }
  return o;
}
template <class M, class... T>
std::tuple<Ops<T>...> make_all_ops(std::tuple<T...>*) {
  return {make_ops<M, T>()...};
}

/// Returns the parameter records of M with the sources of their values filled in.
template <class M>
constexpr auto sourced_parameters() {
  std::array<Parameter, std::size(M::parameters)> all{};
  std::copy(std::begin(M::parameters), std::end(M::parameters), all.begin());
  for (Parameter& p : all) {
    if constexpr (requires { M::defaults_from; })
      if (!p.default_from.given()) p.default_from = M::defaults_from;
    if constexpr (requires { M::bounds_from; })
      if (!p.bounds_from.given()) p.bounds_from = M::bounds_from;
  }
  return all;
}
template <class M>
inline constexpr auto kSourced = sourced_parameters<M>();

template <class M>
Effect make_effect() {
  static_assert(std::all_of(kSourced<M>.begin(), kSourced<M>.end(),
                            [](const Parameter& p) { return p.default_from.given(); }),
                "a default has no source: give defaults_from, or one in the parameter's record");
  static_assert(std::all_of(kSourced<M>.begin(), kSourced<M>.end(),
                            [](const Parameter& p) { return p.bounds_from.given(); }),
                "bounds have no source: give bounds_from, or one in the parameter's record");
  Effect e{};
  e.name = M::name;
  e.title = M::title;
  e.source = M::source;
  e.description = M::description;
  e.slot = M::slot;
  e.parameters = kSourced<M>;
  if constexpr (requires { M::states[0]; }) e.states = M::states;
  if constexpr (requires { M::dyr_name; }) e.dyr_name = M::dyr_name;
  if constexpr (requires { M::dyr_columns[0]; }) e.dyr_columns = M::dyr_columns;
  e.raw_resistance = e.raw_reactance = -1;
  if constexpr (requires { M::raw_resistance; }) e.raw_resistance = M::raw_resistance;
  if constexpr (requires { M::raw_reactance; }) e.raw_reactance = M::raw_reactance;
  if constexpr (requires { M::coefficients; }) e.coefficients = M::coefficients;
  if constexpr (requires { M::scratch; }) e.scratch = M::scratch;
  if constexpr (requires { M::guards; }) e.guards = M::guards;
  if constexpr (requires { M::converter; }) e.converter = M::converter;
  if constexpr (requires { M::takes_commands; }) e.takes_commands = M::takes_commands;
  if constexpr (requires { M::at_shunt; }) e.at_shunt = &M::at_shunt;
  if constexpr (requires { M::elsewhere; }) e.elsewhere = M::elsewhere;
  e.check = +[](const void*, const double* p, const std::string& where, Problems& problems) {
    M::check(p, where, problems);
  };
  e.unphysical = +[](const double*) { return std::string_view(); };
  if constexpr (requires { &M::unphysical; }) e.unphysical = &M::unphysical;
  if constexpr (requires { &M::remark; }) e.remark = &M::remark;
  if constexpr (requires { &M::switching_times; })
    e.switching_times = +[](const void*, const double* p) { return M::switching_times(p); };
  if constexpr (requires { &M::measure; }) e.measure = &M::measure;
  if constexpr (requires { &M::memory; }) e.memory = &M::memory;
  if constexpr (requires { &M::angle_lag; }) e.angle_lag = &M::angle_lag;
  if constexpr (requires { &M::closed_form; }) e.closed_form = &M::closed_form;
  e.ops = make_all_ops<M>(static_cast<Scalars*>(nullptr));
  return e;
}
/// \endcond

}  // namespace swingbank::sim
