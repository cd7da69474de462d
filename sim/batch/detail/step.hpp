#pragma once
// Batch kernel: the integration loop. Every step of a SIMD pack advances each lane (one event) by its own
// step size. Acceptance, switching and refill are independent per lane.
#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

/// Evaluates the first stage of lanes that were loaded, switched or clamped. The other lanes reuse the last
/// stage of their previous step (first same as last).
template <class T>
void BatchKernel<T>::evaluate_fresh() {
  if (timed_) {
    alignas(64) double now[kLanes];
    for (int l = 0; l < kLanes; ++l) now[l] = lanes_[static_cast<std::size_t>(l)].clock.t;
    time_ = Traits::load(now);
  }
  derivative(y_.data(), kept_.data());
  const auto fresh = Traits::mask(fresh_);
  for (Watch& watch : watched_) {
    watch.start = select(fresh, watch.last, watch.start);
    watch.rested = select(fresh, T(0.0), watch.rested);
  }
  for (std::size_t i = 0; i < y_.size(); ++i) k_[0][i] = select(fresh, kept_[i], k_[0][i]);
  fresh_ = 0;
}

template <class T>
template <int Stage>
void BatchKernel<T>::stage(const T& h) {
  const T* y = y_.data();
  T* trial = trial_.data();
  for (const int state : moving_) {
    const auto i = static_cast<std::size_t>(state);
    T sum = T(plant::dp54::a[Stage][0]) * k_[0][i];
    for (int j = 1; j < Stage; ++j)
      if (plant::dp54::a[Stage][j] != 0.0) sum = sum + T(plant::dp54::a[Stage][j]) * k_[j][i];
    if constexpr (kCarries) {
      move_[i] = carry_[i] + h * sum;
      trial[i] = y[i] + move_[i];
    } else {
      trial[i] = y[i] + h * sum;
    }
  }
  if (timed_) time_ = start_ + T(plant::dp54::c[Stage]) * h;
  derivative(trial, k_[Stage].data());
}

/// Returns the largest weighted error over the states, in units of the tolerance.
template <class T>
T BatchKernel<T>::scaled_error(const T& h) const {
  T worst(0.0);
  const auto add = [&worst](const T& e) { worst = maximum_or_nan(worst, e); };
  for (const int state : moving_) add(own_error(static_cast<std::size_t>(state)));
  if (weighs_)
    for (const Weighed& w : weighed_)
      add(own_error(static_cast<std::size_t>(w.state)) *
          per_lane_.c[static_cast<std::size_t>(w.coefficient)]);
  for (const Watch& watch : watched_) {
    const T kink = has_kink(watch);
    for (int i = watch.first; i < watch.first + watch.count; ++i)
      add(kink * kink_error(static_cast<std::size_t>(i)));
  }
  for (const int i : kinked_) add(kink_error(static_cast<std::size_t>(i)));
  for (const int i : stopped_) {
    const auto state = static_cast<std::size_t>(i);
    add(leaves_limit(state) * kink_error(state));
  }
  return worst * h;
}

/// Returns the weighted embedded error estimate of a state, divided by h.
template <class T>
T BatchKernel<T>::own_error(std::size_t state) const {
  T sum = T(plant::dp54::error[0]) * k_[0][state];
  for (int j = 2; j < plant::dp54::kStages; ++j) sum = sum + T(plant::dp54::error[j]) * k_[j][state];
  return absolute(sum) * T(weight_[state]);
}

/// Returns 1 if a state leaves its limit within the step, else 0.
template <class T>
T BatchKernel<T>::leaves_limit(std::size_t state) const {
  const T zero(0.0), one(1.0), first = absolute(k_[0][state]),
                               last = absolute(k_[plant::dp54::kStages - 1][state]);
  return select(first <= zero, select(last <= zero, zero, one), zero);
}

