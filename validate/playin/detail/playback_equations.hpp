#pragma once
// Equations of a plant with prescribed voltage: signals, derivatives and outputs at given states and time.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sim/plant/equations.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/detail/recorded.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Returns the value at t of the piecewise linear hat function of knot k.
inline double hat(const std::vector<double>& knots, std::size_t k, double t) {
  if (t < knots.front() || t > knots.back()) return 0.0;
  if (t < knots[k]) return k == 0 ? 0.0 : std::max(0.0, (t - knots[k - 1]) / (knots[k] - knots[k - 1]));
  if (k + 1 == knots.size()) return t == knots[k] ? 1.0 : 0.0;
  return std::max(0.0, (knots[k + 1] - t) / (knots[k + 1] - knots[k]));
}

/// Access to the sensitivities of a scalar; does nothing for types without sensitivities.
template <class T>
struct Seeds {
  static void add(T&, std::size_t, double) {}
  static double get(const T&, std::size_t) { return 0.0; }
  static double size(const T& x) { return std::abs(sim::value_of(x)); }
};
template <>
struct Seeds<sim::D8> {
  static void add(sim::D8& x, std::size_t parameter, double by) {
    const int k = static_cast<int>(parameter);
    x.d.set(k, x.d[k] + by);
  }
  static double get(const sim::D8& x, std::size_t parameter) { return x.d[static_cast<int>(parameter)]; }
  /// Returns the magnitude for error control. Sensitivities are weighted by 0.01, because a fit tolerates
  /// larger errors in sensitivities.
  static double size(const sim::D8& x) {
    double worst = std::abs(x.a);
    for (int k = 0; k < sim::kSensitivities; ++k) worst = std::max(worst, 1e-2 * std::abs(x.d[k]));
    return worst;
  }
};

/// Conditions on one side of a switching time.
struct Side {
  int segment = 0;             ///< of the voltage curve
  double last_moment = 1e300;  ///< largest time that the effects' equations receive [s]
  bool isolated = false;       ///< disconnected from the grid
};

/// Equations of one run with scalars of type T.
template <class T>
class PlaybackEquations {
 public:
  using Kind = SensitivityParameter::Kind;

  /// Constructs the equations at the operating point, with sensitivities if T has them.
  PlaybackEquations(const PlaybackRun& run, std::span<const SensitivityParameter> parameters)
      : PlaybackEquations(run, parameters, sim::plant::OperatingOf<T>{}) {
    start();
  }
  /// Constructs the equations from a known operating point.
  PlaybackEquations(const PlaybackRun& run, std::span<const SensitivityParameter> parameters,
                    sim::plant::OperatingOf<T> at)
      : c(std::move(at.c)),
        x0(std::move(at.x)),
        Efd(at.Efd),
        Tm(at.Tm),
        run_(run),
        parameters_(parameters),
        equations_(*run.plant),
        scratch_(static_cast<std::size_t>(equations_.scratch())),
        recorded_(is_recorded(*run.plant)),
        breaker_(run.record->breaker() != nullptr) {
    side.isolated = run.record->open_circuit();
    has_torque_ = !run_.torque.t.empty();
    has_field_ = !run_.field.t.empty();
    find_gate();
  }

  Side side;
  std::vector<T> c, x0;                 ///< coefficients; initial states
  T Efd, Tm;                            ///< constant if there is no exciter or no governor
  T more_torque{0.0}, more_field{0.0};  ///< offsets of the inputs
  sim::Signals<T> signals;              ///< of the last evaluation

