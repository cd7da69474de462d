// Approximate sensitivities of a response from the plant linearised along its trajectory.
#include "validate/playin/detail/linear_sensitivities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/stop_signal.hpp"
#include "validate/playin/detail/hermite.hpp"
#include "validate/playin/detail/packed_matrix.hpp"

namespace swingbank::validate::playin {
namespace {

using Kind = SensitivityParameter::Kind;
using NodeKind = Trace::Node::Kind;
using sim::P8, by_pack::Matrix, by_pack::kLanes;

constexpr double kNodeMove = 1e-6;  ///< step of a finite difference, relative to 1 + |state|
constexpr double kAtLimit = 1e-9;   ///< distance below which a state is at its limit, relative to 1 + |state|
/// A step h is halved if h times any entry of A changes by more than this within the step. Such a change
/// indicates that a limit of a signal begins or ceases to act.
constexpr double kBend = 0.05;

/// Linearised plant at a node: x' = A x + B, y = C x + D. A and C refer to states and inputs, B and D to
/// sensitivity parameters. The last row of C and D belongs to the guard function that passes zero.
struct Linear {
  Linear(std::size_t n, std::size_t inputs, std::size_t m, std::size_t outputs)
      : A(n, inputs), B(n, m), C(outputs + 1, inputs), D(outputs + 1, m), limits(n, m), clamped(n, 0) {}
  Matrix A, B, C, D;
  Matrix limits;                  ///< sensitivities of the limits at which states are clamped
  std::vector<std::size_t> hats;  ///< packs of B and D with non-zero hat functions
  std::vector<char> clamped;      ///< states clamped at a limit; their sensitivities equal the limit's
  bool any_clamped = false;
};

/// Point of a trajectory, where the plant is linearised.
struct Point {
  double t;  ///< [s]
  Side side;
  Complex v;  ///< terminal voltage in the plant's frame [pu]
  const double *x, *dx;
};

class LinearSensitivities {
 public:
  LinearSensitivities(const PlaybackRun& run, std::span<const SensitivityParameter> parameters,
                      const Trace& trace, Response& response)
      : run_(run),
        parameters_(parameters),
        trace_(trace),
        response_(response),
        n_(trace.x.size() / trace.nodes.size()),
        m_(parameters.size()),
        inputs_(n_ + (std::ranges::any_of(parameters, is_input) ? 2 : 0)),
        S_(n_, m_),
        some_(n_, 1),
        right_(n_, 1),
        shown_(run.linear_sensitivities.size()),
        before_(n_, inputs_, m_, shown_),
        now_(n_, inputs_, m_, shown_),
        left_(n_, n_),
        inverse_(n_, n_),
        y_(shown_ + 1, m_),
        has_coefficients_(S_.packs(), 0),
        x_(n_),
        move_(copies_for(inputs_) * kLanes, kNodeMove),
        limit_(n_),
        outward_(n_) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      lane_[l] = P8(0.0);
      lane_[l].set(int(l), 1.0);
    }
    start();
    for (std::size_t d = 0; d < m_; ++d) {
      double begin = -std::numeric_limits<double>::infinity();
      if (is_input(parameters_[d])) {
        const auto& knots = input_of(parameters_[d].kind).t;
        const auto index = static_cast<std::size_t>(parameters_[d].index);
        begin = knots[std::max<std::size_t>(index, 1) - 1];
        auto& hats = hats_[parameters_[d].kind == Kind::torque ? 0 : 1];
        hats.resize(knots.size(), m_);
        hats[index] = d;
      }
      begins_.emplace_back(begin, d + 1);
    }
    std::ranges::sort(begins_);
  }

