#include "validate/playin/driven_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "base/constants.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/tableau.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/detail/pairs.hpp"
#include "validate/playin/detail/recorded.hpp"
#include "validate/playin/given.hpp"

namespace swingbank::validate::playin {
namespace {

using sim::D8;
using Kind = Direction::Kind;

/// Height at t of the hat over knot k, straight to its neighbours.
double hat(const std::vector<double>& knots, std::size_t k, double t) {
  if (t < knots.front() || t > knots.back()) return 0.0;
  if (t < knots[k]) return k == 0 ? 0.0 : std::max(0.0, (t - knots[k - 1]) / (knots[k] - knots[k - 1]));
  if (k + 1 == knots.size()) return t == knots[k] ? 1.0 : 0.0;
  return std::max(0.0, (knots[k + 1] - t) / (knots[k + 1] - knots[k]));
}

constexpr double kRoughFrom = 1e-5;     ///< tolerance
constexpr double kShortestStep = 1e-9;  ///< [s]
constexpr double kCornerError = 1e-6;   ///< of a state, in a step across a corner of the equations

template <class T>
struct Seeds;  // what a scalar makes of directions
template <>
struct Seeds<double> {
  static void add(double&, std::size_t, double) {}
  static double slope(double, std::size_t) { return 0.0; }
  static double size(double x) { return std::abs(x); }
};
template <>
struct Seeds<D8> {
  static void add(D8& x, std::size_t direction, double by) { x.d[direction] += by; }
  static double slope(const D8& x, std::size_t direction) { return x.d[direction]; }
  /// Slopes count a hundredth: a fit forgives them more than a value.
  static double size(const D8& x) {
    double worst = std::abs(x.a);
    for (const double d : x.d) worst = std::max(worst, 1e-2 * std::abs(d));
    return worst;
  }
};

template <class T>
class Driven {
 public:
  Driven(const Drive& run, std::span<const Direction> directions)
      : run_(run),
        directions_(directions),
        equations_(*run.plant),
        scratch_(static_cast<std::size_t>(equations_.scratch())),
        recorded_(is_recorded(*run.plant)),
        breaker_(run.record->breaker()),
        isolated_(run.record->open_circuit()) {
    start();
    find_gate();
    const std::size_t n = x_.size();
    for (auto& k : k_) k.resize(n);
    trial_.resize(n);
    missed_.resize(n);
    allowed_.assign(n, run_.tolerance);
    for (std::size_t i = 0; i < run_.allowance.size(); ++i) allowed_[i] *= run_.allowance[i];
    collect_instants();
  }

  Response run() {
    Response back;
    back.slopes.resize(directions_.size());
    const record::Record& r = *run_.record;
    for (auto& values : back.value) values.reserve(r.t.size());
    for (auto& slope : back.slopes)
      for (auto& values : slope.value) values.reserve(r.t.size());
    const double slack = 1e-4 * r.step();  // as in VoltageCurve: a sample at a switching belongs before it
    t_ = r.t.front();
    for (const double sample : r.t) {
      if (sample > run_.until) break;
      while (next_ < instants_.size() && sample > instants_[next_].time + slack) pass_instant();
      advance(sample);
      record(back);
    }
    back.steps = steps_;
    return back;
  }

  /// Slopes of derivative and outputs at the start: by states, then by V and theta.
  LinearPlant linear() {
    const auto n = static_cast<Eigen::Index>(x_.size());
    Eigen::MatrixXd by(n + kOutputs, n + 2);
    const double to_record = run_.plant->mva / run_.record->base.mva;
    const Complex v = run_.start.voltage;
    for (Eigen::Index first = 0; first < n + 2; first += sim::kDirections) {
      const Eigen::Index count = std::min<Eigen::Index>(sim::kDirections, n + 2 - first);
      auto x = x_;
      for (T& value : x) value = value + T(1e-9);  // beside the corner that a dead-band of no width has
      T vr(v.real()), vi(v.imag());
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto d = static_cast<std::size_t>(i);
        if (first + i < n) Seeds<T>::add(x[static_cast<std::size_t>(first + i)], d, 1.0);
        const Complex slope = first + i == n ? v : first + i == n + 1 ? Complex(0, 1) * v : Complex();
        Seeds<T>::add(vr, d, slope.real());
        Seeds<T>::add(vi, d, slope.imag());
      }
      evaluate_at(vr, vi, run_.record->t.front(), x.data(), signals_, trial_.data());
      const auto out = outputs(to_record, x);
      for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < n + kOutputs; ++j)
          by(j, first + i) = Seeds<T>::slope(
              j < n ? trial_[static_cast<std::size_t>(j)] : out[static_cast<std::size_t>(j - n)],
              static_cast<std::size_t>(i));
    }
    if (breaker_) by.rightCols(2).setZero();  // the recorded voltage drives nothing
    return {by.topLeftCorner(n, n), by.topRightCorner(n, 2), by.bottomLeftCorner(kOutputs, n),
            by.bottomRightCorner(kOutputs, 2)};
  }

