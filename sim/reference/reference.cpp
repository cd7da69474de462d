#include "sim/reference/reference.hpp"

#include <sundials/sundials_context.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "base/constants.hpp"
#include "sim/reference/detail/segment_solver.hpp"

namespace swingbank::sim::reference {
namespace {

constexpr double kSameTime = 1e-9;  ///< times that differ by less are equal [s]

constexpr double kNoAngle = 1e-9;  ///< voltage below which the angle is only rounding error [pu]

struct FreeContext {
  void operator()(SUNContext c) const { SUNContext_Free(&c); }
};
struct FreeVector {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
template <class Handle, class Free>
using Owner = std::unique_ptr<std::remove_pointer_t<Handle>, Free>;

/// Writes samples into the trajectory and checks the loss-of-synchronism criteria.
class Recorder {
 public:
  Recorder(const grid::Grid& grid, const ReferencePlants& plants, const ReferenceOptions& options,
           ReferenceRun& run)
      : plants_(plants),
        options_(options),
        run_(run),
        angle_(grid.network.buses.size()),
        signals_(plants.units().size()),
        current_(plants.units().size()) {
    run.rate = options.rate;
    run.samples = static_cast<int>(std::floor(options.t_end * options.rate + 1e-9)) + 1;
    run.plants = options.plants;
    if (run.plants.empty())
      for (int i = 0; i < static_cast<int>(grid.plants.size()); ++i) run.plants.push_back(i);
    run.channels = options.channels;
    if (run.channels.empty())
      for (const auto& record : kChannels) run.channels.push_back(record.channel);
    run.buses = options.buses;
    run.allocate(false);
    run.bus_v.assign(run.buses.size() * run.samples, 0.0);
    run.bus_theta.assign(run.buses.size() * run.samples, 0.0);
    for (std::size_t b = 0; b < angle_.size(); ++b) angle_[b] = std::arg(grid.flow.voltage[b]);
  }
  /// Records sample k from y, in which the system's bolted buses have zero voltage. Returns false if the run
  /// ends at this sample, by a loss of synchronism or a value that is not finite.
  bool record(int k, const ReferenceSystem& system, const double* y) {
    const double* v = y + plants_.states();
    for (std::size_t b = 0; b < angle_.size(); ++b)
      if (!system.bolted(static_cast<int>(b)) && std::hypot(v[2 * b], v[2 * b + 1]) > kNoAngle)
        angle_[b] = nearest(std::atan2(v[2 * b + 1], v[2 * b]), angle_[b]);
    for (std::size_t u = 0; u < plants_.units().size(); ++u)
      if (plants_.units()[u].plant) signals_[u] = system.signals(u, k / options_.rate, y, current_[u]);
    for (std::size_t i = 0; i < run_.plants.size(); ++i) record_plant(i, k, system, y);
    for (std::size_t i = 0; i < run_.buses.size(); ++i) {
      const auto b = static_cast<std::size_t>(run_.buses[i]);
      run_.bus_v[i * run_.samples + k] = std::hypot(v[2 * b], v[2 * b + 1]);
      run_.bus_theta[i * run_.samples + k] = angle_[b];
    }
    if (lost(system, y)) return finish(k, Outcome::lost_synchronism);
    if (!std::all_of(y, y + system.size(), [](double value) { return std::isfinite(value); }))
      return finish(k, Outcome::not_finite);
    return true;
  }
  /// Ends the run at sample k; later samples repeat its value. Returns false.
  bool finish(int k, Outcome outcome) {
    run_.outcome = outcome;
    run_.stopped_at = k / options_.rate;
    const auto repeat_last = [&](auto& values) {
      for (std::size_t row = 0; row * run_.samples < values.size(); ++row) {
        double* first = values.data() + row * run_.samples;
        std::fill(first + k + 1, first + run_.samples, first[k]);
      }
    };
    repeat_last(run_.values);
    repeat_last(run_.bus_v);
    repeat_last(run_.bus_theta);
    return false;
  }

