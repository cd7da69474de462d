#pragma once
// Simulation of one plant with a prescribed terminal voltage (playback). No network model is needed, because
// the voltage contains the network's effect. The same equations run on doubles for the response, and on dual
// numbers for its sensitivities. These are sensitivities to parameters, switching times, initial state, and
// unmodelled torque or field voltage.
#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "sim/plant/parameter_id.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::playin {

/// Mean terminal quantities before the event: the model's operating point.
struct OperatingPoint {
  int samples = 0;      ///< length of the pre-event window, from the record's first sample
  Complex voltage;      ///< at t = 0 of the record [pu]
  double P = 0, Q = 0;  ///< [pu on the record's base]
  /// Recorded inputs of a component, Pm and Pref on the record's base; speed as deviation from nominal.
  double Efd = 0, Ifd = 0, Pm = 0, speed = 0, Vs = 0, Vref = 0, Pref = 0;  ///< [pu]
  double drift = 0;  ///< rate of theta [rad/s]; 0 if it does not exceed the noise
};

/// Piecewise linear function of time through (t[k], value[k]), zero outside.
struct PiecewiseLinear {
  std::vector<double> t, value;  ///< t [s], increasing; the knots of the hat functions (sensitivities)
  /// Returns the value at time `at` [s].
  [[nodiscard]] double operator()(double at) const;
};

/// Outputs of the plant at each sample of the record.
enum class Output { P, Q, speed, Efd, Ifd, Pm, gate, V };
constexpr int kOutputs = 8;  ///< number of outputs
/// Returns the name of an output, "Pm".
std::string_view output_name(Output output);
/// Returns an output's values in a record or in a Playback; empty if it was not recorded or not computed.
template <class Channels>
auto& output_of(Channels& channels, Output output) {
  switch (output) {
    case Output::P:
      return channels.P;
    case Output::Q:
      return channels.Q;
    case Output::speed:
      return channels.speed;
    case Output::Efd:
      return channels.Efd;
    case Output::Pm:
      return channels.Pm;
    case Output::gate:
      return channels.gate;
    case Output::V:
      return channels.V;
    case Output::Ifd:
      break;
  }
  return channels.Ifd;
}

class Given;
class TrajectoryCache;

/// Specification of one run: plant, inputs and initial state. If the record's breaker opens, the voltage is
/// constant until the first switching. From then on, the current is zero and the plant determines V; in an
/// open circuit this holds from the start. P, Q and Pm of the response are per unit on the record's base, the
/// other outputs on the machine's.
struct PlaybackRun {
  const sim::plant::Plant* plant = nullptr;  ///< plant that is simulated
  sim::Conventions conventions = {};         ///< conventions of the simulator
  const record::Record* record = nullptr;    ///< record whose voltage is played in
  const VoltageCurve* curve = nullptr;       ///< played-in voltage
  Complex voltage_factor = 1;                ///< factor on the curve
  OperatingPoint start = {};                 ///< operating point before the event
  const Given* given =
      nullptr;  ///< further inputs of a component (given.hpp); null: constant at their initial values
  double angle = 0, speed = 0;              ///< offsets of rotor angle and speed from equilibrium [rad], [pu]
  PiecewiseLinear torque = {}, field = {};  ///< added to Tm, Efd [pu]
  double tolerance = 1e-10;                 ///< error per step, relative to 1 + |state|
  std::vector<double> allowance = {};       ///< factor on the tolerance, for each state; empty: 1
  double until = 1e300;                     ///< later samples are not simulated [s]
  double least_step = 0.0;     ///< steps up to this length are accepted whatever their error [s]; 0: none
  int step_limit = 2'000'000;  ///< maximum number of steps
  /// Outputs whose sensitivities are computed from the plant linearised along the trajectory. At a tolerance
  /// of 1e-5 they have errors of a few per cent, at a fraction of the cost. Empty: sensitivities of every
  /// output by differentiation of each step, which at limits need a tolerance of 1e-9.
  std::vector<Output> linear_sensitivities = {};
  /// Trajectory cache: a run without sensitivities stores its trajectory here, and the same run with linear
  /// sensitivities reuses it. The cache must be reset when another member of the run changes. Null: no cache.
  std::shared_ptr<const TrajectoryCache>* cache = nullptr;
};

