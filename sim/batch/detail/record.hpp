#pragma once
// Batch kernel: recording. The states at the sample times are interpolated lane by lane and buffered. The
// outputs are evaluated once the buffer is full or the segment ends, with the lanes of a pack as consecutive
// samples of one event. This occupies every lane, independent of the step sizes, and writes each channel in
// whole cache lines.
#include <algorithm>
#include <array>

#include "base/constants.hpp"
#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

/// Computes the dense-output coefficients y0, d0 to d3 of one state, each in a row:
/// y(theta) = y0 + theta (d0 + (1 - theta)(d1 + theta (d2 + (1 - theta) d3))), theta in 0 to 1.
template <class T>
void BatchKernel<T>::dense(std::size_t state, const T& h, T* row) const {
  const std::size_t i = state;
  const T delta = trial_[i] - y_[i];
  const T excess = h * k_[0][i] - delta;
  T d = T(plant::dp54::dense[0]) * k_[0][i];
  for (int j = 2; j < plant::dp54::kStages; ++j) d = d + T(plant::dp54::dense[j]) * k_[j][i];
  row[0] = y_[i];
  row[1] = delta;
  row[2] = excess;
  row[3] = delta - h * k_[6][i] - excess;
  row[4] = h * d;
}

/// Records the samples in (start, start + tried] of every accepted lane. If a step has more samples than the
/// buffer holds, they are recorded in several parts.
template <class T>
void BatchKernel<T>::record_step(const T& h, unsigned accepted, const double* start, const double* tried) {
  for (;;) {
    due_.clear();
    for (int l = 0; l < kLanes; ++l) {
      if (!((accepted >> l) & 1U)) continue;
      const auto& run = lanes_[static_cast<std::size_t>(l)];
      const int left = samples_until(run.clock.t) - run.recorded - run.pending;
      const int capacity =
          (kBufferSamples - run.pending) / kLanes * kLanes - kLanes;  // drop_waiting() moves whole packs
      if (left > 0) due_.push_back({l, std::min(left, capacity)});
    }
    if (due_.empty()) return;
    interpolate(h, start, tried);
    for (const Due& due : due_) {
      auto& run = lanes_[static_cast<std::size_t>(due.lane)];
      run.pending += due.count;
      if (run.pending >= kWaiting) evaluate_pending(due.lane, kWaiting - (run.recorded + kWaiting) % kLanes);
    }
  }
}

/// Interpolates the states at the due samples, state by state, because one state's values of all lanes are
/// adjacent. The buffer is ordered by pack, so that the states of a pack are written to consecutive lines.
/// New samples that do not start at a pack boundary are split between two packs.
template <class T>
void BatchKernel<T>::interpolate(const T& h, const double* start, const double* tried) {
  struct Pass {
    T a, b;    ///< theta, 1 - theta
    Real* to;  ///< the pack's first state
    int lane, offset;
    decltype(Traits::mask(0U)) later;  ///< samples that belong to this pack, not to the next
  };
  const double spacing = 1.0 / options_.rate;
  const std::size_t values = y_.size() * kLanes;  // number of values of one pack
  std::array<Pass, kBufferSamples> passes;
  std::size_t count = 0;
  for (const Due& due : due_) {
    auto& run = lanes_[static_cast<std::size_t>(due.lane)];
    const double inverse = 1.0 / tried[due.lane];
    const int offset = run.pending % kLanes;
    for (int done = 0; done < due.count; done += kLanes) {
      alignas(64) double theta[kLanes];
      const int first = run.recorded + run.pending + done;
      for (int s = 0; s < kLanes; ++s)
        theta[(s + offset) % kLanes] = std::min(1.0, ((first + s) * spacing - start[due.lane]) * inverse);
      const T a = Traits::load(theta);
      const auto pack = static_cast<std::size_t>((run.pending + done) / kLanes);
      passes[count++] = {a,        T(1.0) - a, waiting(run) + pack * values,
                         due.lane, offset,     Traits::mask(~((1U << offset) - 1U))};
    }
  }
  for (const int state : sampled_) {
    T rows[5];
    dense(static_cast<std::size_t>(state), h, rows);
    const Real* d = reinterpret_cast<const Real*>(rows);
    const std::size_t place = static_cast<std::size_t>(state) * kLanes;
    for (std::size_t k = 0; k < count; ++k) {
      const Pass& p = passes[k];
      const Real* at = d + p.lane;
      const T value =
          T(at[0]) + p.a * (T(at[kLanes]) +
                            p.b * (T(at[2 * kLanes]) + p.a * (T(at[3 * kLanes]) + p.b * T(at[4 * kLanes]))));
      Real* to = p.to + place;
      if (p.offset == 0) {
        Traits::store(value, to);
      } else {
        Traits::store(select(p.later, value, Traits::load(to)), to);
        Traits::store(select(p.later, Traits::load(to + values), value), to + values);
      }
    }
  }
}

