#include "validate/playin/open_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/problem.hpp"
#include "sim/plant/equations.hpp"
#include "validate/playin/detail/packed_matrix.hpp"
#include "validate/playin/detail/recorded.hpp"

namespace swingbank::validate::playin {
namespace {

using sim::P8, by_pack::kLanes;

/// ROS34PW2, a linearly implicit W-method of order 3: any approximation of the Jacobian suffices (J. Rang, L.
/// Angermann, BIT 45 (2005) 761, table 4). It is L-stable, so a lag much faster than a step ends exactly at
/// its input. Row i of each lower triangle contains the weights of the stages up to i: kAlpha in the state of
/// stage i, kGammas in its right-hand side.
constexpr int kFormulaStages = 4;
using Stages = std::array<std::array<double, kFormulaStages>, kFormulaStages>;
constexpr double kGamma = 0.435866521508459;
constexpr Stages kAlpha = {
    {{}, {0.87173304301691801}, {0.84457060015369423, -0.11299064236484185}, {0.0, 0.0, 1.0}}};
constexpr Stages kGammas = {{{kGamma},
                             {-0.87173304301691801, kGamma},
                             {-0.90338057013044082, 0.054180672388095326, kGamma},
                             {0.24212380706095346, -1.2232505839045147, 0.54526025533510214, kGamma}}};

/// The method in terms of u = gammas k, which avoids products with the Jacobian (E. Hairer, G. Wanner,
/// Solving Ordinary Differential Equations II, IV.7).
struct Transformed {
  Stages inverse{};                         ///< inverse of gammas
  Stages a{};                               ///< alpha times the inverse
  std::array<double, kFormulaStages> at{};  ///< fraction of the step at which each stage evaluates its inputs
  constexpr Transformed() {
    for (std::size_t j = 0; j < kFormulaStages; ++j)
      for (std::size_t i = j; i < kFormulaStages; ++i) {
        double left = i == j ? 1.0 : 0.0;
        for (std::size_t k = j; k < i; ++k) left -= kGammas[i][k] * inverse[k][j];
        inverse[i][j] = left / kGamma;
      }
    for (std::size_t i = 0; i < kFormulaStages; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        at[i] += kAlpha[i][j];
        for (std::size_t k = j; k < i; ++k) a[i][j] += kAlpha[i][k] * inverse[k][j];
      }
  }
};
constexpr Transformed kFormula;

/// Controls of up to eight plants in a SIMD batch.
class BlockBatch {
 public:
  /// `lengths`: lengths of the steps [s], without repetitions; it must outlive the object.
  BlockBatch(Made made, std::span<const sim::plant::Plant> plants, const Seen& start,
             const sim::Conventions& conventions, const std::vector<double>& lengths)
      : made_(made),
        equations_(plants.front()),
        ifd_(start.Ifd),
        lengths_(lengths),
        triangles_(lengths.size()) {
    const double P = (start.V * std::conj(start.I)).real(), Q = (start.V * std::conj(start.I)).imag();
    scratch_.resize(static_cast<std::size_t>(equations_.scratch()));
    for (std::size_t lane = 0; lane < plants.size(); ++lane) {
      auto p = sim::plant::block_parameters(plants[lane]);
      p.front() = recorded::operating_parameters<double>(start.Efd, start.Ifd, start.Tm);
      try {
        const auto at = sim::plant::operating_point_of<double>(plants[lane], p, start.V, P, Q, conventions);
        if (c_.empty()) {
          c_.assign(at.c.begin(), at.c.end());
          x_.assign(at.x.begin(), at.x.end());
          efd_ = at.Efd;
          tm_ = at.Tm;
        }
        const int l = static_cast<int>(lane);
        for (std::size_t i = 0; i < c_.size(); ++i) c_[i].set(l, at.c[i]);
        for (std::size_t i = 0; i < x_.size(); ++i) x_[i].set(l, at.x[i]);
        initialised_[lane] = 1;
      } catch (const InputError&) {  // no steady state: its column stays NaN
      }
    }
    const std::size_t n = x_.size();
    dx_.resize(n);
    trial_.resize(n);
    for (auto& u : u_) u.resize(n);
    jacobian_.resize(n * n);
    if (!any()) return;
    linearise(start);
    find_entries();
  }
  [[nodiscard]] bool any() const { return !c_.empty(); }
  [[nodiscard]] bool initialised(std::size_t lane) const { return initialised_[lane] != 0; }
  [[nodiscard]] double response(std::size_t lane) const { return response_[static_cast<int>(lane)]; }

