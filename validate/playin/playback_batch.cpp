#include "validate/playin/playback_batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "validate/playin/detail/packed_matrix.hpp"
#include "validate/playin/detail/pairs.hpp"
#include "validate/playin/detail/playback_equations.hpp"

namespace swingbank::validate::playin {
namespace {

using sim::P8, by_pack::kLanes;

constexpr int kStepsOfAll =
    3;  ///< ratio of the batch's step limit to that of one plant; common steps are shorter

P8 size_of(P8 a) { return sim::positive_part(a) + sim::positive_part(-a); }

class Together {
 public:
  explicit Together(std::span<const PlaybackRun> runs)
      : runs_(runs), equations_(packed(runs)), x_(equations_.x0) {
    const std::size_t n = x_.size();
    for (auto& k : k_) k.resize(n);
    trial_.resize(n);
    allowed_.assign(n, P8(runs.front().tolerance));
    for (std::size_t lane = 0; any() && lane < runs.size(); ++lane)
      for (std::size_t i = 0; i < runs[lane].allowance.size(); ++i)
        allowed_[i].set(static_cast<int>(lane), runs[lane].tolerance * runs[lane].allowance[i]);
    look_ahead();
  }

  std::vector<std::optional<Response>> run() {
    if (!any())
      return std::vector<std::optional<Response>>(runs_.size());  // no operating point has a steady state
    const record::Record& r = *runs_.front().record;
    const auto& switchings = runs_.front().curve->switchings();
    for (auto& response : responses_)
      for (auto& values : response.value) values.reserve(r.t.size());
    const double slack = r.time_slack();
    t_ = r.t.front();
    for (const double sample : r.t) {
      if (sample > runs_.front().until) break;
      while (next_ < switchings.size() && sample > switchings[next_].time + slack) {
        advance(switchings[next_].time);
        equations_.pass(static_cast<int>(next_), x_.data());
        ++next_;
        look_ahead();
        fresh_ = true;
      }
      advance(sample);
      record();
    }
    std::vector<std::optional<Response>> back(runs_.size());
    for (std::size_t lane = 0; lane < runs_.size(); ++lane)
      if (alive_[lane]) back[lane] = std::move(responses_[lane]);
    return back;
  }

 private:
  /// Returns the equations of all runs. A run whose operating point has no steady state is replaced by a
  /// copy of another.
  PlaybackEquations<P8> packed(std::span<const PlaybackRun> runs) {
    sim::plant::OperatingOf<P8> at;
    bool first = true;
    for (std::size_t lane = 0; lane < runs.size(); ++lane) {
      try {
        const PlaybackEquations<double> one(runs[lane], {});
        if (first) {
          at.c.assign(one.c.begin(), one.c.end());
          at.x.assign(one.x0.begin(), one.x0.end());
          at.Efd = P8(one.Efd);
          at.Tm = P8(one.Tm);
          first = false;
        }
        const int l = static_cast<int>(lane);
        for (std::size_t i = 0; i < at.c.size(); ++i) at.c[i].set(l, one.c[i]);
        for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i].set(l, one.x0[i]);
        at.Efd.set(l, one.Efd);
        at.Tm.set(l, one.Tm);
        alive_[lane] = 1;
      } catch (const InputError&) {
      }
    }
    return {runs.front(), {}, std::move(at)};
  }
  [[nodiscard]] bool any() const { return std::ranges::count(alive_, 1) > 0; }
  void look_ahead() {
    const auto& switchings = runs_.front().curve->switchings();
    equations_.side.last_moment =
        next_ < switchings.size() ? switchings[next_].time - sim::plant::kBeforeSwitching : 1e300;
  }

