#pragma once
// The effect contract: what one header in sim/effects says of its effect. It declares a `struct Model` with
//   name, title, source, slot     what it is, where its equations come from, where it sits
//   description                   block diagram and equations as text; `swingbank effects NAME` prints it
//   parameters[], states[]        one record each; nowhere else is a parameter declared
//   standards_from, bounds_from   where the numbers of those records come from that do not say it themselves
//   dyr_name, dyr_columns[]       PSS/E .dyr model name and column order ("" and none if it has none)
//   check(), unphysical()         singular values (refused always), orderings (refused in physical draws)
//   prepare<T>()                  parameters -> coefficients, so that no division stays in the loop
//   the equations of its kind     MachineOps, ControlOps, TransformerOps or LoadOps below
//   steady<T>()                   back-initialisation from the operating point
//   converter                     of a source, optional: true where it is a controlled current
//   at_shunt                      of a load, optional: layout of its .dyr records, of switched shunts
//   publish<T>()                  of a control, optional: signals that are states, before the evaluation
//   afterwards<T>()               of a control, optional: derivatives that need the field voltage
//   guards, guard<T>()            of a control, optional: what passes zero where its derivatives jump
//   remark()                      optional: what its values ask for and the equations leave out
//   elsewhere                     of a plant control, optional: parameters that say where it measures
//   instants()                    optional: when its equations jump in time
//   closed_form()                 of a machine, optional: its parameters from a record, without a search
//   measure(), memory()           of a measurement: what it makes of the phasors, and how far it reaches
// CMake finds the header and writes the registry; nothing is edited. T runs over `Scalars`.
#include <algorithm>
#include <array>
#include <complex>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/problem.hpp"
#include "sim/core/literature.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Where an effect sits in a plant; from `compensator` to `shaft` also the order in which the controls are
/// evaluated.
enum class Slot {
  machine,             ///< the source itself: a synchronous machine, or a converter (Effect::converter)
  transformer,         ///< between the machine's terminal and the grid
  compensator,         ///< makes Vc, the voltage the exciter regulates
  setpoint,            ///< moves dVref, dPref, dGref
  governor,            ///< makes Tm
  shaft,               ///< changes Tm after the governor: what acts on the shaft whatever the governor does
  stabiliser,          ///< makes Vs; after the governor, for accelerating power needs Tm
  limiter,             ///< adds to Vlimiter
  exciter,             ///< makes Efd
  plant_control,       ///< of a converter, as those that follow: makes Pext, Qext
  torque_control,      ///< makes Pext and wref from the turbine's speed
  pitch_control,       ///< makes pitch
  aerodynamics,        ///< makes Paero
  drive_train,         ///< makes wt, wg
  electrical_control,  ///< makes the current commands, which are Tm and Efd
  load,                ///< a consumer at a bus
  measurement,         ///< between the grid and the record
};
inline constexpr std::array kSlots = {Slot::machine,       Slot::transformer,    Slot::compensator,
                                      Slot::setpoint,      Slot::governor,       Slot::shaft,
                                      Slot::stabiliser,    Slot::limiter,        Slot::exciter,
                                      Slot::plant_control, Slot::torque_control, Slot::pitch_control,
                                      Slot::aerodynamics,  Slot::drive_train,    Slot::electrical_control,
                                      Slot::load,          Slot::measurement};
std::string_view slot_name(Slot slot);
constexpr bool is_control(Slot slot) { return slot >= Slot::compensator && slot <= Slot::electrical_control; }
/// Whether a control in this slot is one of a converter; a set-point is moved of either kind of source.
constexpr bool is_of_converter(Slot slot) {
  return slot >= Slot::plant_control && slot <= Slot::electrical_control;
}
/// Whether several effects may stand in the slot of one plant: those that add up.
constexpr bool is_shared(Slot slot) {
  return slot == Slot::setpoint || slot == Slot::limiter || slot == Slot::shaft || slot == Slot::measurement;
}

constexpr double kNoNeutral = std::numeric_limits<double>::quiet_NaN();
/// In a parameter's record before its bounds' source: its standard value has the effect's source.
constexpr Source kAsEffect = {};