 private:
  /// Returns the angle, shifted by the multiple of 2 pi that brings it closest to the last angle.
  static double nearest(double angle, double last) {
    return angle + constants::turn * std::nearbyint((last - angle) / constants::turn);
  }
  void record_plant(std::size_t i, int k, const ReferenceSystem& system, const double* y) {
    const auto u = static_cast<std::size_t>(run_.plants[i]);
    const auto& unit = plants_.units()[u];
    const Signals<double>& s = signals_[u];
    const Complex v = system.tripped(u) ? Complex(s.Vpr, s.Vpi)
                                        : Complex(y[plants_.states() + 2 * unit.bus],
                                                  y[plants_.states() + 2 * unit.bus + 1]);
    const Complex power = system.tripped(u) ? Complex() : system.connected(u) * v * std::conj(current_[u]);
    for (std::size_t c = 0; c < run_.channels.size(); ++c) {
      double& value = run_.at(static_cast<int>(i), static_cast<int>(c))[k];
      switch (run_.channels[c]) {
        case Channel::delta:
          value = unit.delta < 0 ? 0.0 : y[unit.first + unit.delta];
          break;
        case Channel::speed:
          value = s.speed;
          break;
        case Channel::P:
          value = power.real();
          break;
        case Channel::Q:
          value = power.imag();
          break;
        case Channel::V:
          value = std::abs(v);
          break;
        case Channel::theta:
          value = angle_[static_cast<std::size_t>(unit.bus)];
          if (system.tripped(u)) value = nearest(std::arg(v), k > 0 ? (&value)[-1] : value);
          break;
        case Channel::Efd:
          value = s.Efd;
          break;
        case Channel::Ifd:
          value = s.Ifd;
          break;
        case Channel::Tm:
          value = s.Tm;
          break;
      }
    }
  }
  /// Lowest and highest value of a quantity in an island, and the units that have them.
  struct Ends {
    double low = 1e300, high = -1e300;
    std::size_t lowest = 0, highest = 0;
    void take(double value, std::size_t unit) {
      if (value < low) low = value, lowest = unit;
      if (value > high) high = value, highest = unit;
    }
  };
  bool beyond(const std::map<int, Ends>& islands, double limit, const char* criterion, double& worst) {
    bool over = false;
    for (const auto& [number, ends] : islands) {
      const double apart = ends.high - ends.low;
      worst = std::max(worst, apart);
      if (over || apart < limit) continue;
      over = true;
      run_.lost_by = std::string(criterion) + ": " + plants_.units()[ends.highest].plant->name + " against " +
                     plants_.units()[ends.lowest].plant->name;
    }
    return over;
  }
  bool lost(const ReferenceSystem& system, const double* y) {
    std::map<int, Ends> angles, speeds;
    for (std::size_t u = 0; u < plants_.units().size(); ++u) {
      const auto& unit = plants_.units()[u];
      if (unit.delta < 0 || system.tripped(u)) continue;
      const int island = system.island(unit.bus);
      angles[island].take(y[unit.first + unit.delta] - unit.operating.x[static_cast<std::size_t>(unit.delta)],
                          u);
      speeds[island].take(signals_[u].speed, u);
    }
    double slip = 0.0;
    return beyond(angles, options_.lose_at, "angle", run_.largest_spread) ||
           beyond(speeds, options_.lose_at_slip, "slip", slip);
  }