 private:
  struct Instant {
    double time;
    int switching;  ///< of the curve; -1: of an effect
  };

  void start() {
    const sim::plant::Plant& plant = *run_.plant;
    std::vector<std::vector<T>> p;
    for (const auto& block : sim::plant::block_parameters(plant)) p.emplace_back(block.begin(), block.end());
    const double to_machine = run_.record->base.mva / plant.mva;
    T P(run_.start.P * to_machine), Q(run_.start.Q * to_machine);
    T Efd(run_.start.Efd), Pm(run_.start.Pm * to_machine);
    each([&](const Direction& d, std::size_t i) {
      const auto [block, index] = d.parameter;
      if (d.kind == Kind::parameter)
        Seeds<T>::add(p[static_cast<std::size_t>(block)][static_cast<std::size_t>(index)], i, d.scale);
      if (isolated_ && (d.kind == Kind::P || d.kind == Kind::Q)) return;
      if (d.kind == Kind::P && recorded_) {
        Seeds<T>::add(Efd, i, d.scale);
        Seeds<T>::add(Pm, i, d.scale * to_machine);
      } else if (d.kind == Kind::P) {
        Seeds<T>::add(P, i, d.scale * to_machine);
      }
      if (d.kind == Kind::Q) Seeds<T>::add(Q, i, d.scale * to_machine);
    });
    if (recorded_) p.front() = recorded::standing<T>(Efd, T(run_.start.Ifd), Pm);
    auto at = sim::plant::operating_point_of<T>(plant, p, run_.start.voltage, P, Q, run_.conventions);
    c_ = std::move(at.c);
    x_ = std::move(at.x);
    Efd_ = at.Efd;
    Tm_ = at.Tm;
    has_torque_ = !run_.torque.t.empty();
    has_field_ = !run_.field.t.empty();
    if (plant.machine.effect->converter) return;  // it has no rotor that might stand elsewhere
    x_[0] = x_[0] + T(run_.angle);
    x_[1] = x_[1] + T(run_.speed);
    each([&](const Direction& d, std::size_t i) {
      if (d.kind == Kind::angle) Seeds<T>::add(x_[0], i, d.scale);
      if (d.kind == Kind::speed) Seeds<T>::add(x_[1], i, d.scale);
    });
  }
  /// The governor's state that is its gate or valve.
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
  void collect_instants() {
    const auto& switchings = run_.curve->switchings();
    for (std::size_t k = 0; k < switchings.size(); ++k)
      instants_.push_back({switchings[k].time, static_cast<int>(k)});
    const auto add = [&](double t) {
      if (t > run_.record->t.front() && t < run_.record->t.back()) instants_.push_back({t, -1});
    };
    for (const double t : sim::plant::instants_of(*run_.plant)) add(t);
    for (const record::StagedEvent& e : run_.record->staged) {
      if (e.opens_breaker()) continue;
      add(e.time);
      add(e.until);
    }
    std::ranges::stable_sort(instants_, {}, &Instant::time);
    look_ahead();
  }
  /// As seen from a frame that turns with the pre-event angle.
  Complex voltage(double t) const {
    if (breaker_) return run_.start.voltage;
    const Complex v = run_.voltage_factor * (*run_.curve)(segment_, t);
    return run_.start.drift == 0 ? v : v * std::polar(1.0, -run_.start.drift * t);
  }
  template <class F>
  void each(F f) const {
    for (std::size_t i = 0; i < directions_.size(); ++i) f(directions_[i], i);
  }

