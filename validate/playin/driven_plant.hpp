#pragma once
// One plant driven by a terminal voltage: no network is needed, what the network did is in the voltage. The
// same equations run on doubles (what does the plant answer?) and on duals (and how does the answer move with
// parameters, switching instants, the start, and torque or field voltage that no model explains?).
#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "sim/plant/parameter_id.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::playin {

/// Mean terminal state before the event: where the model starts.
struct OperatingPoint {
  int samples = 0;      ///< of the pre-event window, from the record's first
  Complex voltage;      ///< at t = 0 of the record [pu]
  double P = 0, Q = 0;  ///< [pu on the record's base]
  /// Of a component: what its record has of them, on the record's base and as deviation from nominal (speed).
  double Efd = 0, Ifd = 0, Pm = 0, speed = 0, Vs = 0, Vref = 0, Pref = 0;
  double drift = 0;  ///< slope of theta [rad/s]; 0 where it cannot be told from noise
};

/// A function of time through (t[k], value[k]), straight between them, zero outside.
struct PiecewiseLinear {
  std::vector<double> t, value;    ///< t [s], increasing
  std::vector<double> knots = {};  ///< of the hats that its directions are [s]; empty: t
  [[nodiscard]] double operator()(double at) const;
  [[nodiscard]] const std::vector<double>& hats() const { return knots.empty() ? t : knots; }
};

/// What the plant answers at each sample of the record.
enum class Output { P, Q, speed, Efd, Ifd, Pm, gate, V };
constexpr int kOutputs = 8;
std::string_view output_name(Output output);

class Given;
class Past;

/// One run: who is driven, by what, from where. Where the record's breaker opens, the voltage stands still
/// until the first switching; from then on, in an open circuit from the start, no current flows and V is the
/// plant's own. P, Q and Pm of the answer are per unit on the record's base,
/// the other outputs on the machine's.
struct Drive {
  const sim::plant::Plant* plant = nullptr;
  sim::Conventions conventions = {};
  const record::Record* record = nullptr;
  const VoltageCurve* curve = nullptr;
  Complex voltage_factor = 1;  ///< what the curve is multiplied by
  OperatingPoint start = {};
  const Given* given = nullptr;  ///< what else drives a component (given.hpp); none: it stays at the start
  double angle = 0, speed = 0;   ///< offset of the first two states from equilibrium [rad], [pu]
  PiecewiseLinear torque = {}, field = {};  ///< added to Tm, Efd [pu]
  double tolerance = 1e-10;                 ///< error per step, relative to 1 + |state|
  std::vector<double> allowance = {};       ///< factor on the tolerance, for each state; empty: 1
  double until = 1e300;                     ///< samples after it are left out [s]
  double least_step = 0.0;                  ///< steps this short are taken whatever their error; 0: never [s]
  int step_limit = 2'000'000;               ///< steps before it gives up
  /// Slopes of these outputs alone, and of the plant as it is linear about each end of a step: a per cent or
  /// two off, for a fraction of the cost. None: the answer's own, of every output.
  std::vector<Output> linear_slopes = {};
  bool instants_stand = false;  ///< the answer's own slopes leave out that a guard's instant moves
  /// A run without directions leaves here where it went, and the same run with linear slopes goes on from
  /// there. Whoever changes the run empties it. Null: nothing is kept.
  std::shared_ptr<const Past>* past = nullptr;
};

/// What a slope is taken along; `scale` is one unit of the direction, and slopes are per such unit.
struct Direction {
  enum class Kind {
    parameter,  ///< `parameter` of the plant
    switching,  ///< instant `index` of the curve [s]
    turn,       ///< of the voltage's angle at that instant [rad]
    P,          ///< of the operating point [pu on the record's base]; of a component Efd and Pm
    Q,          ///< likewise
    angle,      ///< at the start [rad]
    speed,      ///< at the start [pu]
    torque,     ///< hat `index` of Drive::torque [pu]
    field,      ///< hat `index` of Drive::field [pu]
  };
  Kind kind;
  sim::plant::ParameterId parameter = {};  ///< of Kind::parameter
  int index = 0;                           ///< of an instant or knot
  double scale = 1.0;
  friend bool operator==(const Direction&, const Direction&) = default;
};

/// Answer [output][sample], and slopes [direction][output][sample]; none of an output that no slopes were
/// asked of.
struct Response {
  std::vector<double> value[kOutputs];
  struct Slope {
    std::vector<double> value[kOutputs];
  };
  std::vector<Slope> slopes;
  std::vector<Complex> voltage;  ///< that drove the plant, per sample [pu]
  int steps = 0;                 ///< of the integrator
  [[nodiscard]] const std::vector<double>& of(Output o) const { return value[static_cast<int>(o)]; }
};

/// Plays the curve into the plant. Steps end at every sample, switching and instant of an effect; at a
/// switching instant that is a direction, slopes jump by the difference of the derivatives on its two sides.
/// Throws InputError if the operating point cannot be held or the equations cannot be integrated.
Response drive(const Drive& run, std::span<const Direction> directions = {});

/// Inputs of a plant's controls at one point of a run, at the machine's terminal and on its base.
struct Seen {
  double t;           ///< [s]
  int segment;        ///< of the voltage curve
  Complex V, I;       ///< voltage, current out of the machine [pu]
  double speed, Ifd;  ///< [pu]
  double Efd, Tm;     ///< that drive the machine, inputs included [pu]
};
struct SeenAlong {
  Seen standing;           ///< at the operating point, in steady state
  std::vector<Seen> seen;  ///< along the run
};
/// At every sample and integration step, on both sides of every switching time, and at these times [s]
/// (ascending). Throws as drive().
SeenAlong seen_along(const Drive& run, std::span<const double> times = {});

/// How the plant moves about a run's start: x' = A x + B u, y = C x + D u with u = (change of V over V,
/// change of theta [rad]) and y = all outputs, in the units of Response.
struct LinearPlant {
  Eigen::MatrixXd A, B, C, D;
};
/// Throws InputError if the operating point cannot be held.
LinearPlant linearise(const Drive& run);
/// How fast each state follows 1 pu of the run's torque or field at the start [1/s]. Throws as linearise().
Eigen::VectorXd rates_by_input(const Drive& run, Direction::Kind input);

}  // namespace swingbank::validate::playin
