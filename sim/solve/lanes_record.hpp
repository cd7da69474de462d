#pragma once
// Lanes: recording. The states at the sample instants are interpolated lane by lane and wait there; when a
// pack of them has gathered, the outputs are evaluated with the pack's lanes as consecutive samples of one
// event. That fills every lane, whatever the steps of the others, and writes each channel as whole cache
// lines.
#include <algorithm>

#include "sim/solve/lanes.hpp"

namespace swingbank::sim {

/// Coefficients of y(theta) = y0 + theta (d0 + (1 - theta)(d1 + theta (d2 + (1 - theta) d3))).
template <class T>
void Lanes<T>::prepare_dense(const T& h) {
  const std::size_t n = y_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const T delta = trial_[i] - y_[i];
    const T slope = h * k_[0][i] - delta;
    T d = T(dp54::dense[0]) * k_[0][i];
    for (int j = 2; j < dp54::kStages; ++j) d = d + T(dp54::dense[j]) * k_[j][i];
    dense_[i] = delta;
    dense_[n + i] = slope;
    dense_[2 * n + i] = delta - h * k_[6][i] - slope;
    dense_[3 * n + i] = h * d;
  }
}

/// Records the samples in (start, start + tried] of every accepted lane.
template <class T>
void Lanes<T>::record_step(const T& h, unsigned accepted, const double* start, const double* tried) {
  bool prepared = false;
  for (int l = 0; l < kLanes; ++l) {
    if (!((accepted >> l) & 1U)) continue;
    const auto& run = lanes_[static_cast<std::size_t>(l)];
    const int count = samples_until(run.clock.t) - run.recorded - run.pending;
    if (count <= 0) continue;
    if (!prepared) prepare_dense(h);
    prepared = true;
    collect(l, count, start[l], tried[l]);
  }
}

/// Interpolates the lane's next `count` samples and evaluates them whenever the waiting room is full.
template <class T>
void Lanes<T>::collect(int lane, int count, double start, double tried) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  const std::size_t n = y_.size() * kFlats;
  const double inverse = 1.0 / tried, spacing = 1.0 / options_.rate;
  while (count > 0) {
    const int now = std::min(count, kLanes);
    const int first = run.recorded + run.pending;
    alignas(64) double theta[kLanes];
    for (int s = 0; s < kLanes; ++s) theta[s] = std::min(1.0, ((first + s) * spacing - start) * inverse);
    const Flat a = LaneTraits<Flat>::load(theta), b = Flat(1.0) - a;
    const double* __restrict y = reinterpret_cast<const double*>(y_.data()) + lane;
    const double* __restrict d = reinterpret_cast<const double*>(dense_.data()) + lane;
    double* __restrict to = run.waiting.data() + run.pending;
    // dense_ holds four rows of T per state, each T a row of flats: [coefficient][state][flat]
    for (std::size_t i = 0; i < n; ++i) {
      const Flat value = Flat(y[i * kLanes]) +
                         a * (Flat(d[i * kLanes]) +
                              b * (Flat(d[(n + i) * kLanes]) +
                                   a * (Flat(d[(2 * n + i) * kLanes]) + b * Flat(d[(3 * n + i) * kLanes]))));
      LaneTraits<Flat>::store(value, to + i * kRoom);
    }
    run.pending += now;
    count -= now;
    if (run.pending >= kWaiting) evaluate_pending(lane, kWaiting - (run.recorded + kWaiting) % kLanes);
  }
}

/// Copies one lane's constants into every lane of the recording set.
template <class T>
void Lanes<T>::spread_constants(int lane) {
  const auto copy = [lane](const std::vector<T>& from, std::vector<T>& to, std::size_t first,
                           std::size_t count) {
    const double* __restrict source = reinterpret_cast<const double*>(from.data()) + lane;
    Flat* __restrict target = reinterpret_cast<Flat*>(to.data());
    for (std::size_t i = first * kFlats; i < (first + count) * kFlats; ++i)
      target[i] = Flat(source[i * kLanes]);
  };
  const Constants& from = per_lane_;
  Constants& to = per_sample_;
  copy(from.c, to.c, 0, to.c.size());
  const auto n = static_cast<std::size_t>(n_);
  for (const auto& [source, target] : {std::pair{&from.efd, &to.efd},
                                       {&from.tm, &to.tm},
                                       {&from.dvref, &to.dvref},
                                       {&from.dpref, &to.dpref}})
    copy(*source, *target, 0, n);
  copy(from.vr, to.vr, 0, to.vr.size());
  copy(from.vi, to.vi, 0, to.vi.size());
  to.last_moment = T(Traits::get(from.last_moment, lane));
  const auto row = [&](int source) {
    const auto length = static_cast<std::size_t>(sources_);
    copy(from.g, to.g, static_cast<std::size_t>(source) * length, length);
    copy(from.b, to.b, static_cast<std::size_t>(source) * length, length);
  };
  for (int plant : recorded_) row(plant);
  for (int source : nonlinear_) row(source);
}