  void advance(double to) {
    while (t_ < to && any()) {
      interruption_point();
      const double left = to - t_;
      const bool reaches = h_ >= left * (1 - 1e-12);
      const double h = reaches ? left : h_;
      double error = attempt(h);
      if (error > 1 && h <= runs_.front().least_step) error = 1;
      if (error <= 1) {
        t_ = reaches ? to : t_ + h;
        std::swap(x_, trial_);
        std::swap(k_.front(), k_[static_cast<std::size_t>(kRoughSteps.stages - 1)]);
        P8 moved(0.0);
        equations_.of_plant().clamp_states(equations_.c.data(), x_.data(), moved);
        fresh_ = any_positive(moved);
      }
      if (error > 1 ? h < kShortestStep : ++steps_ > kStepsOfAll * runs_.front().step_limit) give_up_worst();
      h_ = next_step(h_, h, error, rough_power(error, kRoughSteps), reaches);
    }
    t_ = std::max(t_, to);
  }
  double attempt(double h) {
    if (fresh_) equations_.evaluate(t_, x_.data(), k_[0].data());
    fresh_ = false;
    const std::size_t n = x_.size();
    for (int stage = 1; stage < kRoughSteps.stages; ++stage) {
      for (std::size_t i = 0; i < n; ++i) {
        P8 sum(0.0);
        for (int j = 0; j < stage; ++j)
          if (const double a = kRoughA[stage][j]; a != 0.0)
            sum = sum + P8(a) * k_[static_cast<std::size_t>(j)][i];
        trial_[i] = x_[i] + P8(h) * sum;
      }
      equations_.evaluate(t_ + kRoughC[stage] * h, trial_.data(), k_[static_cast<std::size_t>(stage)].data());
    }
    errors_ = P8(0.0);
    P8 finite(0.0);
    for (std::size_t i = 0; i < n; ++i) {
      P8 missed(0.0);
      for (int j = 0; j < kRoughSteps.stages; ++j)
        missed = missed + P8(kRoughError[j]) * k_[static_cast<std::size_t>(j)][i];
      const P8 ratio = P8(h) * size_of(missed) / (allowed_[i] * (P8(1.0) + size_of(x_[i])));
      errors_ = select(ratio > errors_, ratio, errors_);
      finite = finite + P8(0.0) * (ratio + trial_[i]);
    }
    double worst = 0;
    for (std::size_t lane = 0; lane < runs_.size(); ++lane) {
      const int l = static_cast<int>(lane);
      if (!alive_[lane]) continue;
      if (!(finite[l] == 0.0)) errors_.set(l, kNotFinite);
      worst = std::max(worst, errors_[l]);
    }
    return worst;
  }
  void give_up_worst() {
    std::size_t worst = 0;
    for (std::size_t lane = 1; lane < runs_.size(); ++lane)
      if (alive_[lane] &&
          (!alive_[worst] || errors_[static_cast<int>(lane)] > errors_[static_cast<int>(worst)]))
        worst = lane;
    alive_[worst] = 0;
    steps_ = 0;
  }

  void record() {
    if (!any()) return;
    if (fresh_) equations_.evaluate(t_, x_.data(), k_[0].data());
    fresh_ = false;
    auto out = equations_.outputs(x_.data());
    const double frame = runs_.front().start.drift / (constants::turn * runs_.front().conventions.frequency);
    out[static_cast<std::size_t>(Output::speed)] = equations_.signals.speed + P8(frame);
    const Complex v = equations_.voltage(t_);
    for (std::size_t lane = 0; lane < runs_.size(); ++lane) {
      if (!alive_[lane]) continue;
      responses_[lane].voltage.push_back(v);
      for (std::size_t o = 0; o < kOutputs; ++o)
        responses_[lane].value[o].push_back(out[o][static_cast<int>(lane)]);
    }
  }

  static constexpr double kNotFinite = 1e30;  ///< error assigned to a step that is not finite [-]
  std::span<const PlaybackRun> runs_;
  std::array<char, kLanes> alive_{};
  PlaybackEquations<P8> equations_;
  std::vector<P8> x_, trial_, allowed_;
  std::array<std::vector<P8>, std::size_t(kRoughSteps.stages)> k_;
  P8 errors_{0.0};
  std::array<Response, kLanes> responses_;
  bool fresh_ = true;  ///< k_[0] must be evaluated anew
  std::size_t next_ = 0;
  long steps_ = 0;
  double t_ = 0, h_ = 1e-3;
};

/// Returns whether the run can share its steps with other runs of a batch.
bool can_go_together(const PlaybackRun& run) {
  return run.tolerance >= kRoughTolerance && !is_recorded(*run.plant) && !run.given && run.torque.t.empty() &&
         run.field.t.empty() && run.record->staged.empty() && !run.record->breaker() &&
         !run.record->open_circuit() && sim::plant::switching_times_of(*run.plant).empty();
}

std::optional<Response> alone(const PlaybackRun& run) {
  try {
    return simulate_playback(run);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::optional<Response>> simulate_playback_batch(std::span<const PlaybackRun> runs) {
  std::vector<std::optional<Response>> all;
  for (std::size_t first = 0; first < runs.size(); first += kLanes) {
    const auto some = runs.subspan(first, std::min(kLanes, runs.size() - first));
    if (some.size() > 1 && std::ranges::all_of(some, can_go_together)) {
      std::ranges::move(Together(some).run(), std::back_inserter(all));
      continue;
    }
    for (const PlaybackRun& run : some) all.push_back(alone(run));
  }
  return all;
}

}  // namespace swingbank::validate::playin