/// Broadcasts one lane's constants to every lane of the recording set.
template <class T>
void BatchKernel<T>::broadcast_constants(int lane) {
  const auto copy = [lane](const std::vector<T>& from, std::vector<T>& to, std::size_t first,
                           std::size_t count) {
    if (count == 0) return;  // data() of an empty vector may be null
    const Real* __restrict source = reinterpret_cast<const Real*>(from.data()) + lane;
    T* __restrict target = reinterpret_cast<T*>(to.data());
    for (std::size_t i = first; i < first + count; ++i) target[i] = T(source[i * kLanes]);
  };
  const Constants& from = per_lane_;
  Constants& to = per_sample_;
  for (const auto& [first, count] : broadcast_) copy(from.c, to.c, first, count);
  const auto n = static_cast<std::size_t>(n_);
  for (const auto& [source, target] : {std::pair{&from.efd, &to.efd},
                                       {&from.tm, &to.tm},
                                       {&from.dvref, &to.dvref},
                                       {&from.dpref, &to.dpref},
                                       {&from.on, &to.on}})
    copy(*source, *target, 0, n);
  copy(from.far_g, to.far_g, 0, to.far_g.size());
  copy(from.far_b, to.far_b, 0, to.far_b.size());
  copy(from.vr, to.vr, 0, to.vr.size());
  copy(from.vi, to.vi, 0, to.vi.size());
  to.last_moment = T(Traits::get(from.last_moment, lane));
  to.factored = 0;
  if (shares_) return;  // rows of the lane's own matrix are kept in recorded_rows_
  const auto row = [&](int source) {
    const auto length = static_cast<std::size_t>(sources_);
    copy(from.g, to.g, static_cast<std::size_t>(source) * length, length);
    copy(from.b, to.b, static_cast<std::size_t>(source) * length, length);
  };
  for (int plant : recorded_) row(plant);
  for (int source : nonlinear_) row(source);
}

/// Returns the states of the pack of buffered samples that starts at `first`, in the buffer or copied to
/// `buffer`.
template <class T>
const T* BatchKernel<T>::waiting_pack(const BatchRun& run, int first, const std::vector<int>& states,
                                      T* buffer) const {
  const std::size_t values = y_.size() * kLanes;
  const int offset = first % kLanes;
  const Real* from = waiting(run) + static_cast<std::size_t>(first / kLanes) * values;
  if (offset == 0) return reinterpret_cast<const T*>(from);
  Real* to = reinterpret_cast<Real*>(buffer);
  for (const int state : states) {
    const std::size_t place = static_cast<std::size_t>(state) * kLanes;
    for (int l = 0; l < kLanes; ++l) {
      const int at = l + offset;
      to[place + l] = at < kLanes ? from[place + at] : from[place + values + at - kLanes];
    }
  }
  return buffer;
}

/// Evaluates the first `count` buffered samples of a lane into its record and removes them from the buffer.
template <class T>
void BatchKernel<T>::evaluate_pending(int lane, int count) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  if (count == 0) return;
  broadcast_constants(lane);
  for (int first = 0, now = 0; first < count; first += now) {
    const T* x = waiting_pack(run, first, wanted_, kept_.data());
    now = std::min(kLanes - run.recorded % kLanes, count - first);  // aligns whole packs to cache lines
    if (timed_) {
      alignas(64) double at[kLanes];
      for (int l = 0; l < kLanes; ++l) at[l] = (run.recorded + l) / options_.rate;
      signals_.t = minimum(Traits::load(at), per_sample_.last_moment);
    }
    emfs(per_sample_, x);
    if (records_whole(lane))
      shared_.solve_of(lane, er_.data(), ei_.data(), ir_.data(), ii_.data());
    else if (shares_)
      recorded_rows_[static_cast<std::size_t>(lane)].times(er_.data(), ei_.data(), ir_.data(), ii_.data());
    for (std::size_t k = 0; k < recorded_.size(); ++k) outputs(k, x, run, now);
    run.recorded += now;
  }
  drop_waiting(run, count);
}

/// Removes the first `count` samples from the buffer.
template <class T>
void BatchKernel<T>::drop_waiting(BatchRun& run, int count) {
  run.pending -= count;
  for (int moved = 0; moved < run.pending; moved += kLanes) {
    const T* from = waiting_pack(run, count + moved, sampled_, kept_.data());
    T* to = reinterpret_cast<T*>(waiting(run) + static_cast<std::size_t>(moved) * y_.size());
    for (const int state : sampled_) to[state] = from[state];
  }
}