/// Sensitivity parameter; `scale` is its unit, and sensitivities are per such unit.
struct SensitivityParameter {
  /// Kind of a sensitivity parameter.
  enum class Kind {
    parameter,  ///< `parameter` of the plant
    switching,  ///< switching time `index` of the curve [s]
    turn,       ///< jump of the voltage's angle at switching `index` of the curve [rad]
    P,          ///< initial P [pu on the record's base]; with a recorded machine, initial Efd and Pm
    Q,          ///< initial Q [pu on the record's base]
    angle,      ///< initial angle [rad]
    speed,      ///< initial speed [pu]
    torque,     ///< hat function `index` of PlaybackRun::torque [pu]
    field,      ///< hat function `index` of PlaybackRun::field [pu]
  };
  Kind kind;                               ///< kind of the parameter
  sim::plant::ParameterId parameter = {};  ///< of Kind::parameter
  int index = 0;                           ///< of a switching time or knot
  double scale = 1.0;                      ///< unit of the parameter, in the kind's own unit
  /// Compares all members.
  friend bool operator==(const SensitivityParameter&, const SensitivityParameter&) = default;
};

/// Response [output][sample] and sensitivities [parameter][output][sample]; outputs without requested
/// sensitivities have none.
struct Response {
  std::vector<double> value[kOutputs];  ///< [output][sample]; units as for PlaybackRun
  /// Sensitivities to one parameter.
  struct Sensitivity {
    std::vector<double> value[kOutputs];
    ///< [output][sample], per unit of the parameter; empty: not requested
  };
  std::vector<Sensitivity> sensitivities;  ///< [parameter], in the order of the request
  std::vector<Complex> voltage;            ///< played-in voltage at each sample [pu]
  int steps = 0;                           ///< number of integration steps
  /// Returns the samples of an output.
  [[nodiscard]] const std::vector<double>& of(Output o) const { return value[static_cast<int>(o)]; }
};

/// Returns the plant's response to the curve. Steps end at every sample, at every switching of the curve, at
/// every switching time of an effect, and at the start and end of every staged event. If a switching time is
/// a sensitivity parameter, the sensitivities to this time have a step there, equal to the difference of the
/// derivatives before and after it. Throws InputError if the operating point has no steady state or the
/// integration fails.
Response simulate_playback(const PlaybackRun& run, std::span<const SensitivityParameter> parameters = {});

/// Inputs of a plant's controls at one point of a run, at the machine's terminal and on its base.
struct Seen {
  double t;           ///< [s]
  int segment;        ///< of the voltage curve
  Complex V, I;       ///< voltage, current out of the machine [pu]
  double speed, Ifd;  ///< [pu]
  double Efd, Tm;     ///< at the machine, added inputs included [pu]
};
/// Inputs of a plant's controls along a run.
struct SeenAlong {
  Seen steady;             ///< at the operating point, in steady state
  std::vector<Seen> seen;  ///< along the run
};
/// Returns the inputs of the controls at every sample and integration step, on both sides of every switching
/// time, and at `times` [s] (ascending). Throws as simulate_playback().
SeenAlong seen_along(const PlaybackRun& run, std::span<const double> times = {});

/// Linearised plant about a run's start: \f$x' = A x + B u\f$, \f$y = C x + D u\f$ with u = (relative change
/// of V, change of theta [rad]) and y = all outputs in the units of Response.
struct LinearPlant {
  Eigen::MatrixXd A, B, C, D;  ///< system, input, output and feedthrough matrix
};
/// Linearises the plant about the run's start. Throws InputError if the operating point has no steady state.
LinearPlant linearise(const PlaybackRun& run);
/// Returns the derivative of each state's rate of change with respect to the run's torque or field, at the
/// start [1/s per pu]; zero if the run has neither of these inputs. Throws as linearise().
Eigen::VectorXd rates_by_input(const PlaybackRun& run, SensitivityParameter::Kind input);

}  // namespace swingbank::validate::playin
