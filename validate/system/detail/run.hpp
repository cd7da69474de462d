#pragma once
// Simulation of the event in the full grid, with the response at every terminal of a system comparison.
#include <algorithm>
#include <limits>
#include <vector>

#include "validate/system/system.hpp"

namespace swingbank::validate::system {

/// Simulated response at one terminal, at the record's sampling times and on its base.
struct Modelled {
  std::vector<double> V, theta, P, Q, speed, Efd, Ifd;
};

/// Responses of all terminals. Terminals with equal sampling times share a simulation, so that no response is
/// interpolated.
struct SystemRun {
  std::vector<Modelled> responses;  ///< one per terminal
  sim::Outcome outcome = sim::Outcome::stable;
  /// End of the simulation on the records' clock [s]; infinite if it reached the end of the records.
  double stopped_at = std::numeric_limits<double>::infinity();
};

/// Simulates the event and applies the terminals' instruments. Throws InputError as run_reference(), if the
/// integration fails before the end, and if a voltage of zero leaves an instrument's current undefined.
SystemRun run_system(const SystemCase& system, const sim::network::Event& event);

/// Returns the switching times of the event, sorted [s].
std::vector<double> switching_times_of(const sim::network::Event& event);

/// Returns the event with `move` applied to every switching time.
template <class Move>
sim::network::Event moved(sim::network::Event e, Move move) {
  for (auto& f : e.faults) f.t_on = move(f.t_on), f.t_off = move(f.t_off);
  for (auto& t : e.trips) {
    t.t_open = move(t.t_open);
    if (t.t_close) t.t_close = move(*t.t_close);
  }
  for (auto& g : e.generator_trips) g.time = move(g.time);
  for (auto& l : e.load_steps) {
    l.t_on = move(l.t_on);
    if (l.t_off) l.t_off = move(*l.t_off);
  }
  for (auto& s : e.setpoint_steps) s.time = move(s.time);
  return e;
}
/// Returns the event with its switching times `written`, in ascending order, replaced one by one by those of
/// `to`.
inline sim::network::Event moved(const sim::network::Event& event, const std::vector<double>& written,
                                 const std::vector<double>& to) {
  return moved(event, [&](double t) {
    return to[static_cast<std::size_t>(std::ranges::lower_bound(written, t) - written.begin())];
  });
}

/// Estimates the event's switching times. Voltage steps determine each time within half a sampling interval
/// or, behind a filter, within half the width of the filtered step. Within this uncertainty the times are
/// fitted to V, P and Q of every terminal, up to one second after the last switching. A wrong model thus
/// cannot move them further. Sets `uncertainty` [s]. Throws InputError if no record has as many voltage steps
/// as the event has switching times.
std::vector<double> estimate_switching_times(const SystemCase& system, double& uncertainty);

/// Returns a warning if a record has as many voltage steps as there are switching times, but at other times;
/// otherwise an empty text.
std::string clock_doubt(const record::Record& record, const std::vector<double>& switching_times);

}  // namespace swingbank::validate::system