  bool run() {
    response_.sensitivities.resize(m_);
    for (auto& sensitivity : response_.sensitivities)
      for (const Output o : run_.linear_sensitivities) {
        auto& values = sensitivity.value[static_cast<int>(o)];
        values.resize(trace_.samples);
        to_.push_back(values.data());
      }
    for (std::size_t k = 0, sample = 0; k < trace_.nodes.size(); ++k) {
      interruption_point();
      const Trace::Node& node = trace_.nodes[k];
      std::swap(before_, now_);
      linearise_node(k);
      if (node.kind == NodeKind::after)
        cross(k);
      else if (k > 0 && node.t > trace_.nodes[k - 1].t)
        integrate(point(k - 1), point(k));
      take_limits();
      if (node.kind == NodeKind::sample) record(sample++);
    }
    for (std::size_t d = 0; d < m_; ++d)
      for (std::size_t i = 0; i < n_; ++i)
        if (!std::isfinite(S_(i, d))) return false;
    return true;
  }

 private:
  /// Eight copies of the plant in a SIMD batch, each with another perturbation.
  struct Copies {
    PlaybackEquations<P8> equations;
    bool by_state;     ///< true: states and inputs are perturbed; false: parameters are
    std::size_t pack;  ///< pack of columns that receives the sensitivities
  };
  /// Derivatives, outputs and one guard function in all SIMD lanes. Finite differences are taken between two
  /// such evaluations, not from the stored trajectory, so that a perturbation without effect gives a
  /// sensitivity of exactly zero.
  struct Evaluated {
    std::vector<P8> dx;
    std::array<P8, kOutputs> y;
    P8 guard;
  };
  static std::size_t copies_for(std::size_t columns) { return (columns + kLanes - 1) / kLanes; }
  /// Returns the number of packs up to the last parameter whose input has begun.
  [[nodiscard]] std::size_t wide() const { return copies_for(active_); }
  static bool is_input(const SensitivityParameter& d) {
    return d.kind == Kind::torque || d.kind == Kind::field;
  }
  [[nodiscard]] const PiecewiseLinear& input_of(Kind kind) const {
    return kind == Kind::torque ? run_.torque : run_.field;
  }
  static bool moves_coefficients(const SensitivityParameter& d) {
    return d.kind == Kind::parameter || d.kind == Kind::P || d.kind == Kind::Q;
  }

  /// Computes the sensitivities of the initial state, and prepares the perturbed copies: some perturb states
  /// and inputs, others parameters that change the coefficients.
  void start() {
    sim::plant::OperatingOf<P8> at;
    for (std::size_t first = 0; first < m_; first += kLanes) {
      const auto some = parameters_.subspan(first, std::min(kLanes, m_ - first));
      if (first > 0 && std::ranges::all_of(some, is_input)) continue;
      const PlaybackEquations<sim::D8> seeded(run_, some);
      if (first == 0) {
        for (const auto& value : seeded.c) at.c.emplace_back(value.a);
        at.Efd = P8(seeded.Efd.a);
        at.Tm = P8(seeded.Tm.a);
        unperturbed_.emplace(run_, std::span<const SensitivityParameter>(), at);
        for (std::size_t p = 0; p < copies_for(inputs_); ++p) copies_.push_back({{run_, {}, at}, true, p});
        for (std::size_t i = n_; i < inputs_; ++i) {
          auto& equations = copies_[i / kLanes].equations;
          (i == n_ ? equations.more_torque : equations.more_field).set(int(i % kLanes), kNodeMove);
        }
      }
      for (std::size_t d = 0; d < some.size(); ++d)
        for (std::size_t i = 0; i < n_; ++i) S_(i, first + d) = seeded.x0[i].d[int(d)];
      if (!std::ranges::any_of(some, moves_coefficients)) continue;
      has_coefficients_[first / kLanes] = 1;
      Copies& copies =
          copies_.emplace_back(Copies{PlaybackEquations<P8>{run_, {}, at}, false, first / kLanes});
      for (std::size_t d = 0; d < some.size(); ++d) {
        if (!moves_coefficients(some[d])) continue;
        const auto move = [lane = int(d)](P8& value, const sim::D8& along) {
          value.set(lane, along.a + kNodeMove * along.d[lane]);
        };
        for (std::size_t i = 0; i < seeded.c.size(); ++i) move(copies.equations.c[i], seeded.c[i]);
        move(copies.equations.Efd, seeded.Efd);
        move(copies.equations.Tm, seeded.Tm);
      }
    }
    unmoved_.dx.resize(n_);
    moved_.dx.resize(n_);
    guards_.assign(static_cast<std::size_t>(unperturbed_->of_plant().guards()), P8(0.0));
  }