/// Evaluates the channels of the k-th recorded plant for `count` samples, starting at run.recorded.
template <class T>
void BatchKernel<T>::outputs(std::size_t k, const T* x, BatchRun& run, int count) {
  const auto i = static_cast<std::size_t>(recorded_[k]);
  const auto lane = static_cast<std::size_t>(&run - lanes_.data());
  const PlantSlice& p = plants_[i];
  Signals<T>& s = signals_;
  if (shares_)
    shared_current(records_whole(static_cast<int>(lane)) ? i : k, per_sample_, i, s);
  else
    current(per_sample_, i, s);
  const T* c = &per_sample_.c[static_cast<std::size_t>(p.c)];
  p.equations.voltages(c, er_[i], ei_[i], s);
  if (far_count_ > 0) look_far(per_sample_, p.far, s);
  p.equations.signals(c, x + p.x, &m_[static_cast<std::size_t>(p.m)], s, unused_.data() + p.x);
  T power, reactive, vr, vi;
  p.equations.grid_power(c, s, power, reactive);
  if (const double part = connected_[lane][i]; part < 1.0) {  // partial trip; a tripped plant has no current
    power = power * T(part);
    reactive = reactive * T(part);
  }
  p.equations.grid_voltage(s, vr, vi);
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    T v(0.0);
    switch (channels_[j]) {
      case Channel::delta:
        v = p.rotor ? x[p.x] : T(0.0);
        break;
      case Channel::speed:
        v = s.speed;
        break;
      case Channel::P:
        v = power;
        break;
      case Channel::Q:
        v = reactive;
        break;
      case Channel::V:
        v = p.equations.grid_magnitude(s, vr, vi);
        break;
      case Channel::Efd:
        v = s.Efd;
        break;
      case Channel::Ifd:
        v = s.Ifd;
        break;
      case Channel::Tm:
        v = s.Tm;
        break;
      case Channel::theta: {
        if (grounded_[lane][i]) {
          v = T(run.theta[k]);
          break;
        }
        using std::atan2;
        const T two_pi(constants::turn);
        const T angle = atan2(vi, vr);
        if (!p.rotor) {
          const bool tripped = connected_[lane][i] == 0.0;
          v = unwrapped(angle, tripped ? T(1.0) : vr * vr + vi * vi, run.theta[k], count);
          run.theta[k] = Traits::get(v, count - 1);
          break;
        }
        v = angle + two_pi * round_nearest((x[p.x] - angle) / two_pi);  // nearest to the rotor angle
        run.theta[k] = Traits::get(v, count - 1);
        break;
      }
    }
    double* to = run.record.at(static_cast<int>(k), static_cast<int>(j)) + run.recorded;
    if (count == kLanes)
      Traits::stream(v, to);
    else
      for (int l = 0; l < count; ++l) to[l] = Traits::get(v, l);
  }
}

/// Unwraps the first `count` samples of an angle [rad]: adds the turns that minimise the step from sample to
/// sample, beginning with the step from `last`. `squared`: |V|^2 [pu^2]; at zero voltage the angle keeps its
/// last value.
template <class T>
T BatchKernel<T>::unwrapped(T angle, const T& squared, double last, int count) const {
  constexpr double kNoAngle = 1e-9;  // [pu]; a smaller |V| is the rounding error at a bolted fault
  T turns(0.0);                      // [rad], added at the end
  for (int l = 0; l < count; ++l) {
    if (Traits::get(squared, l) < kNoAngle * kNoAngle) Traits::set(angle, l, last);
    const double now = Traits::get(angle, l);
    const double whole = constants::turn * std::nearbyint((last - now) / constants::turn);
    Traits::set(turns, l, whole);
    last = now + whole;
  }
  return angle + turns;
}

/// Repeats the last sample until the record has `until` samples.
template <class T>
void BatchKernel<T>::repeat_last(BatchRun& run, int until) const {
  if (run.recorded == 0 || run.recorded >= until) return;
  for (std::size_t k = 0; k < recorded_.size(); ++k)
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      double* v = run.record.at(static_cast<int>(k), static_cast<int>(j));
      const double last = v[run.recorded - 1];
      int i = run.recorded;
      for (; i < until && i % kLanes != 0; ++i) v[i] = last;
      for (; i + kLanes <= until; i += kLanes) Traits::stream(T(last), v + i);
      for (; i < until; ++i) v[i] = last;
    }
  run.recorded = until;
}

}  // namespace swingbank::sim::batch
