#include "validate/playin/plant_playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "base/constants.hpp"
#include "base/stop_signal.hpp"
#include "validate/playin/detail/hermite.hpp"
#include "validate/playin/detail/linear_sensitivities.hpp"
#include "validate/playin/detail/pairs.hpp"
#include "validate/playin/detail/playback_equations.hpp"

namespace swingbank::validate::playin {
namespace {

using sim::D8;
using Kind = SensitivityParameter::Kind;

constexpr double kCornerError = 1e-6;  ///< accepted error of a state in a step across a corner
constexpr double kTimeError = 1e-8;    ///< accuracy of the time at which the equations are discontinuous [s]
constexpr double kRateOver = 1e-6;  ///< interval of the difference that gives a guard's rate at its zero [s]

template <class T>
class Solver {
 public:
  Solver(const PlaybackRun& run, std::span<const SensitivityParameter> parameters)
      : run_(run), parameters_(parameters), equations_(run, parameters), x_(equations_.x0) {
    const std::size_t n = x_.size();
    for (auto& k : k_) k.resize(n);
    trial_.resize(n);
    missed_.resize(n);
    allowed_.assign(n, run_.tolerance);
    for (std::size_t i = 0; i < run_.allowance.size(); ++i) allowed_[i] *= run_.allowance[i];
    const auto guards = static_cast<std::size_t>(equations_.of_plant().guards());
    guards_.resize(guards);
    guards_at_end_.resize(guards);
    collect_switching_times();
  }

  /// Runs the simulation; `trace`, if given, receives the trajectory.
  Response run(Trace* trace = nullptr) {
    trace_ = trace;
    Response back;
    back.sensitivities.resize(parameters_.size());
    const record::Record& r = *run_.record;
    for (auto& values : back.value) values.reserve(r.t.size());
    for (auto& sensitivity : back.sensitivities)
      for (auto& values : sensitivity.value) values.reserve(r.t.size());
    const double slack = r.time_slack();
    t_ = r.t.front();
    for (const double sample : r.t) {
      if (sample > run_.until) break;
      while (next_ < times_.size() && sample > times_[next_].time + slack) pass_switching();
      advance(sample);
      record(back);
    }
    back.steps = steps_;
    return back;
  }

  /// Returns the derivatives of state rates and outputs at the start, with respect to states, V and theta.
  LinearPlant linear() {
    const auto n = static_cast<Eigen::Index>(x_.size());
    Eigen::MatrixXd by(n + kOutputs, n + 2);
    const Complex v = run_.start.voltage;
    for (Eigen::Index first = 0; first < n + 2; first += sim::kSensitivities) {
      const Eigen::Index count = std::min<Eigen::Index>(sim::kSensitivities, n + 2 - first);
      auto x = x_;
      for (T& value : x) value = value + T(1e-9);  // off the corner of a dead-band of zero width
      T vr(v.real()), vi(v.imag());
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto d = static_cast<std::size_t>(i);
        if (first + i < n) Seeds<T>::add(x[static_cast<std::size_t>(first + i)], d, 1.0);
        const Complex derivative = first + i == n ? v : first + i == n + 1 ? Complex(0, 1) * v : Complex();
        Seeds<T>::add(vr, d, derivative.real());
        Seeds<T>::add(vi, d, derivative.imag());
      }
      equations_.evaluate_at(vr, vi, run_.record->t.front(), x.data(), trial_.data());
      const auto out = equations_.outputs(x.data());
      for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < n + kOutputs; ++j)
          by(j, first + i) = Seeds<T>::get(
              j < n ? trial_[static_cast<std::size_t>(j)] : out[static_cast<std::size_t>(j - n)],
              static_cast<std::size_t>(i));
    }
    if (breaker_) by.rightCols(2).setZero();  // the recorded voltage is no input
    return {by.topLeftCorner(n, n), by.topRightCorner(n, 2), by.bottomLeftCorner(kOutputs, n),
            by.bottomRightCorner(kOutputs, 2)};
  }