  [[nodiscard]] const sim::plant::PlantEquations<T>& of_plant() const { return equations_; }
  template <class F>
  void each(F f) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i) f(parameters_[i], i);
  }
  /// Moves to the other side of a switching of the curve. An angle jump of the voltage that the record lacks
  /// is applied to the rotor with opposite sign, because only the angle between voltage and rotor matters.
  void pass(int switching, T* x) {
    ++side.segment;
    side.isolated = side.isolated || breaker_;
    if (!has_rotor()) return;
    x[0] = x[0] - T(run_.curve->switchings()[static_cast<std::size_t>(switching)].turn);
    each([&](const SensitivityParameter& d, std::size_t i) {
      if (d.kind == Kind::turn && d.index == switching) Seeds<T>::add(x[0], i, -d.scale);
    });
  }
  /// Returns whether the machine has a rotor angle; a converter and a recorded machine have none.
  [[nodiscard]] bool has_rotor() const { return !recorded_ && !run_.plant->machine.effect->converter; }
  /// Returns the voltage [pu] in a frame that rotates with the pre-event angle.
  [[nodiscard]] Complex voltage(double t) {
    if (breaker_) return run_.start.voltage;
    if (t == voltage_at_ && side.segment == voltage_segment_) return voltage_;
    voltage_at_ = t;
    voltage_segment_ = side.segment;
    voltage_ = run_.voltage_factor * (*run_.curve)(side.segment, t);
    if (run_.start.drift != 0) voltage_ = voltage_ * std::polar(1.0, -run_.start.drift * t);
    return voltage_;
  }
  /// Computes signals and derivatives at states x and time t.
  void evaluate(double t, const T* x, T* dx) {
    const Complex v = voltage(t);
    evaluate_at(T(v.real()), T(v.imag()), t, x, dx);
  }
  void evaluate_at(T vr, T vi, double t, const T* x, T* dx) {
    sim::Signals<T>& s = signals;
    s.Efd = Efd;
    s.Tm = Tm;
    s.dVref = T(0.0);
    s.dPref = T(0.0);
    s.t = T(std::min(t, side.last_moment));
    s.Vpr = vr;
    s.Vpi = vi;
    stage(s);
    give(vr, vi, t, s);
    T er, ei, ir, ii;
    equations_.emf(c.data(), x, scratch_.data(), er, ei);
    if (side.isolated)
      without_current(x, er, ei, s);
    else
      equations_.from_grid(c.data(), x, scratch_.data(), er, ei, s, ir, ii);
    if (!has_torque_ && !has_field_) return equations_.derivative(c.data(), x, scratch_.data(), s, dx);
    equations_.derivative_with(c.data(), x, scratch_.data(),
                               added(run_.torque, Kind::torque, std::min(t, side.last_moment)) + more_torque,
                               added(run_.field, Kind::field, std::min(t, side.last_moment)) + more_field, s,
                               dx);
  }
  /// Returns the outputs at the last evaluated signals.
  [[nodiscard]] std::array<T, kOutputs> outputs(const T* x) const {
    const T to_record(run_.plant->mva / run_.record->base.mva);
    T P, Q;
    equations_.grid_power(c.data(), signals, P, Q);
    return {P * to_record,
            Q * to_record,
            signals.speed,
            signals.Efd,
            signals.Ifd,
            signals.Tm * to_record,
            gate_ < 0 ? T(0.0) : x[gate_],
            equations_.grid_magnitude(signals, signals.Vpr, signals.Vpi)};
  }

 private:
  void start() {
    const sim::plant::Plant& plant = *run_.plant;
    std::vector<std::vector<T>> p;
    for (const auto& block : sim::plant::block_parameters(plant)) p.emplace_back(block.begin(), block.end());
    const double to_machine = run_.record->base.mva / plant.mva;
    T P(run_.start.P * to_machine), Q(run_.start.Q * to_machine);
    T field(run_.start.Efd), Pm(run_.start.Pm * to_machine);
    each([&](const SensitivityParameter& d, std::size_t i) {
      const auto [block, index] = d.parameter;
      if (d.kind == Kind::parameter)
        Seeds<T>::add(p[static_cast<std::size_t>(block)][static_cast<std::size_t>(index)], i, d.scale);
      if (side.isolated && (d.kind == Kind::P || d.kind == Kind::Q)) return;
      if (d.kind == Kind::P && recorded_) {
        Seeds<T>::add(field, i, d.scale);
        Seeds<T>::add(Pm, i, d.scale * to_machine);
      } else if (d.kind == Kind::P) {
        Seeds<T>::add(P, i, d.scale * to_machine);
      }
      if (d.kind == Kind::Q) Seeds<T>::add(Q, i, d.scale * to_machine);
    });
    if (recorded_) p.front() = recorded::operating_parameters<T>(field, T(run_.start.Ifd), Pm);
    auto at = sim::plant::operating_point_of<T>(plant, p, run_.start.voltage, P, Q, run_.conventions);
    c = std::move(at.c);
    x0 = std::move(at.x);
    Efd = at.Efd;
    Tm = at.Tm;
    if (plant.machine.effect->converter) return;
    x0[0] = x0[0] + T(run_.angle);
    x0[1] = x0[1] + T(run_.speed);
    each([&](const SensitivityParameter& d, std::size_t i) {
      if (d.kind == Kind::angle) Seeds<T>::add(x0[0], i, d.scale);
      if (d.kind == Kind::speed) Seeds<T>::add(x0[1], i, d.scale);
    });
  }
  /// Finds the governor's state that is its gate, valve or fuel flow.
  void find_gate() {
    std::size_t state = run_.plant->machine.effect->states.size();
    for (const auto& block : run_.plant->controls)
      for (const auto& s : block.effect->states) {
        if (block.effect->slot == sim::Slot::governor &&
            (s.name == "gate" || s.name == "valve" || s.name == "fuel"))
          gate_ = static_cast<int>(state);
        ++state;
      }
  }
  /// Applies the staged events.
  void stage(sim::Signals<T>& s) const {
    using Staged = record::StagedEvent::Kind;
    for (const record::StagedEvent& e : run_.record->staged) {
      const double t = sim::value_of(s.t);
      if (e.opens_breaker() || t < e.time || t >= e.until) continue;
      if (e.kind == Staged::vref_step) s.dVref = s.dVref + T(e.size);
      if (e.kind == Staged::efd_step) s.Efd = s.Efd + T(e.size);
      if (e.kind == Staged::pref_step)
        s.dPref = s.dPref + T(e.size * run_.record->base.mva / run_.plant->mva);
    }
  }
  /// Computes the terminal voltage at zero current.
  void without_current(const T* x, const T& er, const T& ei, sim::Signals<T>& s) {
    s.Ir = s.Ii = T(0.0);
    equations_.voltages(c.data(), er, ei, s);
    if (!equations_.nonlinear()) return;
    const T* z = equations_.machine_impedance(c.data());
    constexpr int kMostRounds = 60;
    for (int step = 0; step < kMostRounds; ++step) {
      equations_.current(c.data(), x, scratch_.data(), s);
      s.Vr = s.Vr + z[0] * s.Ir - z[1] * s.Ii;
      s.Vi = s.Vi + z[0] * s.Ii + z[1] * s.Ir;
      if (std::hypot(sim::value_of(s.Ir), sim::value_of(s.Ii)) < 1e-13 && step > 2) break;
    }
    s.Ir = s.Ii = T(0.0);
  }
  /// Applies the recorded inputs other than the voltage.
  void give(const T& vr, const T& vi, double t, sim::Signals<T>& s) {
    if (!recorded_ && !run_.given) return;
    const Given::At at = run_.given ? (*run_.given)(side.segment, t) : Given::steady_values(run_.start);
    const double to_machine = run_.record->base.mva / run_.plant->mva;
    s.Efd = s.Efd + T(at.Efd);
    s.Tm = s.Tm + T(at.Pm * to_machine);
    s.dVref = s.dVref + T(at.Vref);
    s.dPref = s.dPref + T(at.Pref * to_machine);
    if (!recorded_) return;
    const T P(at.P * to_machine), Q(at.Q * to_machine), per_square = T(1.0) / (vr * vr + vi * vi);
    s.Ir = (vr * P + vi * Q) * per_square;
    s.Ii = (vi * P - vr * Q) * per_square;
    scratch_[recorded::speed] = T(at.speed);
    scratch_[recorded::dIfd] = T(at.Ifd);
    scratch_[recorded::Vs] = T(at.Vs);
  }
  T added(const PiecewiseLinear& input, Kind kind, double t) const {
    T value(input(t));
    each([&](const SensitivityParameter& d, std::size_t i) {
      if (d.kind == kind)
        Seeds<T>::add(value, i, d.scale * hat(input.t, static_cast<std::size_t>(d.index), t));
    });
    return value;
  }

  const PlaybackRun& run_;
  std::span<const SensitivityParameter> parameters_;
  sim::plant::PlantEquations<T> equations_;
  std::vector<T> scratch_;
  bool recorded_, breaker_;  ///< whether the machine is the recorded one; whether its breaker opens
  bool has_torque_ = false, has_field_ = false;
  int gate_ = -1;    ///< index of the state compared with a recorded gate
  Complex voltage_;  ///< cached voltage of the last call
  double voltage_at_ = std::numeric_limits<double>::quiet_NaN();
  int voltage_segment_ = 0;
};

}  // namespace swingbank::validate::playin
