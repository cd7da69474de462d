#pragma once
// Batch kernel: construction, loading of jobs, entry of segments, completion of runs.
#include <fmt/format.h>

#include <algorithm>

#include "sim/batch/detail/batch_kernel.hpp"
#include "sim/network/connectivity.hpp"

namespace swingbank::sim::batch {

template <class T>
BatchKernel<T>::BatchKernel(const grid::Grid& grid, const BatchOptions& options)
    : grid_(grid), options_(options), own_(std::make_shared<OperatingState>(grid)) {
  n_ = static_cast<int>(grid.plants.size());
  sources_ = own_->network.sources();
  samples_ = static_cast<int>(std::floor(options.t_end * options.rate + 1e-9)) + 1;
  recorded_ = options.plants;
  if (recorded_.empty())
    for (int i = 0; i < n_; ++i) recorded_.push_back(i);
  channels_ = options.channels;
  if (channels_.empty())
    for (const auto& c : kChannels) channels_.push_back(c.channel);
  build_slices();
  share();
  reserve();
  // Idle lanes hold the grid's own operating point, so that their arithmetic stays finite.
  for (int l = 0; l < kLanes; ++l) {
    lanes_[static_cast<std::size_t>(l)].segments = {{0.0, {}, {}}};
    load(l);
    enter_segment(l);
  }
}

/// Assigns the offsets of each source's states, coefficients and scratch.
template <class T>
void BatchKernel<T>::build_slices() {
  int c = 0, m = 0;
  const std::vector<FarRows> far = far_rows(grid_, far_count_);
  const auto add_states = [&](const Effect& effect, int coefficient, bool needed) {
    for (const State& state : effect.states) {
      const auto at = [&](int mover) { return mover < 0 ? -1 : coefficient + mover; };
      const auto [first, second] = state.moved_by;
      if (first >= 0) resting_.push_back({static_cast<int>(weight_.size()), at(first), at(second)});
      if (state.low >= 0 || state.high >= 0) stopped_.push_back(static_cast<int>(weight_.size()));
      if (state.bends) kinked_.push_back(static_cast<int>(weight_.size()));
      if (state.weighed_by >= 0) weighed_.push_back({static_cast<int>(weight_.size()), at(state.weighed_by)});
      weight_.push_back(state.weight / options_.tolerance);
      needed_.push_back(needed);
    }
  };
  const auto add_broadcast = [&](int first, int count) {
    broadcast_.push_back({static_cast<std::size_t>(first), static_cast<std::size_t>(count)});
  };
  for (std::size_t i = 0; i < grid_.plants.size(); ++i) {
    const plant::Plant& plant = grid_.plants[i];
    plants_.push_back({plant::PlantEquations<T>(plant), states_, c, m});
    plants_.back().far = far[i];
    plants_.back().rotor = !plant.machine.effect->converter;
    const auto& equations = plants_.back().equations;
    states_ += equations.states();
    c += equations.coefficients();
    m += equations.scratch();
    const bool recorded = std::ranges::find(recorded_, static_cast<int>(i)) != recorded_.end();
    add_states(*plant.machine.effect, plants_.back().c, true);
    add_broadcast(plants_.back().c,
                  recorded ? equations.coefficients() : plant.machine.effect->coefficients + plant::kJoint);
    int coefficient = plants_.back().c + plant.machine.effect->coefficients + plant::kJoint;
    const auto has = [&](Slot slot) {
      return std::ranges::any_of(plant.controls,
                                 [&](const plant::Block& b) { return b.effect->slot == slot; });
    };
    for (const auto& block : plant.controls) {
      if (block.effect->slot == Slot::exciter && has(Slot::stabiliser)) {
        plants_.back().watch = static_cast<int>(watched_.size());
        watched_.push_back({static_cast<int>(weight_.size()), static_cast<int>(block.effect->states.size())});
      }
      add_states(*block.effect, coefficient, recorded);
      coefficient += block.effect->coefficients;
    }
    if (equations.nonlinear()) nonlinear_.push_back(static_cast<int>(i));
    limited_ = limited_ || equations.limited();
    timed_ = timed_ || !plant.controls.empty();
  }
  for (const plant::Consumer& load : grid_.loads) {
    nonlinear_.push_back(n_ + static_cast<int>(loads_.size()));
    loads_.push_back({plant::LoadEquations<T>(load), states_, c});
    states_ += loads_.back().equations.states();
    c += loads_.back().equations.coefficients();
    add_states(*load.block.effect, loads_.back().c, true);
    add_broadcast(loads_.back().c, loads_.back().equations.coefficients());
  }
  for (Constants* k : {&per_lane_, &per_sample_}) k->c.assign(static_cast<std::size_t>(c), T(0.0));
  m_.assign(static_cast<std::size_t>(m), T(0.0));
}

template <class T>
void BatchKernel<T>::reserve() {
  const auto n = static_cast<std::size_t>(n_), sources = static_cast<std::size_t>(sources_),
             states = static_cast<std::size_t>(states_), free = 2 * nonlinear_.size();
  for (Constants* k : {&per_lane_, &per_sample_}) {
    for (auto* v : {&k->g, &k->b}) v->assign(shares_ ? 0 : sources * sources, T(0.0));
    for (auto* v : {&k->far_g, &k->far_b}) v->assign(static_cast<std::size_t>(far_count_) * sources, T(0.0));
    for (auto* v : {&k->efd, &k->tm, &k->dvref, &k->dpref}) v->assign(n, T(0.0));
    k->on.assign(n, T(1.0));
    for (auto* v : {&k->vr, &k->vi}) v->assign(nonlinear_.size(), T(0.0));
    k->factors.assign(free * free, T(0.0));
    k->last_moment = T(0.0);
  }
  algebra_.assign(free + 3 * free + free * free, T(0.0));
  steady_.assign(free, T(0.0));
  for (auto* v : {&er_, &ei_}) v->assign(sources, T(0.0));
  for (auto* v : {&y_, &trial_, &kept_, &unused_}) v->assign(states, T(0.0));
  if constexpr (kCarries)
    for (auto* v : {&carry_, &move_}) v->assign(states, T(0.0));
  rest_.assign(n, T(0.0));
  islands_ = std::ranges::max(network::islands(grid_.network)) + 1;
  for (auto& k : k_) k.assign(states, T(0.0));
  for (int i = 0; i < states_; ++i)
    if (needed_[static_cast<std::size_t>(i)]) wanted_.push_back(i);
  lanes_.resize(kLanes);
  state_.assign(kLanes, own_);
  for (auto* v : {&lane_r_, &lane_x_}) v->assign(kLanes, std::vector<double>(sources));
  grounded_.resize(kLanes);
  connected_.resize(kLanes);
}

template <class T>
void BatchKernel<T>::set_source(int lane, const plant::Operating& at, int c, int x, const double* z,
                                std::size_t source) {
  for (std::size_t i = 0; i < at.c.size(); ++i)
    Traits::set(per_lane_.c[static_cast<std::size_t>(c) + i], lane, at.c[i]);
  for (std::size_t i = 0; i < at.x.size(); ++i)
    Traits::set(y_[static_cast<std::size_t>(x) + i], lane, at.x[i]);
  lane_r_[static_cast<std::size_t>(lane)][source] = z[0];
  lane_x_[static_cast<std::size_t>(lane)][source] = z[1];
}

template <class T>
void BatchKernel<T>::load_plant(int lane, std::size_t plant, const plant::Operating& at) {
  const PlantSlice& p = plants_[plant];
  set_source(lane, at, p.c, p.x,
             at.c.data() + grid_.plants[plant].machine.effect->coefficients + plant::joint_r, plant);
  if (p.rotor) Traits::set(rest_[plant], lane, at.x[0]);
  Traits::set(per_lane_.efd[plant], lane, at.Efd);
  Traits::set(per_lane_.tm[plant], lane, at.Tm);
}

template <class T>
void BatchKernel<T>::load_consumer(int lane, std::size_t load) {
  const LoadSlice& l = loads_[load];
  const plant::Operating& at = state_[static_cast<std::size_t>(lane)]->loads[load];
  set_source(lane, at, l.c, l.x, at.c.data() + grid_.loads[load].block.effect->coefficients + plant::load_r,
             plants_.size() + load);
}

/// Selects the operating point of a lane's job. An existing OperatingState is reused if possible, because
/// consecutive jobs mostly have the same operating point.
template <class T>
void BatchKernel<T>::choose_state(int lane) {
  const auto& wanted = lanes_[static_cast<std::size_t>(lane)].job.grid;
  auto& state = state_[static_cast<std::size_t>(lane)];
  if (!wanted) {
    state = own_;
    return;
  }
  const auto same = [&](const auto& other) { return &other->grid == wanted.get(); };
  const auto found = std::ranges::find_if(state_, same);
  state = found != state_.end() ? *found : std::make_shared<OperatingState>(wanted);
}

/// Initialises every source of the lane at its operating point, with the job's parameters.
template <class T>
void BatchKernel<T>::load(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  choose_state(lane);
  const OperatingState& state = *state_[static_cast<std::size_t>(lane)];
  for (std::size_t i = 0; i < plants_.size(); ++i) load_plant(lane, i, state.plants[i]);
  for (std::size_t i = 0; i < loads_.size(); ++i) load_consumer(lane, i);
  const auto changed = changed_plants(grid_, run.job);
  for (const auto& [index, plant] : changed)
    load_plant(lane, static_cast<std::size_t>(index), state.bring(plant));
  for (std::size_t i = 0; i < nonlinear_.size(); ++i) {
    const auto source = static_cast<std::size_t>(nonlinear_[i]);
    const auto& at = source < plants_.size() ? state.plants[source] : state.loads[source - plants_.size()];
    Traits::set(per_lane_.vr[i], lane, at.s.Vr);
    Traits::set(per_lane_.vi[i], lane, at.s.Vi);
  }
  if constexpr (kCarries)
    for (T& carried : carry_) Traits::set(carried, lane, 0.0);
  find_moving();
  find_weights();
  run.segment = 0;
  run.clock.t = 0.0;
}

/// Finds the states that move in some lane. All other states are constant in every step and are not
/// integrated.
template <class T>
void BatchKernel<T>::find_moving() {
  const auto zero = [this](int coefficient) {
    if (coefficient < 0) return true;
    const Real* v = reinterpret_cast<const Real*>(&per_lane_.c[static_cast<std::size_t>(coefficient)]);
    return std::all_of(v, v + kLanes, [](Real a) { return a == 0; });
  };
  std::vector<char> still(y_.size());
  for (const Resting& r : resting_)
    still[static_cast<std::size_t>(r.state)] = zero(r.first) && zero(r.second);
  const auto rests = [&](int i) { return still[static_cast<std::size_t>(i)] != 0; };
  moving_.clear();
  sampled_.clear();
  for (int i = 0; i < states_; ++i)
    if (!rests(i)) moving_.push_back(i);
  std::ranges::remove_copy_if(wanted_, std::back_inserter(sampled_), rests);
  trial_ = y_;
}

/// Determines whether any lane weights a state more than State::weight.
template <class T>
void BatchKernel<T>::find_weights() {
  weighs_ = std::ranges::any_of(weighed_, [this](const Weighed& w) {
    return any_positive(per_lane_.c[static_cast<std::size_t>(w.coefficient)] - T(1.0));
  });
}

/// Returns the last time [s] at which effects are evaluated before a discontinuity at `switching_time`. It is
/// representable in the lanes' precision.
template <class Real>
double moment_before(double switching_time) {
  if constexpr (std::is_same_v<Real, float>)
    return std::nextafter(static_cast<float>(switching_time), 0.0F);
  else
    return switching_time - plant::kBeforeSwitching;
}

/// Sets the matrices and set-points of the lane's current segment and restarts the step control.
template <class T>
void BatchKernel<T>::enter_segment(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  const auto l = static_cast<std::size_t>(lane);
  const network::Segment& segment = run.segments[run.segment];
  const Terminals& terminals = set_matrix(lane, segment.topology);
  grounded_[l] = terminals.grounded;
  connected_[l] = terminals.connected;
  per_lane_.factored &= ~(1U << lane);
  tripped_ &= ~(1U << lane);
  run.islands.clear();
  if (islands_ > 1 || !segment.topology.open.empty()) {
    const std::vector<int> of_bus = network::islands(grid_.network, segment.topology.open);
    for (const plant::Plant& plant : grid_.plants)
      run.islands.push_back(of_bus[static_cast<std::size_t>(plant.bus)]);
    if (std::ranges::all_of(run.islands, [&](int i) { return i == run.islands.front(); }))
      run.islands.clear();
  }
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    Traits::set(per_lane_.on[i], lane, terminals.tripped[i] ? 0.0 : 1.0);
    if (terminals.tripped[i]) tripped_ |= 1U << lane;
    double dvref = 0.0, dpref = 0.0;
    for (const network::Setpoint& move : segment.setpoints)
      if (move.generator == grid_.plants[i].generator) dvref = move.dVref, dpref = move.dPref;
    Traits::set(per_lane_.dvref[i], lane, dvref);
    Traits::set(per_lane_.dpref[i], lane, dpref);
  }
  const bool last = run.segment + 1 >= run.segments.size();
  const double end = last ? options_.t_end : run.segments[run.segment + 1].start;
  Traits::set(per_lane_.last_moment, lane,
              last ? std::numeric_limits<Real>::max() : moment_before<Real>(end));
  run.clock.restart(std::min(end, options_.t_end));
  fresh_ |= 1U << lane;
}