/// One parameter of an effect. `low` and `high` bound what is usual (sim/plant/usual.hpp); what no equation
/// takes is refused by check(). A dataset's sampling box must lie within them. `neutral` is the value at
/// which the influence vanishes, beyond what is usual too (NaN: there is none). The unit "code" marks a
/// choice among whole numbers: never sampled, never fitted. The two sources are the effect's own,
/// standards_from and bounds_from, where a record gives none.
struct Parameter {
  std::string_view name;    ///< identifier in configs, HDF5 and tables: "Xdp"
  std::string_view symbol;  ///< as engineers write it: "X'd"
  std::string_view unit;    ///< "pu", "s"
  double standard, low, high, neutral;
  std::string_view meaning;
  Source standard_from = {}, bounds_from = {};
  [[nodiscard]] constexpr bool is_code() const { return unit == "code"; }
};

/// Indices of the parameters by which a plant's control names what it measures elsewhere in the grid (0 in
/// them: at the plant); -1: it has none.
struct Elsewhere {
  int bus = -1;                          ///< number of the bus whose voltage it regulates
  int from = -1, to = -1, circuit = -1;  ///< the branch whose flow counts, measured at its first bus
};

struct State {
  std::string_view name, unit, meaning;
  /// Of this state's error in step control: a speed error counts through the angle it causes.
  double weight = 1.0;
  /// Coefficients that hold the limits of a non-windup state, -1: none. Whoever integrates stops the state
  /// there: its derivative is zero while it would lead further out.
  int low = -1, high = -1;
  /// Coefficients without which the state stands still: where they are zero its derivative is, whatever the
  /// signals, once it stands where steady() puts it. -1: none; a state that names none always counts as
  /// moving.
  struct Movers {
    int first = -1, second = -1;
  };
  Movers moved_by = {};
  /// Coefficient that multiplies the weight where it is above 1, -1: none.
  int weighed_by = -1;
  /// Its derivative bends where `low` and `high` do not tell: every step is judged as one with a kink.
  bool bends = false;
};

/// What simulators do differently, chosen by the origin of the data (decision 07), and what an effect
/// knows of its surroundings.
struct Conventions {
  bool speed_voltage = true;     ///< the flux linkages' voltage is scaled by speed: E'' = (1 + w) psi''
  bool mechanical_power = true;  ///< the governor sets power, so torque is (Pm - D w)/(1 + w); else torque
  double frequency = 60.0;       ///< system frequency [Hz]
  double mva = 100.0;            ///< base of the machine at hand [MVA]; set by operating_point
  static constexpr Conventions psse(double hz = 60.0) { return {false, true, hz}; }
  static constexpr Conventions andes(double hz = 60.0) { return {false, false, hz}; }
};

/// What a plant's control sees elsewhere: voltage of the bus that it regulates [pu], current [pu] and power
/// [pu] of the branch whose flow counts, positive out of the plant. Where its parameters name neither bus nor
/// branch, those of the plant's grid side, which is where a record of it was taken.
template <class T>
struct Far {
  T Vr{}, Vi{}, Ir{}, Ii{}, P{}, Q{};
};

/// Everything the blocks of one plant exchange; per unit on the machine's own base, network frame for r, i.
/// Of a converter Tm is the command of active current and Efd that of reactive current, positive while it
/// delivers Q [pu]: so what holds, adds to, infers and records Tm and Efd does the same for the commands.
template <class T>
struct Signals {
  T Vr{}, Vi{}, V{};   ///< voltage at the machine's terminal and its magnitude [pu]
  T Ir{}, Ii{};        ///< current out of the machine [pu]
  T P{}, Q{};          ///< power out of the machine [pu]
  T speed{};           ///< speed deviation [pu]
  T Te{}, Tm{};        ///< electrical and mechanical torque (or power, see Conventions) [pu]
  T Ifd{}, Efd{};      ///< field current and voltage, 1 pu on the air-gap line [pu]
  T Vc{};              ///< voltage the exciter regulates: V unless a compensator changes it [pu]
  T Vs{};              ///< stabiliser output [pu]
  T Vlimiter{};        ///< limiters' sum into the voltage error [pu]
  T dVref{}, dPref{};  ///< moves of the exciter's and the governor's reference [pu]
  T dGref{};           ///< move of the governor's reference in its own unit: speed where a droop follows it,
                       ///< else power [pu]
  T t{};               ///< time [s]; at an instant named by instants() that of the running side
  T Vpr{}, Vpi{}, Vp{};  ///< voltage at the grid's side of the step-up transformer; Vpr, Vpi of a load: at
                         ///< the bus that it regulates (Consumer::regulated), else its own [pu]
  // of a converter's controls alone
  T Pext{}, Qext{};    ///< references of P and of Q (or of V, as the control's flags say), less their values
                       ///< at the operating point [pu]
  T Pneed{}, Qneed{};  ///< what these references must be at the operating point; made by steady() [pu]
  T wt{}, wg{},
      wref{};  ///< speed of turbine and generator of a wind turbine, and what it should be, less 1 [pu]
  T pitch{}, Paero{};  ///< of the blades, less its value at the operating point (in steady(): that value)
                       ///< [degrees]; power of the wind at the shaft [pu]
  T Pord{};            ///< power that the electrical control orders [pu]
  Far<T> far{};        ///< for the plant's control, which reads it if its parameters name a bus or a branch
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
  /// Only where no constant impedance does (saliency, saturated reactances): Vr, Vi -> Ir, Ii, after emf.
  /// source_impedance is then the one to start from.
  void (*current)(const T* c, const T* x, T* m, Signals<T>& s) = nullptr;
};