  /// Computes the derivatives of the states, and the response. Derivatives are not clamped at non-windup
  /// limits. Each stage is clipped instead, so that a state which reaches its limit within a step ends
  /// exactly at that limit.
  void evaluate(const Seen& at, const std::vector<P8>& x, std::vector<P8>& dx) {
    sim::Signals<P8>& s = signals_;
    s.Efd = P8(efd_);
    s.Tm = P8(tm_);
    s.t = P8(at.t);
    s.Vr = s.Vpr = P8(at.V.real());
    s.Vi = s.Vpi = P8(at.V.imag());
    s.Ir = P8(at.I.real());
    s.Ii = P8(at.I.imag());
    scratch_[recorded::speed] = P8(at.speed);
    scratch_[recorded::dIfd] = P8(at.Ifd - ifd_);
    equations_.signals(c_.data(), x.data(), scratch_.data(), s, dx.data());
    response_ = made_ == Made::field ? s.Efd : s.Tm;
  }
  void evaluate(const Seen& at) { evaluate(at, x_, dx_); }
  /// Integrates over the step lengths[length] from the last point of evaluate(). `seen`: inputs of the stages
  /// after the first.
  void step(std::size_t length, std::span<const Seen, kFormulaStages - 1> seen) {
    const double per_h = 1 / lengths_[length];
    const Triangles& triangles = triangles_for(length);
    take_stages(seen, per_h, triangles, std::make_index_sequence<kFormulaStages>());
    // the method is stiffly accurate: its weights are those of the last stage, and 1 for that stage's own u
    for (std::size_t i = 0; i < x_.size(); ++i)
      x_[i] = weighted<kFormulaStages - 1>(x_[i], i, kFormula.a.back()) + u_.back()[i];
    clip(x_);
  }

 private:
  /// Triangular factors of one step length; entries in the order of `left_` and `right_`.
  struct Triangles {
    std::vector<P8> left, right, reciprocal;  ///< below, above and reciprocal of the diagonal
  };
  /// Columns of the non-zero entries of all rows, row by row.
  struct Entries {
    std::vector<std::size_t> columns, ends;  ///< columns; end of each row
  };