/// Records the samples before the first switching time without integration. The grid is in steady state until
/// then (operating_point checks the derivatives), so these samples equal the operating point.
template <class T>
void BatchKernel<T>::record_steady_start(int lane) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  if (!(run.segments[0].topology == network::Topology{}) || !run.segments[0].setpoints.empty()) return;
  if (!run.discontinuities.empty() && run.discontinuities.front() <= 0.0) return;
  const bool switches = run.segments.size() > 1 && run.segments[1].start < options_.t_end;
  const double first = switches ? run.segments[1].start : options_.t_end;
  const int count = samples_until(first);
  run.pending = 1;
  evaluate_pending(lane, 1);
  repeat_last(run, count);
  run.clock.t = first;
  if (switches) {
    run.segment = 1;
    enter_segment(lane);
  }
}

/// Fills a lane's buffer with its operating point, because constant states are not interpolated.
template <class T>
void BatchKernel<T>::fill_waiting(int lane) {
  Real* to = waiting(lanes_[static_cast<std::size_t>(lane)]);
  const Real* from = reinterpret_cast<const Real*>(y_.data()) + lane;
  for (int pack = 0; pack < kBufferSamples / kLanes; ++pack)
    for (std::size_t i = 0; i < y_.size(); ++i, to += kLanes) std::fill(to, to + kLanes, from[i * kLanes]);
}

