#pragma once
// Lanes: construction, loading a job into a lane, switching, finishing.
#include <algorithm>

#include "sim/solve/lanes.hpp"

namespace swingbank::sim {

template <class T>
Lanes<T>::Lanes(const Grid& grid, const BatchOptions& options)
    : grid_(grid), options_(options), network_(grid) {
  n_ = static_cast<int>(grid.plants.size());
  sources_ = network_.sources();
  samples_ = static_cast<int>(std::floor(options.t_end * options.rate + 1e-9)) + 1;
  recorded_ = options.plants;
  if (recorded_.empty())
    for (int i = 0; i < n_; ++i) recorded_.push_back(i);
  channels_ = options.channels;
  if (channels_.empty())
    for (const auto& c : kChannels) channels_.push_back(c.channel);
  build_slices();
  reserve();
  // Idle lanes carry the grid's own operating point, so that their arithmetic stays finite.
  for (int l = 0; l < kLanes; ++l) {
    lanes_[static_cast<std::size_t>(l)].segments = {{0.0, {}, {}}};
    load(l);
    enter_segment(l);
  }
}

/// Where each source's states, coefficients and scratch lie, and its operating point.
template <class T>
void Lanes<T>::build_slices() {
  int c = 0, m = 0;
  const auto weigh = [&](const Effect& effect) {
    for (const auto& state : effect.states) weight_.push_back(state.weight / options_.tolerance);
  };
  for (std::size_t i = 0; i < grid_.plants.size(); ++i) {
    const Plant& plant = grid_.plants[i];
    plants_.push_back({PlantEquations<T>(plant), states_, c, m});
    const auto& equations = plants_.back().equations;
    states_ += equations.states();
    c += equations.coefficients();
    m += equations.scratch();
    base_.push_back(operating_point(plant, grid_.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                    grid_.network.base_mva, grid_.conventions));
    weigh(*plant.machine.effect);
    for (const auto& block : plant.controls) weigh(*block.effect);
    if (equations.nonlinear()) nonlinear_.push_back(static_cast<int>(i));
    limited_ = limited_ || equations.limited();
    timed_ = timed_ || !plant.controls.empty();
  }
  for (const Consumer& load : grid_.loads) {
    nonlinear_.push_back(n_ + static_cast<int>(loads_.size()));
    loads_.push_back({LoadEquations<T>(load), states_, c});
    states_ += loads_.back().equations.states();
    c += loads_.back().equations.coefficients();
    load_base_.push_back(load_operating_point(load, load.block.p,
                                              grid_.flow.voltage[static_cast<std::size_t>(load.bus)],
                                              grid_.network.base_mva, grid_.conventions));
    weigh(*load.block.effect);
  }
  for (Constants* k : {&per_lane_, &per_sample_}) k->c.assign(static_cast<std::size_t>(c), T(0.0));
  m_.assign(static_cast<std::size_t>(m), T(0.0));
}

template <class T>
void Lanes<T>::reserve() {
  const auto n = static_cast<std::size_t>(n_), sources = static_cast<std::size_t>(sources_),
             states = static_cast<std::size_t>(states_), free = 2 * nonlinear_.size();
  for (Constants* k : {&per_lane_, &per_sample_}) {
    for (auto* v : {&k->g, &k->b}) v->assign(sources * sources, T(0.0));
    for (auto* v : {&k->efd, &k->tm, &k->dvref, &k->dpref}) v->assign(n, T(0.0));
    k->on.assign(n, T(1.0));
    for (auto* v : {&k->vr, &k->vi}) v->assign(nonlinear_.size(), T(0.0));
    k->last_moment = T(0.0);
  }
  algebra_.assign(free + 2 * free + free * free, T(0.0));
  for (auto* v : {&er_, &ei_}) v->assign(sources, T(0.0));
  for (auto* v : {&y_, &trial_, &kept_, &unused_}) v->assign(states, T(0.0));
  dense_.assign(4 * states, T(0.0));
  for (auto& k : k_) k.assign(states, T(0.0));
  lanes_.resize(kLanes);
  for (auto* v : {&lane_r_, &lane_x_}) v->assign(kLanes, std::vector<double>(sources));
  grounded_.resize(kLanes);
}

template <class T>
void Lanes<T>::load_plant(int lane, std::size_t plant, const Operating& at) {
  const PlantSlice& p = plants_[plant];
  for (std::size_t i = 0; i < at.c.size(); ++i)
    Traits::set(per_lane_.c[static_cast<std::size_t>(p.c) + i], lane, at.c[i]);
  for (std::size_t i = 0; i < at.x.size(); ++i)
    Traits::set(y_[static_cast<std::size_t>(p.x) + i], lane, at.x[i]);
  Traits::set(per_lane_.efd[plant], lane, at.Efd);
  Traits::set(per_lane_.tm[plant], lane, at.Tm);
  const double* z = at.c.data() + grid_.plants[plant].machine.effect->coefficients + joint_r;
  lane_r_[static_cast<std::size_t>(lane)][plant] = z[0];
  lane_x_[static_cast<std::size_t>(lane)][plant] = z[1];
}

template <class T>
void Lanes<T>::load_consumer(int lane, std::size_t load) {
  const LoadSlice& l = loads_[load];
  const Operating& at = load_base_[load];
  for (std::size_t i = 0; i < at.c.size(); ++i)
    Traits::set(per_lane_.c[static_cast<std::size_t>(l.c) + i], lane, at.c[i]);
  for (std::size_t i = 0; i < at.x.size(); ++i)
    Traits::set(y_[static_cast<std::size_t>(l.x) + i], lane, at.x[i]);
  const double* z = at.c.data() + grid_.loads[load].block.effect->coefficients;
  const std::size_t source = plants_.size() + load;
  lane_r_[static_cast<std::size_t>(lane)][source] = z[load_r];
  lane_x_[static_cast<std::size_t>(lane)][source] = z[load_x];
}

/// Brings every source of the lane to its operating point, with the job's parameters where it has any.
template <class T>
void Lanes<T>::load(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  for (std::size_t i = 0; i < plants_.size(); ++i) load_plant(lane, i, base_[i]);
  for (std::size_t i = 0; i < loads_.size(); ++i) load_consumer(lane, i);
  for (const auto& [plant, changed] : changed_plants(grid_, run.job))
    load_plant(lane, static_cast<std::size_t>(plant),
               operating_point(changed, grid_.flow.voltage[static_cast<std::size_t>(changed.bus)],
                               grid_.network.base_mva, grid_.conventions));
  for (std::size_t i = 0; i < nonlinear_.size(); ++i) {
    const int source = nonlinear_[i];
    const int bus = source < n_ ? grid_.plants[static_cast<std::size_t>(source)].bus
                                : grid_.loads[static_cast<std::size_t>(source - n_)].bus;
    const Complex v = grid_.flow.voltage[static_cast<std::size_t>(bus)];
    Traits::set(per_lane_.vr[i], lane, v.real());
    Traits::set(per_lane_.vi[i], lane, v.imag());
  }
  run.segment = 0;
  run.clock.t = 0.0;
}

/// Puts the matrices of the lane's current segment into place and starts the step control anew.
template <class T>
void Lanes<T>::enter_segment(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  const auto l = static_cast<std::size_t>(lane);
  const Segment& segment = run.segments[run.segment];
  const InternalMatrix& matrix = network_.matrix(segment.topology, lane_r_[l], lane_x_[l]);
  for (std::size_t i = 0; i < matrix.g.size(); ++i) {
    Traits::set(per_lane_.g[i], lane, matrix.g[i]);
    Traits::set(per_lane_.b[i], lane, matrix.b[i]);
  }
  grounded_[l] = matrix.grounded;
  tripped_ &= ~(1U << lane);
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    Traits::set(per_lane_.on[i], lane, matrix.tripped[i] ? 0.0 : 1.0);
    if (matrix.tripped[i]) tripped_ |= 1U << lane;
    double dvref = 0.0, dpref = 0.0;
    for (const Setpoint& move : segment.setpoints)
      if (move.generator == grid_.plants[i].generator) dvref = move.dVref, dpref = move.dPref;
    Traits::set(per_lane_.dvref[i], lane, dvref);
    Traits::set(per_lane_.dpref[i], lane, dpref);
  }
  const bool last = run.segment + 1 >= run.segments.size();
  const double end = last ? options_.t_end : run.segments[run.segment + 1].start;
  Traits::set(per_lane_.last_moment, lane,
              last ? std::numeric_limits<double>::max() : end - kBeforeSwitching);
  run.clock.restart(std::min(end, options_.t_end));
  fresh_ |= 1U << lane;
}