  /// Signals and derivative at states x and time t.
  void evaluate(double t, const T* x, sim::Signals<T>& s, T* dx) {
    const Complex v = voltage(t);
    evaluate_at(T(v.real()), T(v.imag()), t, x, s, dx);
  }
  void evaluate_at(T vr, T vi, double t, const T* x, sim::Signals<T>& s, T* dx) {
    s.Efd = Efd_;
    s.Tm = Tm_;
    s.dVref = T(0.0);
    s.dPref = T(0.0);
    s.t = T(std::min(t, last_moment_));
    s.Vpr = vr;
    s.Vpi = vi;
    stage(s);
    give(vr, vi, t, s);
    T er, ei, ir, ii;
    equations_.emf(c_.data(), x, scratch_.data(), er, ei);
    if (isolated_)
      without_current(x, er, ei, s);
    else
      equations_.from_grid(c_.data(), x, scratch_.data(), er, ei, s, ir, ii);
    if (!has_torque_ && !has_field_) return equations_.derivative(c_.data(), x, scratch_.data(), s, dx);
    equations_.derivative_with(c_.data(), x, scratch_.data(), added(run_.torque, Kind::torque, t),
                               added(run_.field, Kind::field, t), s, dx);
  }
  /// What was done to the plant.
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
  /// The terminal voltage at which no current flows.
  void without_current(const T* x, const T& er, const T& ei, sim::Signals<T>& s) {
    s.Ir = s.Ii = T(0.0);
    equations_.voltages(c_.data(), er, ei, s);
    if (!equations_.nonlinear()) return;
    const T* z = equations_.machine_impedance(c_.data());
    constexpr int kMostRounds = 60;
    for (int step = 0; step < kMostRounds; ++step) {
      equations_.current(c_.data(), x, scratch_.data(), s);
      s.Vr = s.Vr + z[0] * s.Ir - z[1] * s.Ii;
      s.Vi = s.Vi + z[0] * s.Ii + z[1] * s.Ir;
      if (std::hypot(sim::value_of(s.Ir), sim::value_of(s.Ii)) < 1e-13 && step > 2) break;
    }
    s.Ir = s.Ii = T(0.0);
  }
  /// What the record says of everything but the voltage.
  void give(const T& vr, const T& vi, double t, sim::Signals<T>& s) {
    if (!recorded_ && !run_.given) return;
    const Given::At at = run_.given ? (*run_.given)(segment_, t) : Given::standing(run_.start);
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
    each([&](const Direction& d, std::size_t i) {
      if (d.kind == kind)
        Seeds<T>::add(value, i, d.scale * hat(input.t, static_cast<std::size_t>(d.index), t));
    });
    return value;
  }

  /// Integrates to the next instant and over to its other side.
  void pass_instant() {
    const Instant at = instants_[next_];
    advance(at.time);
    const T* before = derivative_at(at.time, 0);
    ++next_;
    look_ahead();
    fresh_ = true;
    if (at.switching < 0) return;
    ++segment_;
    isolated_ = isolated_ || breaker_;
    const T* after = derivative_at(at.time, 1);
    each([&](const Direction& d, std::size_t i) {
      if (d.kind != Kind::switching || d.index != at.switching) return;
      for (std::size_t j = 0; j < x_.size(); ++j)
        Seeds<T>::add(x_[j], i, d.scale * (sim::value_of(before[j]) - sim::value_of(after[j])));
    });
  }
  /// Effects see at most the next instant less a moment.
  void look_ahead() {
    last_moment_ = next_ < instants_.size() ? instants_[next_].time - sim::plant::kBeforeSwitching : 1e300;
  }
  const T* derivative_at(double t, std::size_t keep) {
    evaluate(t, x_.data(), signals_, k_[keep].data());
    return k_[keep].data();
  }