  /// Finds the states at their limits, and the perturbations of the other states that stay within their
  /// limits.
  void find_limits(const double* x, const double* dx) {
    for (std::size_t i = 0; i < n_; ++i) move_[i] = kNodeMove * (1 + std::abs(x[i]));
    std::ranges::fill(now_.clamped, 0);
    now_.any_clamped = false;
    const auto& equations = *unperturbed_;
    if (!equations.of_plant().limited()) return;
    constexpr int kUp = 0, kDown = 1;
    for (std::size_t i = 0; i < n_; ++i) x_[i] = P8(x[i]) + P8(move_[i]) * (lane_[kUp] - lane_[kDown]);
    P8 moved(0.0);
    equations.of_plant().clamp_states(equations.c.data(), x_.data(), moved);
    for (std::size_t i = 0; i < n_; ++i) {
      const double scale = 1 + std::abs(x[i]);
      const double up = (x_[i][kUp] - x[i]) / scale, down = (x[i] - x_[i][kDown]) / scale;
      const bool high = up < kAtLimit, low = down < kAtLimit;
      if (low || (!high && up < kNodeMove * (1 - 1e-3))) move_[i] = -move_[i];  // perturb away from the limit
      if (!(high || low) || dx[i] != 0.0) continue;
      now_.clamped[i] = 1;
      now_.any_clamped = true;
      limit_[i] = x_[i][high ? kUp : kDown];
      outward_[i] = (high ? 1.0 : -1.0) * scale;
    }
  }
  /// Sets the states of a node. In each SIMD lane, clamped states take the limit of that lane's copy.
  void place(const PlaybackEquations<P8>& equations, const double* x) {
    for (std::size_t i = 0; i < n_; ++i) x_[i] = P8(x[i]);
    if (!now_.any_clamped) return;
    for (std::size_t i = 0; i < n_; ++i)
      if (now_.clamped[i]) x_[i] = P8(x[i] + outward_[i]);
    P8 moved(0.0);
    equations.of_plant().clamp_states(equations.c.data(), x_.data(), moved);
    for (std::size_t i = 0; i < n_; ++i)
      if (!now_.clamped[i]) x_[i] = P8(x[i]);
  }
  [[nodiscard]] Point point(std::size_t k) const {
    const Trace::Node& node = trace_.nodes[k];
    return {node.t, node.side, trace_.v[k], trace_.x.data() + k * n_, trace_.dx.data() + k * n_};
  }
  /// Linearises the plant at a node into `now_`.
  void linearise_node(std::size_t k) {
    const Trace::Node& node = trace_.nodes[k];
    // A and B of the previous node are kept, because a perturbed copy may be beyond the discontinuity
    const bool discontinuous = node.passed.guard >= 0 || (k > 0 && trace_.nodes[k - 1].passed.guard >= 0);
    if (discontinuous) now_ = before_;
    linearise(point(k), discontinuous, node.kind == NodeKind::sample, node.passed.guard);
  }
  /// Linearises the plant at a point into `now_`. `keep`: A and B remain unchanged; `shows`: outputs are
  /// included; `guard`: guard that is included, -1: none.
  void linearise(const Point& at, bool keep, bool shows, int guard) {
    find_limits(at.x, at.dx);
    place(*unperturbed_, at.x);
    evaluate(*unperturbed_, at, shows, guard, unmoved_);
    for (auto& [equations, by_state, pack] : copies_) {
      place(equations, at.x);
      P8 per_move(1 / kNodeMove);
      if (by_state) {
        per_move = P8(1.0) / P8::load(move_.data() + pack * kLanes);
        for (std::size_t i = pack * kLanes; i < std::min(n_, (pack + 1) * kLanes); ++i)
          if (!now_.clamped[i]) x_[i] = x_[i] + P8(move_[i]) * lane_[i % kLanes];
      }
      evaluate(equations, at, shows, guard, moved_);
      P8* const by = (by_state ? now_.A : now_.B).pack(pack);
      for (std::size_t i = 0; !keep && i < n_; ++i) by[i] = (moved_.dx[i] - unmoved_.dx[i]) * per_move;
      P8* const shown = (by_state ? now_.C : now_.D).pack(pack);
      for (std::size_t o = 0; shows && o < shown_; ++o) {
        const auto output = static_cast<std::size_t>(run_.linear_sensitivities[o]);
        shown[o] = (moved_.y[output] - unmoved_.y[output]) * per_move;
      }
      if (guard >= 0) shown[shown_] = (moved_.guard - unmoved_.guard) * per_move;
      for (std::size_t i = 0; !by_state && now_.any_clamped && i < n_; ++i)
        if (now_.clamped[i]) now_.limits.pack(pack)[i] = (x_[i] - P8(limit_[i])) * per_move;
    }
    raise_hats(std::min(at.t, at.side.last_moment));
  }
  /// Evaluates the equations at the states x_ of all lanes.
  void evaluate(PlaybackEquations<P8>& equations, const Point& at, bool shows, int guard, Evaluated& to) {
    equations.side = at.side;
    equations.evaluate_at(P8(at.v.real()), P8(at.v.imag()), at.t, x_.data(), to.dx.data());
    if (shows) to.y = equations.outputs(x_.data());
    if (guard < 0) return;
    equations.of_plant().guard(equations.c.data(), x_.data(), equations.signals, guards_.data());
    to.guard = guards_[static_cast<std::size_t>(guard)];
  }
  /// Sets the columns of B and D of the hat functions that are not zero at t. A column is the derivative with
  /// respect to the input, times the value of the hat function.
  void raise_hats(double t) {
    while (begun_ < begins_.size() && begins_[begun_].first <= t)
      active_ = std::max(active_, begins_[begun_++].second);
    for (const std::size_t p : now_.hats)
      for (std::size_t lane = 0; lane < kLanes && p * kLanes + lane < m_; ++lane)
        if (is_input(parameters_[p * kLanes + lane])) set_column(p * kLanes + lane, n_, 0.0);
    now_.hats.clear();
    for (const Kind kind : {Kind::torque, Kind::field}) {
      const auto& hats = hats_[kind == Kind::torque ? 0 : 1];
      if (hats.empty()) continue;
      const auto& knots = input_of(kind).t;
      const auto behind = static_cast<std::size_t>(std::ranges::upper_bound(knots, t) - knots.begin());
      for (std::size_t k = std::max<std::size_t>(behind, 1) - 1; k < std::min(behind + 1, knots.size()); ++k)
        if (const double height = hat(knots, k, t); hats[k] < m_ && height != 0.0) {
          set_column(hats[k], n_ + (kind == Kind::torque ? 0 : 1), parameters_[hats[k]].scale * height);
          now_.hats.push_back(hats[k] / kLanes);
        }
    }
  }
  void set_column(std::size_t d, std::size_t input, double height) {
    for (std::size_t i = 0; i < n_; ++i) now_.B(i, d) = now_.A(i, input) * height;
    for (std::size_t o = 0; o <= shown_; ++o) now_.D(o, d) = now_.C(o, input) * height;
  }

