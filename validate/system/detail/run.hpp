#pragma once
// The event played in the full grid, and what the model has at every terminal of a system comparison.
#include <limits>
#include <vector>

#include "validate/system/system.hpp"

namespace swingbank::validate::system {

/// What the grid has at one terminal, on the record's instants and base.
struct Modelled {
  std::vector<double> V, theta, P, Q, speed, Efd, Ifd;
};

/// One simulation per set of sampling instants: terminals that share theirs share it, and nothing is
/// interpolated.
struct SystemRun {
  std::vector<Modelled> answers;  ///< one per terminal
  sim::Outcome outcome = sim::Outcome::stable;
  double stopped_at = std::numeric_limits<double>::infinity();  ///< on the records' clock [s]
};
/// Behind instruments with a memory, whose answers need samples between the record's, the grid is sampled so
/// many times as often.
constexpr int kFine = 8;

/// What the terminals' instruments show of the event in the grid. Throws InputError as run_reference, and
/// where a voltage of zero leaves an instrument no current to show.
SystemRun run_system(const SystemCase& system, const sim::network::Event& event);

/// Instants at which something is switched, sorted [s].
std::vector<double> instants_of(const sim::network::Event& event);

/// The event with every instant moved by `move`.
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

/// Where the records say that the event's instants were: their voltages' jumps tell each to half a sample,
/// and within that it is moved to where model and records agree best up to one second after the last (V, P
/// and Q of every terminal; a wrong model cannot move an instant further). Returns one per instant of the
/// event, and sets `uncertainty` [s]. Throws InputError if no record shows as many jumps as the event has
/// instants.
std::vector<double> found_instants(const SystemCase& system, double& uncertainty);

/// What contradicts the given instants in a record: as many jumps of the voltage, but at other times. Empty
/// if nothing does.
std::string clock_doubt(const record::Record& record, const std::vector<double>& instants);

}  // namespace swingbank::validate::system