/// Until the first switching the grid stands still (operating_point checks the derivatives): the samples up
/// to there are the operating point itself.
template <class T>
void Lanes<T>::record_steady_start(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  if (!(run.segments[0].topology == Topology{}) || !run.segments[0].setpoints.empty()) return;
  if (!run.jumps.empty() && run.jumps.front() <= 0.0) return;
  const bool switches = run.segments.size() > 1 && run.segments[1].start < options_.t_end;
  const double first = switches ? run.segments[1].start : options_.t_end;
  const int count = samples_until(first);
  for (std::size_t i = 0; i < y_.size(); ++i) run.waiting[i * kRoom] = Traits::get(y_[i], lane);
  run.pending = 1;
  evaluate_pending(lane, 1);
  hold(run, count);
  run.clock.t = first;
  if (switches) {
    run.segment = 1;
    enter_segment(lane);
  }
}

/// How many samples lie at or before t.
template <class T>
int Lanes<T>::samples_until(double t) const {
  int count = static_cast<int>(t * options_.rate) + 1;
  while (count > 0 && (count - 1) / options_.rate > t) --count;
  while (count / options_.rate <= t) ++count;
  return count < samples_ ? count : samples_;
}

/// Starts the next job in this lane; one that ends at once (nothing ever switches) is handed over right away.
template <class T>
void Lanes<T>::refill(int lane, const Next& next, const Done& done) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  for (;;) {
    run.job = {};
    if (!next(run.job)) break;
    const auto changed = changed_plants(grid_, run.job);
    run.jumps.clear();
    for (std::size_t i = 0; i < plants_.size(); ++i) {
      const auto other = changed.find(static_cast<int>(i));
      const auto more = instants_of(other == changed.end() ? grid_.plants[i] : other->second);
      run.jumps.insert(run.jumps.end(), more.begin(), more.end());
    }
    std::ranges::sort(run.jumps);
    run.segments = segments(run.job.event, grid_.network, run.jumps);
    begin_record(run);
    load(lane);
    enter_segment(lane);
    record_steady_start(lane);
    if (run.clock.t < options_.t_end) {
      active_ |= 1U << lane;
      return;
    }
    hand_over(lane, Outcome::stable, done);
  }
  // Nothing left: the lane idles at the grid's own operating point.
  active_ &= ~(1U << lane);
  run.job = {};
  run.segments = {{0.0, {}, {}}};
  load(lane);
  enter_segment(lane);
  run.clock.next = std::numeric_limits<double>::infinity();
}

template <class T>
void Lanes<T>::begin_record(LaneRun& run) const {
  auto& record = run.record;
  record.rate = options_.rate;
  record.samples = samples_;
  record.plants = recorded_;
  record.channels = channels_;
  record.allocate(true);
  record.outcome = Outcome::stable;
  record.largest_spread = 0.0;
  run.recorded = run.pending = 0;
  run.waiting.resize(y_.size() * kRoom);
  run.theta.assign(recorded_.size(), 0.0);
}

/// A run that ended early keeps its last sample to the end.
template <class T>
void Lanes<T>::hand_over(int lane, Outcome outcome, const Done& done) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  run.record.outcome = outcome;
  run.record.stopped_at = run.clock.t;
  evaluate_pending(lane, run.pending);
  hold(run, samples_);
  done(run.job, run.record);
}

}  // namespace swingbank::sim
