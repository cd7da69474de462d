#include "validate/playin/open_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/problem.hpp"
#include "sim/plant/equations.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/detail/recorded.hpp"

namespace swingbank::validate::playin {
namespace {

using sim::P8;
constexpr auto kBlockLanes = std::size_t(P8::lanes);

/// Runge-Kutta's classical formula is stable up to 2.78 over the fastest rate, and per cents off up to this.
constexpr double kStable = 1.2;
/// A plant that needs more of them runs away: its response is not finite.
constexpr int kMostSubsteps = 16;

/// Controls of up to eight plants in lanes.
class BlockLanes {
 public:
  BlockLanes(Made made, std::span<const sim::plant::Plant> plants, const Seen& start,
             const sim::Conventions& conventions)
      : made_(made), equations_(plants.front()), ifd_(start.Ifd) {
    const double P = (start.V * std::conj(start.I)).real(), Q = (start.V * std::conj(start.I)).imag();
    scratch_.resize(static_cast<std::size_t>(equations_.scratch()));
    for (std::size_t lane = 0; lane < plants.size(); ++lane) {
      auto p = sim::plant::block_parameters(plants[lane]);
      p.front() = recorded::standing<double>(start.Efd, start.Ifd, start.Tm);
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
    for (auto& k : k_) k.assign(x_.size(), P8(0.0));  // the recorded machine has no dynamics
    trial_.resize(x_.size());
  }
  [[nodiscard]] bool any() const { return !c_.empty(); }
  [[nodiscard]] bool initialised(std::size_t lane) const { return initialised_[lane] != 0; }
  [[nodiscard]] double response(std::size_t lane) const { return response_[static_cast<int>(lane)]; }

  /// Derivatives of the states, and the response. Derivatives are not held at non-windup limits: each stage
  /// is clipped instead, so that a state which meets its limit within a step ends at that limit exactly.
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
  void evaluate(const Seen& at) { evaluate(at, x_, k_[0]); }
  /// One Runge-Kutta step from where evaluate() was called last.
  void step(double h, const Seen& middle, const Seen& end) {
    const std::size_t n = x_.size();
    move(0.5 * h, k_[0]);
    evaluate(middle, trial_, k_[1]);
    move(0.5 * h, k_[1]);
    evaluate(middle, trial_, k_[2]);
    move(h, k_[2]);
    evaluate(end, trial_, k_[3]);
    for (std::size_t i = 0; i < n; ++i)
      x_[i] = x_[i] + P8(h / 6) * (k_[0][i] + P8(2.0) * (k_[1][i] + k_[2][i]) + k_[3][i]);
    P8 moved(0.0);
    equations_.clamp_states(c_.data(), x_.data(), moved);
  }
  /// The fastest rate of any plant, as it is linear about its start [1/s].
  [[nodiscard]] double fastest(const Seen& start) {
    const std::size_t n = x_.size();
    std::vector<P8> still(n), moved(n), x = x_;
    std::array<Eigen::MatrixXd, kBlockLanes> A;
    A.fill(Eigen::MatrixXd(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n)));
    for (auto& value : x) value = value + P8(kRateMove);  // away from the corner of a dead-band
    evaluate(start, x, still);
    for (std::size_t j = 0; j < n; ++j) {
      const P8 before = x[j];
      x[j] = before + P8(kRateMove);
      evaluate(start, x, moved);
      x[j] = before;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t lane = 0; lane < kBlockLanes; ++lane)
          A[lane](static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
              (moved[i][static_cast<int>(lane)] - still[i][static_cast<int>(lane)]) / kRateMove;
    }
    double most = 0;
    for (std::size_t lane = 0; lane < kBlockLanes; ++lane)
      if (initialised(lane) && A[lane].allFinite())
        most = std::max(most, A[lane].eigenvalues().cwiseAbs().maxCoeff());
    return most;
  }

 private:
  static constexpr double kRateMove = 1e-6;
  void move(double h, const std::vector<P8>& k) {
    for (std::size_t i = 0; i < x_.size(); ++i) trial_[i] = x_[i] + P8(h) * k[i];
    P8 moved(0.0);
    equations_.clamp_states(c_.data(), trial_.data(), moved);
  }