  void advance(double to) {
    while (t_ < to) {
      const double left = to - t_;
      const bool reaches = h_ >= left * (1 - 1e-12);
      const double h = reaches ? left : h_;
      double error = attempt(h);
      if (error > 1 && std::isfinite(error) && (h <= run_.least_step || crosses_corner(h, error))) error = 1;
      if (error <= 1) {
        t_ = reaches ? to : t_ + h;
        std::swap(x_, trial_);
        std::swap(k_.front(), k_[static_cast<std::size_t>(pair_.stages - 1)]);
        T moved(0.0);
        equations_.clamp_states(c_.data(), x_.data(), moved);
        fresh_ = sim::value_of(moved) > 0;
      } else if (h < kShortestStep) {
        give_up();
      }
      const double factor =
          std::isfinite(error) ? std::clamp(0.9 * grown(error + 1e-12, pair_.exponent), 0.2, 5.0) : 0.2;
      const bool cut_short = reaches && error <= 1;  // short for the instant's sake, not the error's
      h_ = cut_short ? std::max(h_, h * factor) : h * factor;
      if (++steps_ > run_.step_limit) give_up();
    }
    t_ = std::max(t_, to);
  }
  /// Is the step so short, and what it misses so little, that nothing but a corner of the equations stands in
  /// the way (a state that runs into its limit)?
  [[nodiscard]] bool crosses_corner(double h, double error) const {
    return h < kShortestStep && error * run_.tolerance < kCornerError;
  }
  static double grown(double error, double exponent) {
    return sim::plant::dp54::rough_power(static_cast<float>(error), static_cast<float>(exponent));
  }
  /// Makes k_[0] and the signals those of the states as they stand.
  void refresh() {
    if (fresh_) evaluate(t_, x_.data(), signals_, k_[0].data());
    fresh_ = false;
  }
  double attempt(double h) {
    refresh();
    return &pair_ == &kRoughSteps
               ? attempt<kRoughSteps>(h, std::make_integer_sequence<int, kRoughSteps.stages - 1>{})
               : attempt<kFineSteps>(h, std::make_integer_sequence<int, kFineSteps.stages - 1>{});
  }
  template <const Pair& pair, int... Before>
  double attempt(double h, std::integer_sequence<int, Before...>) {
    (stage<pair, Before + 1>(h), ...);
    return scaled_error<pair>(h);
  }
  /// Sum of the first stages' derivatives with the weights of a row (-1: those of the error), of a number: a
  /// state, or one of its slopes.
  template <const Pair& pair, int row, int last>
  double weighted(std::size_t number) const {
    constexpr double weight = row < 0 ? pair.error[last] : pair.a[row < 0 ? 0 : row][row < 0 ? 0 : last];
    if constexpr (last == 0) {
      return weight * numbers(k_[0])[number];
    } else {
      const double before = weighted<pair, row, last - 1>(number);
      if constexpr (weight == 0.0) return before;
      return before + weight * numbers(k_[last])[number];
    }
  }
  template <const Pair& pair, int at>
  void stage(double h) {
    const double* x = numbers(x_);
    double* trial = numbers(trial_);
    const std::size_t count = x_.size() * kNumbers;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) trial[i] = x[i] + h * weighted<pair, at, at - 1>(i);
    evaluate(t_ + pair.c[at] * h, trial_.data(), signals_, k_[at].data());
  }
  template <const Pair& pair>
  double scaled_error(double h) {
    double* missed = numbers(missed_);
    const std::size_t count = x_.size() * kNumbers;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) missed[i] = weighted<pair, -1, pair.stages - 1>(i);
    double worst = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double ratio =
          h * Seeds<T>::size(missed_[i]) / (allowed_[i] * (1 + std::abs(sim::value_of(x_[i]))));
      if (!std::isfinite(ratio)) return ratio;
      worst = std::max(worst, ratio);
    }
    return worst;
  }
  /// The states one after the other, each a value and its slopes: sums of steps are the same for all of them.
  static constexpr std::size_t kNumbers = sizeof(T) / sizeof(double);
  static_assert(kNumbers * sizeof(double) == sizeof(T) && std::is_trivially_copyable_v<T>);
  static double* numbers(std::vector<T>& states) { return reinterpret_cast<double*>(states.data()); }
  static const double* numbers(const std::vector<T>& states) {
    return reinterpret_cast<const double*>(states.data());
  }

  void record(Response& back) {
    refresh();
    const double to_record = run_.plant->mva / run_.record->base.mva;
    // the frame turns with the pre-event angle
    const double frame = run_.start.drift / (constants::turn * run_.conventions.frequency);
    back.voltage.push_back(voltage(t_));
    auto out = outputs(to_record, x_);
    out[static_cast<std::size_t>(Output::speed)] = signals_.speed + T(frame);
    for (int o = 0; o < kOutputs; ++o) {
      back.value[o].push_back(sim::value_of(out[static_cast<std::size_t>(o)]));
      for (std::size_t d = 0; d < directions_.size(); ++d)
        back.slopes[d].value[o].push_back(Seeds<T>::slope(out[static_cast<std::size_t>(o)], d));
    }
  }
  /// By the signals as they stand.
  std::array<T, kOutputs> outputs(double to_record, const std::vector<T>& x) const {
    T P, Q;
    equations_.grid_power(c_.data(), signals_, P, Q);
    return {P * T(to_record),
            Q * T(to_record),
            signals_.speed,
            signals_.Efd,
            signals_.Ifd,
            signals_.Tm * T(to_record),
            gate_ < 0 ? T(0.0) : x[static_cast<std::size_t>(gate_)],
            equations_.grid_magnitude(signals_, signals_.Vpr, signals_.Vpi)};
  }
  [[noreturn]] void give_up() const {
    throw InputError({"play-in stops", fmt::format("t = {:.4f} s", t_),
                      "the plant's equations cannot be integrated further with this voltage",
                      "check the parameters (time constants, limits) and the record at that time"});
  }

  const Drive& run_;
  const Pair& pair_ = run_.tolerance < kRoughFrom ? kFineSteps : kRoughSteps;
  bool fresh_ = true;  ///< k_[0] must be evaluated anew
  std::span<const Direction> directions_;
  sim::plant::PlantEquations<T> equations_;
  std::vector<T> c_, x_, trial_, missed_, scratch_;
  std::array<std::vector<T>, 7> k_;
  std::vector<double> allowed_;  ///< error of each state per step, relative to 1 + |state|
  T Efd_, Tm_;
  sim::Signals<T> signals_;
  bool recorded_;
  const record::StagedEvent* breaker_;
  bool isolated_;  ///< from the grid, now
  bool has_torque_ = false, has_field_ = false;
  int gate_ = -1;  ///< state that is compared with a recorded gate
  std::vector<Instant> instants_;
  std::size_t next_ = 0;
  int segment_ = 0, steps_ = 0;
  double t_ = 0, h_ = 1e-3, last_moment_ = 1e300;
};

}  // namespace