/// Evaluates the first `count` waiting samples of a lane into its record; the rest (less than two packs) move
/// to the front.
template <class T>
void Lanes<T>::evaluate_pending(int lane, int count) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  if (count == 0) return;
  spread_constants(lane);
  const std::size_t n = y_.size() * kFlats;
  Flat* const kept = reinterpret_cast<Flat*>(kept_.data());
  for (int first = 0, now = 0; first < count; first += now) {
    for (std::size_t i = 0; i < n; ++i)
      kept[i] = LaneTraits<Flat>::load(run.waiting.data() + i * kRoom + first);
    now = std::min(kLanes - run.recorded % kLanes, count - first);  // whole packs start on a cache line
    if (timed_) {
      alignas(64) double at[kLanes];
      for (int l = 0; l < kLanes; ++l) at[l] = (run.recorded + l) / options_.rate;
      signals_.t = minimum(Traits::constant(LaneTraits<Flat>::load(at)), per_sample_.last_moment);
    }
    emfs(per_sample_, kept_.data());
    for (std::size_t k = 0; k < recorded_.size(); ++k) outputs(k, kept_.data(), run, now);
    run.recorded += now;
  }
  run.pending -= count;
  if (run.pending > 0)
    for (std::size_t i = 0; i < n; ++i) {
      double* row = run.waiting.data() + i * kRoom;
      using Of = LaneTraits<Flat>;
      Of::store(Of::load(row + count), row);
      Of::store(Of::load(row + count + kLanes), row + kLanes);
    }
}

/// The channels of the k-th recorded plant, `count` samples from run.recorded on.
template <class T>
void Lanes<T>::outputs(std::size_t k, const T* x, LaneRun& run, int count) {
  const auto i = static_cast<std::size_t>(recorded_[k]);
  const auto lane = static_cast<std::size_t>(&run - lanes_.data());
  const PlantSlice& p = plants_[i];
  Signals<T>& s = signals_;
  current(per_sample_, i, s);
  const T* c = &per_sample_.c[static_cast<std::size_t>(p.c)];
  p.equations.voltages(c, er_[i], ei_[i], s);
  p.equations.signals(c, x + p.x, &m_[static_cast<std::size_t>(p.m)], s, unused_.data() + p.x);
  T power, reactive, vr, vi;
  p.equations.grid_power(c, s, power, reactive);
  if (const double part = connected_[lane][i]; part < 1.0) {  // of a unit; a tripped one has no current
    power = power * T(part);
    reactive = reactive * T(part);
  }
  p.equations.grid_voltage(s, vr, vi);
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    T v(0.0);
    switch (channels_[j]) {
      case Channel::delta:
        v = x[p.x];
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
        const T two_pi(6.28318530717958647692);
        const T angle = atan2(vi, vr);
        v = angle + two_pi * round_nearest((x[p.x] - angle) / two_pi);  // the turn in which the rotor is
        run.theta[k] = Traits::get(v, count - 1);
        break;
      }
    }
    const auto put = [&](const Flat& flat, double* row) {
      double* to = row + run.recorded;
      if (count == kLanes) return LaneTraits<Flat>::stream(flat, to);
      for (int l = 0; l < count; ++l) to[l] = LaneTraits<Flat>::get(flat, l);
    };
    const int plant = static_cast<int>(k), channel = static_cast<int>(j);
    put(Traits::value(v), run.record.at(plant, channel));
    if constexpr (Traits::directions > 0)
      for (int d = 0; d < Traits::directions; ++d)
        put(v.d[static_cast<std::size_t>(d)], run.record.slope(d, plant, channel));
  }
}

/// Repeats the last sample until `until` samples are recorded.
template <class T>
void Lanes<T>::hold(LaneRun& run, int until) const {
  if (run.recorded == 0 || run.recorded >= until) return;
  for (std::size_t k = 0; k < recorded_.size(); ++k)
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      const auto repeat = [&](double* v) { std::fill(v + run.recorded, v + until, v[run.recorded - 1]); };
      repeat(run.record.at(static_cast<int>(k), static_cast<int>(j)));
      for (int d = 0; d < Traits::directions; ++d)
        repeat(run.record.slope(d, static_cast<int>(k), static_cast<int>(j)));
    }
  run.recorded = until;
}

}  // namespace swingbank::sim
