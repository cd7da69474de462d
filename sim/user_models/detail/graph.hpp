#pragma once
// Expression graph of a user-defined model, with common subexpressions eliminated. Values that depend only on
// constants, parameters and given operating-point values are marked: they are evaluated once per run, not
// once per step.
#include <array>
#include <map>
#include <tuple>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/user_models/detail/expression.hpp"

namespace swingbank::sim::user_models {

/// A signal that a user-defined model may read; `name` is the field of Signals. Per-unit values refer to the
/// machine's MVA base and rated voltage.
struct SignalRecord {
  std::string_view name, meaning;
  Slot
      made_in;  ///< slot that computes the signal; only later slots may read it (machine signals: every slot)
};
inline constexpr std::array kSignals = {
    SignalRecord{"Vr", "terminal voltage, real part in the synchronous frame [pu]", Slot::machine},
    SignalRecord{"Vi", "terminal voltage, imaginary part in that frame [pu]", Slot::machine},
    SignalRecord{"V", "terminal voltage magnitude [pu]", Slot::machine},
    SignalRecord{"Ir", "current out of the machine, real part in that frame [pu]", Slot::machine},
    SignalRecord{"Ii", "current out of the machine, imaginary part in that frame [pu]", Slot::machine},
    SignalRecord{"P", "active power [pu]", Slot::machine},
    SignalRecord{"Q", "reactive power [pu]", Slot::machine},
    SignalRecord{"speed", "speed deviation [pu]", Slot::machine},
    SignalRecord{"Te", "electrical torque [pu]", Slot::machine},
    SignalRecord{"Ifd", "field current [pu]", Slot::machine},
    SignalRecord{"t", "time [s]", Slot::machine},
    SignalRecord{"Vc", "compensated voltage V_C (IEEE 421.5) [pu]", Slot::compensator},
    SignalRecord{"dVref", "change of the voltage reference, dVref [pu]", Slot::setpoint},
    SignalRecord{"dPref", "change of the governor's power reference, dPref [pu]", Slot::setpoint},
    SignalRecord{"Vs", "stabiliser output [pu]", Slot::stabiliser},
    SignalRecord{"Vlimiter", "sum of limiter outputs [pu]", Slot::limiter},
    SignalRecord{"Efd", "field voltage [pu]", Slot::exciter},
    SignalRecord{"Tm", "mechanical torque or power [pu]", Slot::governor}};
template <class T>
inline constexpr std::array<T Signals<T>::*, kSignals.size()> kMembers = {
    &Signals<T>::Vr,       &Signals<T>::Vi,  &Signals<T>::V,     &Signals<T>::Ir,    &Signals<T>::Ii,
    &Signals<T>::P,        &Signals<T>::Q,   &Signals<T>::speed, &Signals<T>::Te,    &Signals<T>::Ifd,
    &Signals<T>::t,        &Signals<T>::Vc,  &Signals<T>::dVref, &Signals<T>::dPref, &Signals<T>::Vs,
    &Signals<T>::Vlimiter, &Signals<T>::Efd, &Signals<T>::Tm};
/// Returns the index into kSignals, or -1 if no signal has that name.
int signal_index(std::string_view name);

/// Operation of a vertex on the values of its operands.
enum class Act : std::uint8_t {
  coefficient,  ///< c[index]: literal constant, parameter, or value evaluated at the operating point
  state,        ///< x[index]
  signal,       ///< s.*kMembers[index]
  add,
  subtract,
  multiply,
  divide,
  minimum,
  maximum,
  square_root,
  exponential,
  logarithm,
  sine,
  cosine,
  clamp,
  limit,  ///< clamp of a state to its own limits; ignored by the steady-state solution
  inverse,
  select_less,        ///< a < b ? c : d
  select_less_equal,  ///< a <= b ? c : d
  store               ///< only in compiled programs (program.hpp): stores a value
};
/// A vertex of the graph: an operation and its operands.
struct Vertex {
  Act act;
  int index = -1;  ///< index of the coefficient, state or signal
  std::array<int, 4> from = {-1, -1, -1, -1};
  /// Depends only on constants, parameters and given operating-point values, not on coefficients solved by
  /// steady().
  bool fixed = false;
  bool parameters = false;  ///< fixed, and independent of the operating point
};

/// Thrown when a user-defined model exceeds the maximum size.
struct TooLarge {};

/// Directed acyclic graph of a user-defined model's expressions. Methods that add a vertex return its index;
/// an existing equal vertex is reused.
class Graph {
 public:
  static constexpr std::size_t kMost = 4000;  ///< maximum number of vertices

  int constant(double value);
  /// Adds a fixed coefficient. `parameter`: independent of the operating point.
  int coefficient(int index, bool parameter);
  /// Adds a coefficient that steady() solves for; it is never fixed.
  int solved(int index) { return add(Vertex{Act::coefficient, index}); }
  int state(int index);
  int signal(int index);
  int make(Act act, int a, int b = -1, int c = -1, int d = -1);
  int negate(int a) { return make(Act::subtract, constant(0.0), a); }
  int power(int a, int exponent);
  int dead_band(int u, int width);

  [[nodiscard]] const std::vector<Vertex>& vertices() const { return vertices_; }
  [[nodiscard]] const Vertex& operator[](int i) const { return vertices_[static_cast<std::size_t>(i)]; }
  /// Returns the constants of the file as vertex index -> value.
  [[nodiscard]] const std::map<int, double>& constants() const { return constants_; }

 private:
  int add(Vertex vertex);
  std::vector<Vertex> vertices_;
  std::map<std::tuple<Act, int, std::array<int, 4>>, int> known_;
  std::map<double, int> by_value_;
  std::map<int, double> constants_;
};

}  // namespace swingbank::sim::user_models