/// Returns the number of samples at or before t [s].
template <class T>
int BatchKernel<T>::samples_until(double t) const {
  int count = static_cast<int>(t * options_.rate) + 1;
  while (count > 0 && (count - 1) / options_.rate > t) --count;
  while (count / options_.rate <= t) ++count;
  return count < samples_ ? count : samples_;
}

/// Starts the next job in this lane. A job without switching is complete and handed over at once.
template <class T>
void BatchKernel<T>::refill(int lane, const Next& next, const Done& done) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  for (;;) {
    run.job = {};
    if (!next(run.job)) break;
    const auto changed = changed_plants(grid_, run.job);
    run.discontinuities.clear();
    for (std::size_t i = 0; i < plants_.size(); ++i) {
      const auto other = changed.find(static_cast<int>(i));
      const auto more = plant::switching_times_of(other == changed.end() ? grid_.plants[i] : other->second);
      run.discontinuities.insert(run.discontinuities.end(), more.begin(), more.end());
    }
    std::ranges::sort(run.discontinuities);
    run.segments = network::segments(run.job.event, grid_.network, run.discontinuities);
    begin_record(run);
    load(lane);
    fill_waiting(lane);
    enter_segment(lane);
    record_steady_start(lane);
    if (run.clock.t < options_.t_end) {
      active_ |= 1U << lane;
      return;
    }
    hand_over(lane, Outcome::stable, done);
  }
  // No job remains: the lane idles at the grid's own operating point.
  active_ &= ~(1U << lane);
  run.job = {};
  run.segments = {{0.0, {}, {}}};
  load(lane);
  enter_segment(lane);
  run.clock.next = std::numeric_limits<double>::infinity();
}

template <class T>
void BatchKernel<T>::begin_record(BatchRun& run) const {
  auto& record = run.record;
  record.rate = options_.rate;
  record.samples = samples_;
  record.plants = recorded_;
  record.channels = channels_;
  record.allocate(true);
  record.outcome = Outcome::stable;
  record.largest_spread = 0.0;
  run.recorded = run.pending = 0;
  run.waiting.resize(y_.size() * kBufferSamples * sizeof(Real) / sizeof(double));
  run.theta.assign(recorded_.size(), 0.0);
}

/// Completes a run and passes its record to `done`. A run that ended early repeats its last sample to the
/// end.
template <class T>
void BatchKernel<T>::hand_over(int lane, Outcome outcome, const Done& done) {
  auto& run = lanes_[static_cast<std::size_t>(lane)];
  run.record.outcome = outcome;
  run.record.stopped_at = run.clock.t;
  evaluate_pending(lane, run.pending);
  repeat_last(run, samples_);
  done(run.job, run.record);
}

}  // namespace swingbank::sim::batch