/// Equations of a control: reads and writes signals, gives the derivative of its states. `law` is the
/// effect's own data where it was read from a file.
template <class T>
struct ControlOps {
  void (*evaluate)(const void* law, const T* c, const T* x, Signals<T>& s, T* dx) = nullptr;
  /// Given all signals at the operating point: fills states and references (kept in c). Returns why it
  /// cannot, empty if it can.
  std::string (*steady)(const void* law, const T* p, T* c, Signals<T>& s, T* x) = nullptr;
  /// Optional: writes signals that are states before any control is evaluated, for those that stand earlier.
  void (*publish)(const T* c, const T* x, Signals<T>& s) = nullptr;
  /// Optional: Effect::guards smooth functions of states and signals. Where one passes zero, a derivative of
  /// the effect jumps.
  void (*guard)(const T* c, const T* x, const Signals<T>& s, T* g) = nullptr;
  /// Optional: after all controls were evaluated, derivatives that need what those behind it make, as the
  /// field voltage; those that evaluate() has written stand in dx.
  void (*afterwards)(const T* c, const T* x, const Signals<T>& s, T* dx) = nullptr;
};

/// A step-up transformer: ideal ratio (grid side / machine side) and impedance on the machine's base.
template <class T>
struct TransformerOps {
  void (*impedance)(const T* p, T& r, T& x, T& ratio) = nullptr;
};

/// A consumer. Its current into the bus (negative while it consumes) follows from the bus voltage and its
/// states; per unit on Consumer::mva. `steady` gets Vr, Vi, Vpr, Vpi, Ir, Ii.
template <class T>
struct LoadOps {
  void (*current)(const T* c, const T* x, Signals<T>& s) = nullptr;  ///< Vr, Vi -> Ir, Ii
  void (*derivative)(const T* c, const T* x, const Signals<T>& s, T* dx) = nullptr;
  std::string (*steady)(const T* p, T* c, Signals<T>& s, T* x) = nullptr;
};

/// Phasors as an instrument delivers them: uniform samples of voltage [pu], of current out of the plant [pu],
/// and the frequency deviation [pu] it reports. NaN marks a sample that is missing.
struct Phasors {
  double rate = 60.0, frequency = 60.0;  ///< samples per second; system frequency [Hz]
  std::vector<std::complex<double>> V, I;
  std::vector<double> df;
};

template <class T>
struct Ops {
  void (*prepare)(const T* p, const Conventions& conventions, T* c) = nullptr;
  MachineOps<T> machine;          ///< filled where slot == machine
  ControlOps<T> control;          ///< filled where is_control(slot)
  TransformerOps<T> transformer;  ///< filled where slot == transformer
  LoadOps<T> load;                ///< filled where slot == load
};

template <class Tuple>
struct OpsFor;
template <class... T>
struct OpsFor<std::tuple<T...>> {
  using type = std::tuple<Ops<T>...>;
};

struct Recording;