 private:
  struct SwitchingTime {
    double time;
    int switching;  ///< index in the curve; -1: of an effect or a staged event
  };

  void collect_switching_times() {
    const auto& switchings = run_.curve->switchings();
    for (std::size_t k = 0; k < switchings.size(); ++k)
      times_.push_back({switchings[k].time, static_cast<int>(k)});
    const auto add = [&](double t) {
      if (t > run_.record->t.front() && t < run_.record->t.back()) times_.push_back({t, -1});
    };
    for (const double t : sim::plant::switching_times_of(*run_.plant)) add(t);
    for (const record::StagedEvent& e : run_.record->staged) {
      if (e.opens_breaker()) continue;
      add(e.time);
      add(e.until);
    }
    std::ranges::stable_sort(times_, {}, &SwitchingTime::time);
    look_ahead();
  }
  /// Integrates to the next switching time and moves to its other side.
  void pass_switching() {
    const SwitchingTime at = times_[next_];
    advance(at.time);
    const T* before = derivative_at(at.time, 0);
    mark(Trace::Node::Kind::before, at.switching, before);
    ++next_;
    look_ahead();
    fresh_ = true;
    if (at.switching >= 0)
      equations_.pass(at.switching, x_.data());
    else if (!trace_)
      return;
    const T* after = derivative_at(at.time, 1);
    mark(Trace::Node::Kind::after, at.switching, after);
    if (at.switching < 0) return;
    equations_.each([&](const SensitivityParameter& d, std::size_t i) {
      if (d.kind != Kind::switching || d.index != at.switching) return;
      for (std::size_t j = 0; j < x_.size(); ++j)
        Seeds<T>::add(x_[j], i, d.scale * (sim::value_of(before[j]) - sim::value_of(after[j])));
    });
  }
  void mark_step() {
    refresh();
    mark(Trace::Node::Kind::step, -1, k_[0].data());
  }
  void mark(Trace::Node::Kind kind, int switching, const T* derivative, Trace::Passed passed = {}) {
    if (!trace_) return;
    trace_->nodes.push_back({t_, equations_.side, kind, switching, passed});
    trace_->v.push_back(equations_.voltage(t_));
    for (std::size_t i = 0; i < x_.size(); ++i) {
      trace_->x.push_back(sim::value_of(x_[i]));
      trace_->dx.push_back(sim::value_of(derivative[i]));
    }
  }
  /// Limits the time that the effects' equations receive to just before the next switching time.
  void look_ahead() {
    equations_.side.last_moment =
        next_ < times_.size() ? times_[next_].time - sim::plant::kBeforeSwitching : 1e300;
  }
  const T* derivative_at(double t, std::size_t keep) {
    equations_.evaluate(t, x_.data(), k_[keep].data());
    return k_[keep].data();
  }

