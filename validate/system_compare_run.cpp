#include "validate/system_compare_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "sim/solve/reference.hpp"

namespace swingbank::validate {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

std::vector<double> scaled(const double* values, int n, double factor) {
  std::vector<double> out(values, values + n);
  for (double& v : out) v *= factor;
  return out;
}
void unwrap(std::vector<double>& angle) {
  for (std::size_t k = 1; k < angle.size(); ++k)
    angle[k] -= kTurn * std::round((angle[k] - angle[k - 1]) / kTurn);
}

class Player {
 public:
  Player(const SystemCase& system, const sim::Event& event) : s_(system), event_(event) {
    out.answers.resize(s_.terminals.size());
    // Terminals that were sampled at the same instants share a simulation, which then needs no interpolation.
    std::map<std::tuple<double, double, int>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < s_.terminals.size(); ++i) {
      const Record& r = s_.terminals[i].record;
      groups[{r.t.front(), r.step(), r.samples()}].push_back(i);
    }
    for (const auto& [when, members] : groups)
      play(std::get<0>(when), std::get<1>(when), std::get<2>(when), members);
  }
  SystemRun out;

 private:
  void play(double first, double step, int samples, const std::vector<std::size_t>& members) {
    using sim::Channel;
    sim::ReferenceOptions o;
    o.rate = 1 / step;
    o.t_end = step * (samples - 1) + 0.01 * step;
    o.rtol = s_.tolerance;
    o.atol = s_.tolerance / 100;
    o.channels = {Channel::V,     Channel::theta, Channel::P,  Channel::Q,
                  Channel::speed, Channel::Efd,   Channel::Ifd};
    std::vector<std::size_t> plants, buses;
    for (const std::size_t i : members) {
      const SystemTerminal& t = s_.terminals[i];
      (t.plant >= 0 ? plants : buses).push_back(i);
      (t.plant >= 0 ? o.plants : o.buses).push_back(t.plant >= 0 ? t.plant : t.bus);
    }
    if (o.plants.empty()) o.plants = {0};  // none would mean all
    const sim::Event event = moved(event_, [&](double t) { return t - first; });
    const sim::ReferenceRun run = sim::run_reference(s_.grid, event, o);
    if (run.outcome != sim::Outcome::stable && first + run.stopped_at < out.stopped_at) {
      out.outcome = run.outcome;
      out.stopped_at = first + run.stopped_at;
    }
    for (std::size_t k = 0; k < plants.size(); ++k) take_plant(run, static_cast<int>(k), samples, plants[k]);
    for (std::size_t k = 0; k < buses.size(); ++k) {
      Modelled& m = out.answers[buses[k]];
      const auto from = static_cast<std::ptrdiff_t>(k) * run.samples;
      m.V = scaled(run.bus_v.data() + from, samples, 1);
      m.theta = scaled(run.bus_theta.data() + from, samples, 1);
      unwrap(m.theta);
    }
  }
  void take_plant(const sim::ReferenceRun& run, int row, int samples, std::size_t terminal) {
    Modelled& m = out.answers[terminal];
    const sim::Plant& plant = s_.grid.plants[static_cast<std::size_t>(s_.terminals[terminal].plant)];
    const double base = plant.mva / s_.base.mva;
    const auto channel = [&](int c, double factor) { return scaled(run.at(row, c), samples, factor); };
    m.V = channel(0, 1);
    m.theta = channel(1, 1);
    m.P = channel(2, base);
    m.Q = channel(3, base);
    m.speed = channel(4, 1);
    m.Efd = channel(5, 1);
    m.Ifd = channel(6, 1);
    unwrap(m.theta);
  }

  const SystemCase& s_;
  const sim::Event& event_;
};

}  // namespace

SystemRun run_system(const SystemCase& system, const sim::Event& event) {
  return std::move(Player(system, event).out);
}

/// Instants at which something is switched, sorted.
std::vector<double> instants_of(const sim::Event& e) {
  std::set<double> all;
  for (const auto& f : e.faults) all.insert({f.t_on, f.t_off});
  for (const auto& t : e.trips) {
    all.insert(t.t_open);
    if (t.t_close) all.insert(*t.t_close);
  }
  for (const auto& g : e.generator_trips) all.insert(g.time);
  for (const auto& l : e.load_steps) {
    all.insert(l.t_on);
    if (l.t_off) all.insert(*l.t_off);
  }
  for (const auto& s : e.setpoint_steps) all.insert(s.time);
  return {all.begin(), all.end()};
}

}  // namespace swingbank::validate