/// Records of a .dyr that belong to switched shunts, where these are not "bus, 'MODEL', id, parameters". One
/// name is for the first switched shunt of a bus and has the regulated bus in the id's place, the other is
/// for one by its id, and the regulated bus stands behind it. Behind the first columns stand, for each of
/// several shunts beside it, whether it is switched and its id.
struct ShuntRecord {
  std::string_view of_first, by_id;
  int regulated;        ///< parameter with the number of the regulated bus: its first column
  std::size_t columns;  ///< before the shunts beside it
  std::size_t beside;   ///< of these
  static constexpr std::size_t of_each = 2;  ///< fields
  [[nodiscard]] constexpr std::size_t passed_over() const { return beside * of_each; }
};

/// One registered effect, its types erased.
struct Effect {
  std::string_view name, title, source, description, dyr_name;
  Slot slot;
  std::span<const Parameter> parameters;
  std::span<const State> states;
  std::span<const int> dyr_columns;   ///< parameter index of each .dyr column
  int raw_resistance, raw_reactance;  ///< parameters that PSS/E keeps in the .raw (ZR, ZX), or -1
  int coefficients, scratch;
  int guards = 0;
  bool converter = false;  ///< of a source: a controlled current, no synchronous machine
  /// Of a load whose records in a .dyr belong to switched shunts: how they are laid out.
  const ShuntRecord* at_shunt = nullptr;
  Elsewhere elsewhere = {};
  void (*check)(const void* law, const double* p, const std::string& where, Problems& problems);
  std::string_view (*unphysical)(const double* p);  ///< empty, or the ordering that is violated
  /// What these values ask for and the equations leave out, as a sentence for a warning; nullptr: nothing.
  std::string (*remark)(const double* p) = nullptr;
  /// When the equations jump in time [s]; nullptr: never.
  std::vector<double> (*instants)(const void* law, const double* p);
  /// What the instrument makes of the true phasors; `seed` drives what is random. Only measurements.
  void (*measure)(const double* p, std::uint64_t seed, Phasors& phasors);
  /// How far in time an output sample of measure() reaches to either side [s]; nullptr: no further than
  /// itself.
  double (*memory)(const double* p);
  OpsFor<Scalars>::type ops;
  std::shared_ptr<const void> law = nullptr;  ///< data of an effect read from a file
  /// Values of all parameters by linear least squares from a record that is free of noise, best first; those
  /// that a record does not show are taken from `known`. nullptr: nobody has found how.
  std::vector<std::vector<double>> (*closed_form)(const Recording& record, const double* known) = nullptr;

  template <class T>
  [[nodiscard]] const Ops<T>& get() const {
    return std::get<Ops<T>>(ops);
  }
  [[nodiscard]] int parameter_index(std::string_view parameter) const;  ///< -1 if unknown
  [[nodiscard]] std::vector<double> standard_parameters() const;
};

/// What an effect is called by its place: its slot's name, "converter" for a source that is one.
std::string_view kind_name(const Effect& effect);
/// Why a control has no place beside a source ("a governor is part of a synchronous machine, ..."), empty if
/// it has.
std::string misfit(const Effect& source, const Effect& control);

// ---- used by the generated registry only -------------------------------------------------------------
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

/// The records of M, each with the sources of its values.
template <class M>
constexpr auto sourced_parameters() {
  std::array<Parameter, std::size(M::parameters)> all{};
  std::copy(std::begin(M::parameters), std::end(M::parameters), all.begin());
  for (Parameter& p : all) {
    if constexpr (requires { M::standards_from; })
      if (!p.standard_from.given()) p.standard_from = M::standards_from;
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
                            [](const Parameter& p) { return p.standard_from.given(); }),
                "a standard value has no source: give standards_from, or one in the parameter's record");
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
  if constexpr (requires { M::at_shunt; }) e.at_shunt = &M::at_shunt;
  if constexpr (requires { M::elsewhere; }) e.elsewhere = M::elsewhere;
  e.check = +[](const void*, const double* p, const std::string& where, Problems& problems) {
    M::check(p, where, problems);
  };
  e.unphysical = &M::unphysical;
  if constexpr (requires { &M::remark; }) e.remark = &M::remark;
  if constexpr (requires { &M::instants; })
    e.instants = +[](const void*, const double* p) { return M::instants(p); };
  if constexpr (requires { &M::measure; }) e.measure = &M::measure;
  if constexpr (requires { &M::memory; }) e.memory = &M::memory;
  if constexpr (requires { &M::closed_form; }) e.closed_form = &M::closed_form;
  e.ops = make_all_ops<M>(static_cast<Scalars*>(nullptr));
  return e;
}

}  // namespace swingbank::sim