/// Returns 1 if Vs reaches or leaves a limit within the step, else 0.
template <class T>
T BatchKernel<T>::has_kink(const Watch& watch) const {
  const T zero(0.0), one(1.0);
  const T moves = select(watch.same + watch.rested <= zero, zero, one);
  return select(T(plant::dp54::kStages - 1) <= watch.same, zero, moves);
}

/// Updates the watch after the evaluation of a stage.
template <class T>
void BatchKernel<T>::watch_stage(Watch& watch, const T& vs) {
  const T now = vs, zero(0.0), one(1.0);
  watch.rested_next = select(now <= watch.last, select(watch.last <= now, one, zero), zero);
  watch.same = watch.same + watch.rested_next;
  watch.last = now;
}

/// Returns the weighted error estimate of a state for a kink within the step, divided by h; see dp54::kink.
template <class T>
T BatchKernel<T>::kink_error(std::size_t state) const {
  T worst(0.0);
  for (const auto& difference : plant::dp54::kink) {
    T sum =
        T(difference[2]) * k_[2][state] + T(difference[3]) * k_[3][state] + T(difference[6]) * k_[6][state];
    sum = sum + T(difference[0]) * k_[0][state] + T(difference[4]) * k_[4][state];
    worst = maximum_or_nan(worst, absolute(sum));
  }
  return worst * T(kKinkShare * std::max(weight_[state], kKinkWeight / options_.tolerance));
}

/// Returns the largest change of the angle between two rotors since the start [rad].
template <class T>
T BatchKernel<T>::angle_spread(const T* x) const {
  T low(std::numeric_limits<Real>::max()), high = -low;
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    if (!plants_[i].rotor) continue;
    const T delta = x[plants_[i].x] - rest_[i];
    if (tripped_ != 0) {
      const auto on = per_lane_.on[i] > T(0.5);
      low = minimum(low, select(on, delta, low));
      high = maximum(high, select(on, delta, high));
    } else {
      low = minimum(low, delta);
      high = maximum(high, delta);
    }
  }
  return maximum(high - low, T(0.0));
}

/// Returns, for a lane with several islands, the largest change of the angle between two rotors of the same
/// island since the start [rad].
template <class T>
double BatchKernel<T>::angle_spread_within_islands(int lane) const {
  const auto l = static_cast<std::size_t>(lane);
  const std::vector<int>& island = lanes_[l].islands;
  std::map<int, std::pair<double, double>> range;
  alignas(64) double moved[kLanes], on[kLanes];
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    if (!plants_[i].rotor) continue;
    Traits::store(y_[static_cast<std::size_t>(plants_[i].x)] - rest_[i], moved);
    Traits::store(per_lane_.on[i], on);
    if (on[l] < 0.5) continue;
    auto& [low, high] = range.emplace(island[i], std::pair{moved[l], moved[l]}).first->second;
    low = std::min(low, moved[l]);
    high = std::max(high, moved[l]);
  }
  double worst = 0.0;
  for (const auto& [number, ends] : range) worst = std::max(worst, ends.second - ends.first);
  return worst;
}

template <class T>
void BatchKernel<T>::commit(unsigned accepted) {
  const auto ok = Traits::mask(accepted);
  for (const int state : moving_) {
    const auto i = static_cast<std::size_t>(state);
    if constexpr (kCarries) {  // Knuth's two-sum: the sum and its rounding error
      const T added = trial_[i] - y_[i];
      const T lost = (y_[i] - (trial_[i] - added)) + (move_[i] - added);
      carry_[i] = select(ok, lost, carry_[i]);
    }
    y_[i] = select(ok, trial_[i], y_[i]);
    k_[0][i] = select(ok, k_[6][i], k_[0][i]);
  }
  for (Watch& watch : watched_) {
    watch.start = select(ok, watch.last, watch.start);
    watch.rested = select(ok, watch.rested_next, watch.rested);
  }
  if (limited_) clamp_states();
}