  Made made_;
  sim::plant::PlantEquations<P8> equations_;
  double ifd_, efd_ = 0, tm_ = 0;
  std::vector<P8> c_, x_, trial_, scratch_;
  std::array<std::vector<P8>, 4> k_;
  std::array<char, kBlockLanes> initialised_{};
  P8 response_{0.0};
  sim::Signals<P8> signals_;  ///< what nothing writes stays zero
};

Seen mixed(const Seen& a, const Seen& b, double share) {
  const auto of = [share](auto x, auto y) { return x + share * (y - x); };
  return {of(a.t, b.t),         a.segment,        of(a.V, b.V),     of(a.I, b.I),
          of(a.speed, b.speed), of(a.Ifd, b.Ifd), of(a.Efd, b.Efd), of(a.Tm, b.Tm)};
}

}  // namespace

OpenLoop::OpenLoop(std::vector<Seen> seen, const std::vector<double>& samples,
                   const sim::Conventions& conventions)
    : seen_(std::move(seen)), conventions_(conventions) {
  const int segments = seen_.back().segment + 1;
  for (int s = 0; s <= segments; ++s)
    first_of_.push_back(
        static_cast<std::size_t>(std::ranges::lower_bound(seen_, s, {}, &Seen::segment) - seen_.begin()));
  std::size_t sample = 0;
  for (int s = segments > 1 ? 1 : 0; s < segments; ++s) {
    const double from = seen_[first_of_[static_cast<std::size_t>(s)]].t,
                 to = seen_[first_of_[static_cast<std::size_t>(s) + 1] - 1].t;
    times_.push_back({from, s});
    constexpr double kTimesApart = 1e-7;  // [s]
    while (sample < samples.size() && samples[sample] <= from + kTimesApart) ++sample;
    for (; sample < samples.size() && samples[sample] < to - kTimesApart; ++sample)
      times_.push_back({samples[sample], s});
    if (to > from + kTimesApart) times_.push_back({to, s});
  }
  for (std::size_t k = 0; k + 1 < times_.size(); ++k) {
    const TimePoint &a = times_[k], &b = times_[k + 1];
    if (a.segment != b.segment)
      steps_.push_back({0, between(a.segment, a.t), {}, {}});
    else
      steps_.push_back({b.t - a.t, between(a.segment, a.t), between(a.segment, 0.5 * (a.t + b.t)),
                        between(a.segment, b.t)});
  }
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
  // all take the same steps, so that the integration error is common to the responses that are compared
  std::vector<BlockLanes> packs;
  double fastest = 0;
  for (std::size_t first = 0; first < plants.size(); first += kBlockLanes) {
    packs.emplace_back(made, plants.subspan(first, std::min(kBlockLanes, plants.size() - first)),
                       seen_.front(), conventions_);
    if (packs.back().any()) fastest = std::max(fastest, packs.back().fastest(seen_.front()));
  }
  for (std::size_t first = 0; first < plants.size(); first += kBlockLanes) {
    const auto some = plants.subspan(first, std::min(kBlockLanes, plants.size() - first));
    BlockLanes& controls = packs[first / kBlockLanes];
    if (!controls.any()) continue;
    const auto keep = [&](std::size_t k) {
      for (std::size_t lane = 0; lane < some.size(); ++lane)
        if (controls.initialised(lane))
          all(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(first + lane)) =
              controls.response(lane);
    };
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const Step& s = steps_[k];
      const auto at = [&](double share) {
        return share <= 0.5 ? mixed(s.begin, s.middle, 2 * share) : mixed(s.middle, s.end, 2 * share - 1);
      };
      const int substeps = std::clamp(static_cast<int>(std::ceil(s.h * fastest / kStable)), 1, kMostSubsteps);
      controls.evaluate(s.begin);
      keep(k);
      for (int part = 0; part < substeps && s.h > 0; ++part) {
        if (part > 0) controls.evaluate(at(double(part) / substeps));
        controls.step(s.h / substeps, at((part + 0.5) / substeps), at((part + 1.0) / substeps));
      }
    }
    if (!steps_.empty()) {
      controls.evaluate(steps_.back().end);
      keep(steps_.size());
    }
  }
  return all;
}

}  // namespace swingbank::validate::playin