double PiecewiseLinear::operator()(double at) const {
  if (t.empty() || at < t.front() || at > t.back()) return 0.0;
  if (t.size() == 1) return value.front();
  const auto above = std::upper_bound(t.begin() + 1, t.end() - 1, at);
  const auto k = static_cast<std::size_t>(above - t.begin()) - 1;
  const double share = (at - t[k]) / (t[k + 1] - t[k]);
  return (1 - share) * value[k] + share * value[k + 1];
}

std::string_view output_name(Output output) {
  constexpr std::array<std::string_view, kOutputs> names = {"P",   "Q",  "speed", "Efd",
                                                            "Ifd", "Pm", "gate",  "V"};
  return names[static_cast<std::size_t>(output)];
}

LinearPlant linearise(const Drive& run) { return Driven<D8>(run, {}).linear(); }

Response drive(const Drive& run, std::span<const Direction> directions) {
  if (directions.empty()) return Driven<double>(run, {}).run();
  Response all;
  constexpr std::size_t kSeedsAtOnce = sim::kDirections;
  for (std::size_t first = 0; first < directions.size(); first += kSeedsAtOnce) {
    Response some =
        Driven<D8>(run, directions.subspan(first, std::min(kSeedsAtOnce, directions.size() - first))).run();
    if (first == 0) {
      all = std::move(some);
      continue;
    }
    std::ranges::move(some.slopes, std::back_inserter(all.slopes));
    all.steps += some.steps;
  }
  return all;
}

}  // namespace swingbank::validate::playin