/// Clamps states that overshot a limit within the step, and marks the first stage of their lanes for
/// re-evaluation.
template <class T>
void BatchKernel<T>::clamp_states() {
  T moved(0.0);
  for (const auto& p : plants_)
    p.equations.clamp_states(&per_lane_.c[static_cast<std::size_t>(p.c)], &y_[static_cast<std::size_t>(p.x)],
                             moved);
  alignas(64) double by[kLanes];
  Traits::store(moved, by);
  for (int l = 0; l < kLanes; ++l)
    if (by[l] > 0.0) {
      fresh_ |= 1U << l;
      if constexpr (kCarries)
        for (const int state : stopped_) Traits::set(carry_[static_cast<std::size_t>(state)], l, 0.0);
    }
}

/// Finishes a step: hands over runs that failed, lost synchronism or reached their end, and starts the next
/// segment of lanes at a switching time.
template <class T>
void BatchKernel<T>::settle(unsigned accepted, const Next& next, const Done& done) {
  alignas(64) double angle[kLanes];
  Traits::store(angle_spread(y_.data()), angle);
  // If the step was rejected, lanes whose Newton's method restarted from V = 0 (solve_algebra) start from 1
  // pu in the next one.
  if (const unsigned again = per_lane_.fallen & ~accepted; again != 0) begin_search(per_lane_, again, 1.0);
  per_lane_.fallen = 0;
  for (int l = 0; l < kLanes; ++l) {
    auto& run = lanes_[static_cast<std::size_t>(l)];
    if (!((active_ >> l) & 1U)) continue;
    if (!((accepted >> l) & 1U)) {
      if (run.clock.h > LaneClock::kShortestStep) continue;
      hand_over(l, std::isfinite(angle[l]) ? Outcome::step_too_small : Outcome::not_finite, done);
      refill(l, next, done);
      continue;
    }
    if (!run.islands.empty()) angle[l] = angle_spread_within_islands(l);
    if (angle[l] > run.record.largest_spread) run.record.largest_spread = angle[l];
    const bool lost = angle[l] > options_.lose_at;
    if (lost || run.clock.t >= options_.t_end) {
      hand_over(l, lost ? Outcome::lost_synchronism : Outcome::stable, done);
      refill(l, next, done);
    } else if (run.clock.t >= run.clock.next) {
      evaluate_pending(l, run.pending);  // with the matrices of the segment that ends
      ++run.segment;
      enter_segment(l);
    }
  }
}

template <class T>
void BatchKernel<T>::run(const Next& next, const Done& done) {
  active_ = 0;
  for (int l = 0; l < kLanes; ++l) refill(l, next, done);
  while (active_ != 0) {
    if (fresh_ != 0) evaluate_fresh();
    alignas(64) double tried[kLanes], error[kLanes];
    alignas(64) double start[kLanes];
    bool reaches[kLanes];
    for (int l = 0; l < kLanes; ++l) tried[l] = lanes_[static_cast<std::size_t>(l)].clock.step(reaches[l]);
    const T h = Traits::load(tried);
    if (timed_) {
      for (int l = 0; l < kLanes; ++l) start[l] = lanes_[static_cast<std::size_t>(l)].clock.t;
      start_ = Traits::load(start);
    }
    for (Watch& watch : watched_) {
      watch.last = watch.start;
      watch.same = T(0.0);
    }
    stage<1>(h);
    stage<2>(h);
    stage<3>(h);
    stage<4>(h);
    stage<5>(h);
    stage<6>(h);
    Traits::store(scaled_error(h), error);
    unsigned accepted = 0;
    for (int l = 0; l < kLanes; ++l) {
      if (!((active_ >> l) & 1U)) continue;
      auto& clock = lanes_[static_cast<std::size_t>(l)].clock;
      start[l] = clock.t;
      if (!clock.judge(tried[l], error[l])) continue;
      accepted |= 1U << l;
      clock.t = reaches[l] ? clock.next : clock.t + tried[l];
    }
    record_step(h, accepted, start, tried);
    commit(accepted);
    settle(accepted, next, done);
  }
}

}  // namespace swingbank::sim::batch