  void advance(double to) {
    while (t_ < to) {
      interruption_point();
      const double left = to - t_;
      const bool reaches = h_ >= left * (1 - 1e-12);
      const double h = reaches ? left : h_;
      double error = attempt(h);
      if (error > 1 && std::isfinite(error) && (h <= run_.least_step || crosses_corner(h, error))) error = 1;
      if (error <= 1) {
        look_at_guards(trial_, guards_at_end_);
        if (passed_guard() >= 0) {
          pass_crossing(h);
          continue;
        }
        take(h);
        if (reaches) t_ = to;
        if (trace_ && t_ < to) mark_step();
      } else if (h < kShortestStep) {
        give_up();
      }
      h_ = next_step(h_, h, error, rough_power(error, pair_), reaches);
      if (++steps_ > run_.step_limit) give_up();
    }
    t_ = std::max(t_, to);
  }
  /// Accepts the step of the last attempt.
  void take(double h) {
    t_ += h;
    std::swap(x_, trial_);
    std::swap(k_.front(), k_[static_cast<std::size_t>(pair_.stages - 1)]);
    std::swap(guards_, guards_at_end_);
    T moved(0.0);
    equations_.of_plant().clamp_states(equations_.c.data(), x_.data(), moved);
    fresh_ = sim::value_of(moved) > 0;
  }
  /// Evaluates the guards (functions that are zero at a discontinuity) at these states and the last signals.
  void look_at_guards(const std::vector<T>& x, std::vector<T>& guards) {
    if (!guards.empty())
      equations_.of_plant().guard(equations_.c.data(), x.data(), equations_.signals, guards.data());
  }
  /// Returns a guard that passes zero in the step of the last attempt; -1: none.
  [[nodiscard]] int passed_guard() const {
    for (std::size_t g = 0; g < guards_.size(); ++g)
      if ((sim::value_of(guards_[g]) < 0) != (sim::value_of(guards_at_end_[g]) < 0))
        return static_cast<int>(g);
    return -1;
  }
  /// Moves across the first discontinuity of the equations within a step of h.
  void pass_crossing(double h) {
    const auto [before, after, guard] = locate_crossing(h);
    if (before > 0) {
      attempt(before);
      look_at_guards(trial_, guards_at_end_);
      take(before);
    }
    refresh();
    const std::vector<T> derivative = k_[0];
    const T rate = rate_of(guard), missing = T(0.0) - guards_[static_cast<std::size_t>(guard)] / rate;
    mark(Trace::Node::Kind::before, -1, derivative.data(), {guard, sim::value_of(rate)});
    attempt(after - before);
    look_at_guards(trial_, guards_at_end_);
    take(after - before);
    refresh();
    mark(Trace::Node::Kind::after, -1, k_[0].data());
    for (std::size_t i = 0; i < x_.size(); ++i)
      for (std::size_t d = 0; d < parameters_.size(); ++d)
        Seeds<T>::add(x_[i], d,
                      Seeds<T>::get(missing, d) * (sim::value_of(derivative[i]) - sim::value_of(k_[0][i])));
    fresh_ = fresh_ || !parameters_.empty();
    if (++steps_ > run_.step_limit) give_up();
  }
  struct Crossing {
    double before, after;  ///< bounds of its time within the step [s]
    int guard;             ///< guard that passes zero there
  };
  /// Locates the discontinuity by regula falsi (Illinois) within the step of the last attempt.
  Crossing locate_crossing(double h) {
    constexpr int kMostRounds = 60;
    Crossing found = {0.0, h, passed_guard()};
    const auto height = [&](const std::vector<T>& guards) {
      return std::abs(sim::value_of(guards[static_cast<std::size_t>(found.guard)]));
    };
    double low = height(guards_), high = height(guards_at_end_);
    int side = 0;  // last guess: -1 before the crossing, 1 after it
    for (int round = 0; round < kMostRounds && found.after - found.before > kTimeError; ++round) {
      const double wide = found.after - found.before, guess = found.before + wide * low / (low + high);
      // shifted a little, so that the next guess lies on the other side of the crossing
      const double middle = std::clamp(guess - 0.4 * side * kTimeError, found.before + 0.01 * kTimeError,
                                       found.after - 0.01 * kTimeError);
      attempt(middle);
      look_at_guards(trial_, guards_at_end_);
      const int passed = passed_guard();
      const int now = passed < 0 ? -1 : 1;
      if (passed >= 0 && passed != found.guard) {
        found.guard = passed;
        low = height(guards_);
      } else if (now == side) {
        (now < 0 ? high : low) /= 2;
      }
      (now < 0 ? found.before : found.after) = middle;
      (now < 0 ? low : high) = height(guards_at_end_);
      side = now;
    }
    return found;
  }
  /// Returns the rate of a guard at the present state [1/s].
  T rate_of(int guard) {
    const auto g = static_cast<std::size_t>(guard);
    for (std::size_t i = 0; i < x_.size(); ++i) trial_[i] = x_[i] + T(kRateOver) * k_[0][i];
    equations_.evaluate(t_ + kRateOver, trial_.data(), k_[1].data());
    look_at_guards(trial_, guards_at_end_);
    return (guards_at_end_[g] - guards_[g]) / T(kRateOver);
  }
  /// Returns whether the error can only be due to a corner of the equations (a state that reaches its limit),
  /// because the step is very short and the error small.
  [[nodiscard]] bool crosses_corner(double h, double error) const {
    return h < kShortestStep && error * run_.tolerance < kCornerError;
  }
  /// Evaluates k_[0] and the signals at the present states.
  void refresh() {
    if (fresh_) {
      equations_.evaluate(t_, x_.data(), k_[0].data());
      look_at_guards(x_, guards_);
    }
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
  /// Returns the sum of the derivatives of the stages up to `last`, weighted by a row of the pair (-1: by the
  /// error weights). `number` is the index of a state or of one of its sensitivities.
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
    equations_.evaluate(t_ + pair.c[at] * h, trial_.data(), k_[at].data());
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
  /// The states as an array of doubles: value and sensitivities of each state, to which the same Runge-Kutta
  /// sums apply.
  static constexpr std::size_t kNumbers = sizeof(T) / sizeof(double);
  static_assert(kNumbers * sizeof(double) == sizeof(T) && std::is_trivially_copyable_v<T>);
  static double* numbers(std::vector<T>& states) { return reinterpret_cast<double*>(states.data()); }
  static const double* numbers(const std::vector<T>& states) {
    return reinterpret_cast<const double*>(states.data());
  }

  void record(Response& back) {
    refresh();
    mark(Trace::Node::Kind::sample, -1, k_[0].data());
    // the frame rotates with the pre-event angle
    const double frame = run_.start.drift / (constants::turn * run_.conventions.frequency);
    back.voltage.push_back(equations_.voltage(t_));
    auto out = equations_.outputs(x_.data());
    if (trace_) ++trace_->samples;
    out[static_cast<std::size_t>(Output::speed)] = equations_.signals.speed + T(frame);
    for (int o = 0; o < kOutputs; ++o) {
      back.value[o].push_back(sim::value_of(out[static_cast<std::size_t>(o)]));
      for (std::size_t d = 0; d < parameters_.size(); ++d)
        back.sensitivities[d].value[o].push_back(Seeds<T>::get(out[static_cast<std::size_t>(o)], d));
    }
  }
  [[noreturn]] void give_up() const {
    throw InputError({"playback failed", fmt::format("t = {:.4f} s", t_),
                      "the plant's equations cannot be integrated further with this voltage",
                      "check the parameters (time constants, limits) and the record at that time"});
  }

  const PlaybackRun& run_;
  const Pair& pair_ = run_.tolerance < kRoughTolerance ? kFineSteps : kRoughSteps;
  bool fresh_ = true;  ///< k_[0] must be evaluated again
  std::span<const SensitivityParameter> parameters_;
  PlaybackEquations<T> equations_;
  std::vector<T> x_, trial_, missed_;
  std::array<std::vector<T>, 7> k_;
  std::vector<T> guards_, guards_at_end_;
  std::vector<double> allowed_;  ///< error of each state per step, relative to 1 + |state|
  const bool breaker_ = run_.record->breaker() != nullptr;
  std::vector<SwitchingTime> times_;
  std::size_t next_ = 0;
  int steps_ = 0;
  double t_ = 0, h_ = 1e-3;
  Trace* trace_ = nullptr;
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

/// A run and its trajectory.
class TrajectoryCache {
 public:
  explicit TrajectoryCache(const PlaybackRun& run) : response(Solver<double>(run, {}).run(&trace)) {}
  Trace trace;
  Response response;
};

SeenAlong seen_along(const PlaybackRun& run, std::span<const double> times) {
  Trace trace;
  Solver<double>(run, {}).run(&trace);
  PlaybackRun still = run;
  still.angle = still.speed = 0;
  still.torque = still.field = {};
  PlaybackEquations<double> steady(still, {}), equations(run, {});
  const std::size_t n = equations.x0.size();
  std::vector<double> x(n), dx(n);
  const auto seen = [](double t, const Side& side, const sim::Signals<double>& s) -> Seen {
    return {t, side.segment, {s.Vr, s.Vi}, {s.Ir, s.Ii}, s.speed, s.Ifd, s.Efd, s.Tm};
  };
  SeenAlong all;
  const Complex v = run.start.voltage;
  const double begin = run.record->t.front();
  steady.evaluate_at(v.real(), v.imag(), begin, steady.x0.data(), dx.data());
  all.steady = seen(begin, steady.side, steady.signals);
  const auto see = [&](double t, const Side& side, const double* states) {
    equations.side = side;
    equations.evaluate(t, states, dx.data());
    all.seen.push_back(seen(t, side, equations.signals));
  };
  std::size_t next = 0;
  for (std::size_t k = 0; k < trace.nodes.size(); ++k) {
    const Trace::Node& node = trace.nodes[k];
    for (; k > 0 && next < times.size() && times[next] < node.t; ++next) {
      const double from = trace.nodes[k - 1].t, h = node.t - from, share = (times[next] - from) / h;
      if (share <= 0) continue;
      for (std::size_t i = 0; i < n; ++i) {  // cubic Hermite interpolation
        const std::size_t a = (k - 1) * n + i, b = k * n + i;
        x[i] = hermite(share, h, trace.x[a], trace.dx[a], trace.x[b], trace.dx[b]);
      }
      see(times[next], trace.nodes[k - 1].side, x.data());
    }
    see(node.t, node.side, trace.x.data() + k * n);
  }
  return all;
}

LinearPlant linearise(const PlaybackRun& run) { return Solver<D8>(run, {}).linear(); }

Eigen::VectorXd rates_by_input(const PlaybackRun& run, SensitivityParameter::Kind input) {
  constexpr double kInputStep = 1e-3;  // [pu]
  PlaybackEquations<double> equations(run, {});
  const auto n = equations.x0.size();
  std::vector<double> still(n), moved(n);
  equations.evaluate(run.record->t.front(), equations.x0.data(), still.data());
  (input == Kind::torque ? equations.more_torque : equations.more_field) = kInputStep;
  equations.evaluate(run.record->t.front(), equations.x0.data(), moved.data());
  using Numbers = Eigen::Map<const Eigen::VectorXd>;
  return (Numbers(moved.data(), static_cast<Eigen::Index>(n)) -
          Numbers(still.data(), static_cast<Eigen::Index>(n))) /
         kInputStep;
}

Response simulate_playback(const PlaybackRun& run, std::span<const SensitivityParameter> parameters) {
  const bool linear = !run.linear_sensitivities.empty() && can_be_linear(run);
  if (parameters.empty()) {
    if (!run.cache || !linear) return Solver<double>(run, {}).run();
    *run.cache = std::make_shared<const TrajectoryCache>(run);
    return (*run.cache)->response;
  }
  if (linear) {
    const auto cache = run.cache && *run.cache ? *run.cache : std::make_shared<const TrajectoryCache>(run);
    Response response = cache->response;
    if (add_linear_sensitivities(run, parameters, cache->trace, response)) return response;
  }
  Response all;
  constexpr std::size_t kSeedsAtOnce = sim::kSensitivities;
  for (std::size_t first = 0; first < parameters.size(); first += kSeedsAtOnce) {
    Response some =
        Solver<D8>(run, parameters.subspan(first, std::min(kSeedsAtOnce, parameters.size() - first))).run();
    if (first == 0) {
      all = std::move(some);
      continue;
    }
    std::ranges::move(some.sensitivities, std::back_inserter(all.sensitivities));
    all.steps += some.steps;
  }
  return all;
}

}  // namespace swingbank::validate::playin