  const ReferencePlants& plants_;
  const ReferenceOptions& options_;
  ReferenceRun& run_;
  std::vector<double> angle_;             ///< voltage angle of each bus [rad]; the last value while V = 0
  std::vector<Signals<double>> signals_;  ///< signals of each unit at the present sample
  std::vector<Complex> current_;          ///< current of each unit into the grid
};

void operating_values(const grid::Grid& grid, const ReferencePlants& plants, double* y) {
  for (const auto& unit : plants.units())
    std::copy(unit.operating.x.begin(), unit.operating.x.end(), y + unit.first);
  for (std::size_t b = 0; b < grid.flow.voltage.size(); ++b) {
    y[plants.states() + 2 * b] = grid.flow.voltage[b].real();
    y[plants.states() + 2 * b + 1] = grid.flow.voltage[b].imag();
  }
}

/// Crosses a time at which IDA fails because the voltage solution with converters ceases to exist, and the
/// voltages jump to another solution. Returns true, with the new time in t and the values after the jump in
/// y; false if there is no jump.
bool cross_voltage_step(const ReferenceSystem& system, double& t, double* y, const double* yp) {
  constexpr double kOtherVoltage = 1e-3;     // smallest jump to another solution [pu]
  constexpr double kLongestCrossing = 1e-4;  // [s], the states advance by their derivatives meanwhile
  const auto is_converter = [](const ReferenceSystem::Unit& u) {
    return u.plant && u.plant->machine.effect->converter;
  };
  if (std::ranges::none_of(system.units(), is_converter)) return false;
  const std::vector<double> before(y, y + system.size());
  const auto states = static_cast<std::size_t>(system.states());
  for (double past = 1e-8; past < 1.1 * kLongestCrossing; past *= 10.0) {
    for (std::size_t i = 0; i < before.size(); ++i) y[i] = before[i] + (i < states ? past * yp[i] : 0.0);
    (void)system.clamp_states(y);
    double most = 0.0;
    const bool found = system.search_voltages(t + past, y);
    for (std::size_t i = states; i < before.size(); ++i) most = std::max(most, std::abs(y[i] - before[i]));
    if (!found || most < kOtherVoltage) continue;
    t += past;
    return true;
  }
  std::copy(before.begin(), before.end(), y);
  return false;
}

}  // namespace

ReferenceRun run_reference(const grid::Grid& grid, const network::Event& event,
                           const ReferenceOptions& options) {
  ReferenceRun run;
  const ReferencePlants plants(grid);
  Recorder recorder(grid, plants, options, run);
  const std::vector<network::Segment> parts =
      network::segments(event, grid.network, plants.switching_times());

  SUNContext raw = nullptr;
  require(SUNContext_Create(nullptr, &raw), "SUNContext_Create");
  const Owner<SUNContext, FreeContext> context(raw);
  const auto length = plants.states() + 2 * static_cast<sunindextype>(grid.network.buses.size());
  const Owner<N_Vector, FreeVector> y(new_vector(length, raw)), yp(new_vector(length, raw));
  double* values = N_VGetArrayPointer(y.get());
  operating_values(grid, plants, values);
  SeenEntries seen;

  int k = 0;
  // The value before t = 0 is the operating point, even if the event starts at t = 0.
  if (!options.after_switching ||
      (parts.front().topology == network::Topology{} && parts.front().setpoints.empty())) {
    if (!recorder.record(k++, ReferenceSystem(grid, plants, {}, options.t_end), values)) return run;
  }
  for (std::size_t p = 0; p < parts.size() && parts[p].start < options.t_end + kSameTime; ++p) {
    const double start = parts[p].start;
    const bool last = p + 1 == parts.size() || parts[p + 1].start > options.t_end;
    const double end = last ? options.t_end : parts[p + 1].start;
    const ReferenceSystem system(grid, plants, parts[p], last ? 2 * options.t_end + 1.0 : end);
    (void)system.clamp_states(values);
    system.solve_voltages(start, values);
    system.derivatives(start, values, N_VGetArrayPointer(yp.get()));
    const auto time = [&] { return k / options.rate; };
    if (k < run.samples && time() < start + kSameTime && !recorder.record(k++, system, values)) return run;
    if (end - start < kSameTime) continue;

    const auto solver_from = [&](double from) {
      return std::make_unique<SegmentSolver>(raw, system, y.get(), yp.get(), from, end, options, seen);
    };
    auto solver = solver_from(start);
    const auto advance = [&](double to) {
      if (solver->advance(to)) return true;
      double at = solver->reached();
      if (!cross_voltage_step(system, at, values, N_VGetArrayPointer(yp.get())) || at >= end) return false;
      system.derivatives(at, values, N_VGetArrayPointer(yp.get()));
      run.steps += solver->steps();
      solver = solver_from(at);
      return at >= to || solver->advance(to);
    };
    // With after_switching, a sample at the end of the segment belongs to the next segment.
    const double until = last || !options.after_switching ? end + kSameTime : end - kSameTime;
    while (k < run.samples && time() < until) {
      if (!advance(std::min(time(), end))) {
        run.steps += solver->steps();
        recorder.finish(std::max(k - 1, 0), Outcome::step_too_small);
        return run;
      }
      if (!recorder.record(k++, system, values)) {
        run.steps += solver->steps();
        return run;
      }
    }
    const bool reached = advance(end);
    run.steps += solver->steps();
    if (!reached) {
      recorder.finish(std::max(k - 1, 0), Outcome::step_too_small);
      return run;
    }
  }
  run.stopped_at = options.t_end;
  return run;
}

}  // namespace swingbank::sim::reference