  /// Returns value + sum of weights[j] u_[j][i] over the first `count` stages.
  template <std::size_t count>
  [[nodiscard]] P8 weighted(P8 value, std::size_t i, const std::array<double, kFormulaStages>& weights,
                            double factor = 1.0) const {
    for (std::size_t j = 0; j < count; ++j)
      if (weights[j] != 0.0) value = value + P8(factor * weights[j]) * u_[j][i];
    return value;
  }
  template <std::size_t... stages>
  void take_stages(std::span<const Seen, kFormulaStages - 1> seen, double per_h, const Triangles& triangles,
                   std::index_sequence<stages...>) {
    (take_stage<stages>(seen, per_h, triangles), ...);
  }
  template <std::size_t stage>
  void take_stage(std::span<const Seen, kFormulaStages - 1> seen, double per_h, const Triangles& triangles) {
    const std::size_t n = x_.size();
    if constexpr (stage > 0) {
      for (std::size_t i = 0; i < n; ++i) trial_[i] = weighted<stage>(x_[i], i, kFormula.a[stage]);
      clip(trial_);
      evaluate(seen[stage - 1], trial_, dx_);
    }
    P8* u = u_[stage].data();
    for (std::size_t i = 0, k = 0; i < n; ++i) {
      P8 value = weighted<stage>(dx_[i], i, kFormula.inverse[stage], -per_h);
      for (; k < left_.ends[i]; ++k) value = value - triangles.left[k] * u[left_.columns[k]];
      u[i] = value;
    }
    for (std::size_t i = n; i-- > 0;) {
      P8 value = u[i];
      for (std::size_t k = i > 0 ? right_.ends[i - 1] : 0; k < right_.ends[i]; ++k)
        value = value - triangles.right[k] * u[right_.columns[k]];
      u[i] = value * triangles.reciprocal[i];
    }
  }
  void clip(std::vector<P8>& x) {
    P8 moved(0.0);
    equations_.clamp_states(c_.data(), x.data(), moved);
  }
  /// Computes the Jacobian of the controls at their start by finite differences.
  void linearise(const Seen& start) {
    constexpr double kRateMove = 1e-6;
    const std::size_t n = x_.size();
    std::vector<P8> moved(n), x = x_;
    for (auto& value : x) value = value + P8(kRateMove);  // away from the corner of a dead-band
    evaluate(start, x, dx_);
    for (std::size_t j = 0; j < n; ++j) {
      const P8 before = x[j];
      x[j] = before + P8(kRateMove);
      evaluate(start, x, moved);
      x[j] = before;
      for (std::size_t i = 0; i < n; ++i) jacobian_[i * n + j] = (moved[i] - dx_[i]) * P8(1 / kRateMove);
    }
  }
  /// Returns the LU factors of 1 / (gamma h) - Jacobian. Controls are chains of lags, so few entries are
  /// non-zero. No pivoting is needed: the lags' own rates are negative, so the diagonal is large.
  const Triangles& triangles_for(std::size_t length) {
    Triangles& triangles = triangles_[length];
    const std::size_t n = x_.size();
    if (triangles.reciprocal.size() == n) return triangles;
    std::vector<P8> all(n * n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        all[i * n + j] = P8(i == j ? 1 / (kGamma * lengths_[length]) : 0.0) - jacobian_[i * n + j];
    for (std::size_t k = 0; k < n; ++k) {
      all[k * n + k] = P8(1.0) / all[k * n + k];
      for (std::size_t i = k + 1; i < n; ++i) {
        if (!there_[i * n + k]) continue;
        const P8 factor = all[i * n + k] = all[i * n + k] * all[k * n + k];
        for (std::size_t j = k + 1; j < n; ++j)
          if (there_[k * n + j]) all[i * n + j] = all[i * n + j] - factor * all[k * n + j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      triangles.reciprocal.push_back(all[i * n + i]);
      for (std::size_t j = 0; j < n; ++j)
        if (j != i && there_[i * n + j]) (j < i ? triangles.left : triangles.right).push_back(all[i * n + j]);
    }
    return triangles;
  }
  /// Finds the non-zero entries left and right of the diagonal, including the fill-in of the elimination.
  void find_entries() {
    const std::size_t n = x_.size();
    there_.resize(n * n);
    for (std::size_t i = 0; i < n * n; ++i)
      there_[i] = any_positive(jacobian_[i]) || any_positive(-jacobian_[i]);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = k + 1; i < n; ++i)
        for (std::size_t j = k + 1; there_[i * n + k] && j < n; ++j)
          there_[i * n + j] = there_[i * n + j] || there_[k * n + j];
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        if (i != j && there_[i * n + j]) (j < i ? left_ : right_).columns.push_back(j);
      left_.ends.push_back(left_.columns.size());
      right_.ends.push_back(right_.columns.size());
    }
  }

  Made made_;
  sim::plant::PlantEquations<P8> equations_;
  double ifd_, efd_ = 0, tm_ = 0;
  std::vector<P8> c_, x_, dx_, trial_, scratch_, jacobian_;
  std::vector<char> there_;  ///< whether an entry of the LU factors is non-zero
  Entries left_, right_;     ///< non-zero entries below and above the diagonal
  std::array<std::vector<P8>, kFormulaStages> u_;
  const std::vector<double>& lengths_;  ///< step lengths [s]
  std::vector<Triangles> triangles_;    ///< LU factors for each step length, empty until needed
  std::array<char, kLanes> initialised_{};
  P8 response_{0.0};
  sim::Signals<P8> signals_;  ///< unwritten signals remain zero
};

Seen mixed(const Seen& a, const Seen& b, double share) {
  const auto of = [share](auto x, auto y) { return x + share * (y - x); };
  return {of(a.t, b.t),         a.segment,        of(a.V, b.V),     of(a.I, b.I),
          of(a.speed, b.speed), of(a.Ifd, b.Ifd), of(a.Efd, b.Efd), of(a.Tm, b.Tm)};
}

/// Returns h rounded, so that equal steps compare equal despite the rounding errors of times.
double rounded(double h) { return static_cast<double>(static_cast<float>(h)); }

}  // namespace

OpenLoop::OpenLoop(SeenAlong run, const std::vector<double>& times, const sim::Conventions& conventions)
    : steady_(run.steady), seen_(std::move(run.seen)), conventions_(conventions) {
  const int segments = seen_.back().segment + 1;
  for (int s = 0; s <= segments; ++s)
    first_of_.push_back(
        static_cast<std::size_t>(std::ranges::lower_bound(seen_, s, {}, &Seen::segment) - seen_.begin()));
  std::size_t next = 0;
  for (int s = segments > 1 ? 1 : 0; s < segments; ++s) {
    const double from = seen_[first_of_[static_cast<std::size_t>(s)]].t,
                 to = seen_[first_of_[static_cast<std::size_t>(s) + 1] - 1].t;
    times_.push_back({from, s});
    constexpr double kTimesApart = 1e-7;  // [s]
    while (next < times.size() && times[next] <= from + kTimesApart) ++next;
    for (; next < times.size() && times[next] < to - kTimesApart; ++next) times_.push_back({times[next], s});
    if (to > from + kTimesApart) times_.push_back({to, s});
  }
  for (std::size_t k = 0; k + 1 < times_.size(); ++k) {
    const TimePoint &a = times_[k], &b = times_[k + 1];
    const double h = a.segment == b.segment ? rounded(b.t - a.t) : 0.0;
    Step& step = steps_.emplace_back(Step{.h = h, .begin = between(a.segment, a.t)});
    const auto known = std::ranges::find(lengths_, h);
    step.length = static_cast<std::size_t>(known - lengths_.begin());
    if (h > 0 && known == lengths_.end()) lengths_.push_back(h);
    for (std::size_t stage = 1; h > 0 && stage < kFormulaStages; ++stage)
      step.stages[stage - 1] = between(a.segment, a.t + kFormula.at[stage] * h);
  }
}

std::vector<double> OpenLoop::looks(const std::vector<double>& times) {
  std::vector<double> all;
  for (std::size_t k = 0; k < times.size(); ++k) {
    all.push_back(times[k]);
    for (std::size_t stage = 1; k + 1 < times.size() && stage < kFormulaStages; ++stage)
      all.push_back(times[k] + kFormula.at[stage] * (times[k + 1] - times[k]));
  }
  std::ranges::sort(all);
  return all;
}

Seen OpenLoop::between(int segment, double t) const {
  const auto s = static_cast<std::size_t>(segment);
  const auto begin = seen_.begin() + static_cast<std::ptrdiff_t>(first_of_[s]),
             end = seen_.begin() + static_cast<std::ptrdiff_t>(first_of_[s + 1]);
  const auto above = std::upper_bound(begin, end, t, [](double at, const Seen& x) { return at < x.t; });
  if (above == begin) return *begin;
  if (above == end) return *(end - 1);
  const Seen &a = *(above - 1), &b = *above;
  return mixed(a, b, (t - a.t) / (b.t - a.t));
}

Eigen::MatrixXd OpenLoop::run(Made made, std::span<const sim::plant::Plant> plants) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(times_.size()),
                                                  static_cast<Eigen::Index>(plants.size()),
                                                  std::numeric_limits<double>::quiet_NaN());
  for (std::size_t first = 0; first < plants.size(); first += kLanes) {
    const auto some = plants.subspan(first, std::min(kLanes, plants.size() - first));
    BlockBatch controls(made, some, steady_, conventions_, lengths_);
    if (!controls.any()) continue;
    const auto keep = [&](std::size_t k) {
      for (std::size_t lane = 0; lane < some.size(); ++lane)
        if (controls.initialised(lane))
          all(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(first + lane)) =
              controls.response(lane);
    };
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      controls.evaluate(steps_[k].begin);
      keep(k);
      if (steps_[k].h > 0) controls.step(steps_[k].length, steps_[k].stages);
    }
    controls.evaluate(between(times_.back().segment, times_.back().t));
    keep(steps_.size());
  }
  return all;
}

}  // namespace swingbank::validate::playin