  /// Sets the sensitivities of clamped states to those of their limits.
  void take_limits() {
    for (std::size_t i = 0; now_.any_clamped && i < n_; ++i)
      for (std::size_t p = 0; now_.clamped[i] && p < wide(); ++p) S_.pack(p)[i] = now_.limits.pack(p)[i];
  }
  /// Integrates the sensitivities between two points, at which `before_` and `now_` are the linearisations.
  /// The interval is halved while bends() holds, but at most PlaybackRun::step_limit times in a run, in case
  /// the run diverges.
  void integrate(const Point& from, const Point& to) {
    const double h = to.t - from.t, half = from.t + h / 2;
    if (!(half > from.t && half < to.t) || halvings_ >= run_.step_limit || !bends(h)) return step(h);
    ++halvings_;
    std::vector<double> x(n_), dx(n_);
    const Point middle = between(from, to, x, dx);
    Linear end = now_;
    linearise(middle, false, false, -1);
    integrate(from, middle);
    take_limits();
    std::swap(before_, now_);
    now_ = std::move(end);
    integrate(middle, to);
  }
  /// Returns whether A changes by more than kBend / h within the step.
  [[nodiscard]] bool bends(double h) const {
    for (std::size_t p = 0; p < left_.packs(); ++p)
      for (std::size_t i = 0; i < n_; ++i) {
        const P8 &from = before_.A.pack(p)[i], &to = now_.A.pack(p)[i];
        for (int l = 0; l < P8::lanes; ++l)
          if (h * std::abs(to[l] - from[l]) > kBend) return true;
      }
    return false;
  }
  /// Returns the midpoint of a step, with each state within its limits. It lies on the cubic through the
  /// states and derivatives at both ends. A state that is clamped at one end only is extrapolated linearly
  /// from the end at which it is free.
  Point between(const Point& from, const Point& to, std::vector<double>& x, std::vector<double>& dx) {
    auto& equations = *unperturbed_;
    const double h = to.t - from.t, t = from.t + h / 2;
    equations.side = to.side;
    for (std::size_t i = 0; i < n_; ++i)
      x_[i] =
          P8(now_.clamped[i] == before_.clamped[i] ? hermite(0.5, h, from.x[i], from.dx[i], to.x[i], to.dx[i])
             : now_.clamped[i]                     ? from.x[i] + h / 2 * from.dx[i]
                                                   : to.x[i] - h / 2 * to.dx[i]);
    P8 moved(0.0);
    equations.of_plant().clamp_states(equations.c.data(), x_.data(), moved);
    const Point middle = {t, to.side, equations.voltage(t), x.data(), dx.data()};
    evaluate(equations, middle, false, -1, unmoved_);
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] = x_[i][0];
      dx[i] = unmoved_.dx[i][0];
    }
    return middle;
  }
  /// Returns whether a state reaches its limit within the step: clamped at the end, not at the beginning.
  [[nodiscard]] bool meets_a_limit() const {
    for (std::size_t i = 0; now_.any_clamped && i < n_; ++i)
      if (now_.clamped[i] && !before_.clamped[i]) return true;
    return false;
  }
  /// Integrates the sensitivities over an interval of h [s]: (I - h A/2 - h A0/6 + h^2 A^2/6) S = S0 + h A0
  /// S0/3 + h (B0 + B)/2 - h^2 A B/6. A0, B0, S0: at the start of the interval; A, B, S: at its end. This is
  /// the two-derivative formula of order 3, in which differences between the two nodes replace the
  /// derivatives of A and B.
  void step(double h) {
    const Linear& end = meets_a_limit() ? before_ : now_;
    const P8 half(h / 2), third(h / 3), sixth(h / 6), square(h * h / 6);
    for (std::size_t p = 0; p < left_.packs(); ++p) {
      P8* left = left_.pack(p);
      const P8 *A0 = before_.A.pack(p), *A = end.A.pack(p);
      for (std::size_t i = 0; i < n_; ++i) {
        left[i] = P8(0.0) - half * A[i] - sixth * A0[i];
        inverse_.pack(p)[i] = square * A[i];
      }
      add_product(end.A, n_, inverse_.pack(p), left);
    }
    for (std::size_t i = 0; i < n_; ++i) left_(i, i) += 1.0;
    invert(left_, inverse_);
    for (std::size_t p = 0; p < wide(); ++p) {
      P8 *S = S_.pack(p), *some = some_.pack(0), *right = right_.pack(0);
      const P8 *B0 = before_.B.pack(p), *B = end.B.pack(p);
      for (std::size_t i = 0; i < n_; ++i) {
        right[i] = S[i] + half * (B0[i] + B[i]);
        some[i] = third * S[i];
        S[i] = P8(0.0) - square * B[i];
      }
      add_product(before_.A, n_, some, right);
      if (has_coefficients_[p] || std::ranges::count(end.hats, p) > 0) add_product(end.A, n_, S, right);
      std::fill_n(S, n_, P8(0.0));
      add_product(inverse_, n_, right, S);
    }
  }
  /// Moves the sensitivities across a switching time.
  void cross(std::size_t k) {
    const Trace::Passed& passed = trace_.nodes[k - 1].passed;
    if (passed.guard < 0) return switch_over(k);
    const double *before = trace_.dx.data() + (k - 1) * n_, *after = trace_.dx.data() + k * n_;
    for (std::size_t d = 0; d < active_; ++d) {
      double moved = before_.D(shown_, d);  // sensitivity of the guard at constant time
      for (std::size_t i = 0; i < n_; ++i) moved += before_.C(shown_, i) * S_(i, d);
      for (std::size_t i = 0; i < n_; ++i) S_(i, d) -= moved / passed.rate * (before[i] - after[i]);
    }
  }
  /// Moves the sensitivities across a switching of the curve, whose time and angle jump may be sensitivity
  /// parameters.
  void switch_over(std::size_t k) {
    const int switching = trace_.nodes[k].switching;
    const double *before = trace_.dx.data() + (k - 1) * n_, *after = trace_.dx.data() + k * n_;
    for (std::size_t d = 0; d < m_; ++d) {
      const SensitivityParameter& along = parameters_[d];
      if (switching < 0 || along.index != switching) continue;
      if (along.kind == Kind::turn && unperturbed_->has_rotor()) S_(0, d) -= along.scale;
      for (std::size_t i = 0; along.kind == Kind::switching && i < n_; ++i)
        S_(i, d) += along.scale * (before[i] - after[i]);
    }
  }
  void record(std::size_t sample) {
    for (std::size_t p = 0; p < wide(); ++p) {
      std::copy_n(now_.D.pack(p), shown_ + 1, y_.pack(p));
      add_product(now_.C, n_, S_.pack(p), y_.pack(p));
      for (std::size_t d = p * kLanes; d < std::min(m_, (p + 1) * kLanes); ++d)
        for (std::size_t o = 0; o < shown_; ++o) to_[d * shown_ + o][sample] = y_(o, d);
    }
  }

  const PlaybackRun& run_;
  std::span<const SensitivityParameter> parameters_;
  const Trace& trace_;
  Response& response_;
  const std::size_t n_, m_, inputs_;  ///< numbers of states; of parameters; of states, torque and field
  std::size_t active_ = 0;            ///< 1 + largest index of a sensitivity parameter whose input has begun
  std::size_t begun_ = 0;             ///< number of entries of `begins_` that have begun
  std::vector<std::pair<double, std::size_t>>
      begins_;  ///< start of a parameter's input [s]; the parameter's index + 1
  std::array<std::vector<std::size_t>, 2> hats_;  ///< parameters of the hat functions of torque and field
  std::optional<PlaybackEquations<P8>> unperturbed_;
  std::vector<Copies> copies_;
  Matrix S_, some_, right_;
  std::size_t shown_;  ///< number of outputs with sensitivities
  Linear before_, now_;
  int halvings_ = 0;
  Matrix left_, inverse_, y_;
  std::vector<char> has_coefficients_;  ///< whether a pack of parameters changes any coefficient
  std::array<P8, kLanes> lane_;         ///< unit vectors: one in the lane, zero elsewhere
  std::vector<P8> x_, guards_;
  Evaluated unmoved_, moved_;
  std::vector<double> move_, limit_, outward_;
  std::vector<double*> to_;  ///< destinations of the sensitivities [parameter][output]
};

}  // namespace

bool can_be_linear(const PlaybackRun& run) {
  return !is_recorded(*run.plant) && !run.given && !run.record->breaker() && !run.record->open_circuit();
}

bool add_linear_sensitivities(const PlaybackRun& run, std::span<const SensitivityParameter> parameters,
                              const Trace& trace, Response& response) {
  return LinearSensitivities(run, parameters, trace, response).run();
}

}  // namespace swingbank::validate::playin
