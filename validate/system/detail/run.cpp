#include "validate/system/detail/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "sim/core/window.hpp"
#include "sim/plant/measure.hpp"
#include "sim/reference/reference.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::system {
namespace {

std::vector<double> scaled(const double* values, int n, double factor) {
  std::vector<double> out(values, values + n);
  for (double& v : out) v *= factor;
  return out;
}

/// Corrects the samples beside a step at position `at` [samples]. A window average of uncorrected samples
/// would place the step half-way between them. The nearer sample gets a share of the step, so that window
/// averages correspond to the true position.
void place_step(std::vector<Complex>& y, double at) {
  const double before = std::floor(at + 1e-6);
  if (before < 0 || before + 2 > static_cast<double>(y.size())) return;
  const auto k = static_cast<std::size_t>(before);
  const double late = std::max(at - before, 0.0) - 0.5;
  const Complex step = y[k + 1] - y[k];
  y[late < 0 ? k : k + 1] -= late * step;
}

void thin(std::vector<double>& values, int samples, int stride) {
  if (values.empty()) return;
  for (int k = 0; k < samples; ++k)
    values[static_cast<std::size_t>(k)] = values[static_cast<std::size_t>(k * stride)];
  values.resize(static_cast<std::size_t>(samples));
}

class Player {
 public:
  Player(const SystemCase& system, const sim::network::Event& event) : s_(system), event_(event) {
    out.responses.resize(s_.terminals.size());
    // Terminals with equal sampling times share a simulation without interpolation.
    std::map<std::tuple<double, double, int>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < s_.terminals.size(); ++i) {
      const record::Record& r = s_.terminals[i].record;
      groups[{r.t.front(), r.step(), r.samples()}].push_back(i);
    }
    for (const auto& [when, members] : groups)
      play(std::get<0>(when), std::get<1>(when), std::get<2>(when), members);
  }
  SystemRun out;

 private:
  /// Sampling of a group of terminals.
  struct Sampling {
    double first, rate;  ///< [s], [1/s]
    int stride;          ///< simulation samples per record sample
    int samples;         ///< samples of the record
  };

  void play(double first, double step, int samples, const std::vector<std::size_t>& members) {
    using sim::Channel;
    double memory = 0;
    for (const std::size_t i : members)
      memory = std::max(memory, sim::plant::memory(s_.terminals[i].instruments));
    const int stride = memory > 0 ? playin::kOversampling : 1;
    sim::reference::ReferenceOptions o;
    o.rate = stride / step;
    o.t_end = step * (samples - 1) + memory + 0.01 * step;
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
    if (o.plants.empty()) o.plants = {0};  // an empty list means all plants
    const sim::network::Event event = moved(event_, [&](double t) { return t - first; });
    const sim::reference::ReferenceRun run = sim::reference::run_reference(s_.grid, event, o);
    if (run.outcome != sim::Outcome::stable && run.outcome != sim::Outcome::lost_synchronism)
      throw InputError({fmt::format("the grid cannot be simulated beyond {:g} s", first + run.stopped_at),
                        s_.raw.string() + " and " + s_.dyr.string(),
                        fmt::format("the run ended with {}", sim::outcome_name(run.outcome)),
                        "check the impedances and time constants that act at this time"});
    if (run.outcome != sim::Outcome::stable && first + run.stopped_at < out.stopped_at) {
      out.outcome = run.outcome;
      out.stopped_at = first + run.stopped_at;
    }
    for (std::size_t k = 0; k < plants.size(); ++k) take_plant(run, static_cast<int>(k), plants[k]);
    for (std::size_t k = 0; k < buses.size(); ++k) {
      Modelled& m = out.responses[buses[k]];
      const auto from = static_cast<std::ptrdiff_t>(k) * run.samples;
      m.V = scaled(run.bus_v.data() + from, run.samples, 1);
      m.theta = scaled(run.bus_theta.data() + from, run.samples, 1);
      record::unwrap(m.theta);
    }
    for (const std::size_t i : members) measure(i, {first, o.rate, stride, samples});
  }
  void take_plant(const sim::reference::ReferenceRun& run, int row, std::size_t terminal) {
    Modelled& m = out.responses[terminal];
    const sim::plant::Plant& plant = s_.grid.plants[static_cast<std::size_t>(s_.terminals[terminal].plant)];
    const double base = plant.mva / s_.base.mva;
    const auto channel = [&](int c, double factor) { return scaled(run.at(row, c), run.samples, factor); };
    m.V = channel(0, 1);
    m.theta = channel(1, 1);
    m.P = channel(2, base);
    m.Q = channel(3, base);
    m.speed = channel(4, 1);
    m.Efd = channel(5, 1);
    m.Ifd = channel(6, 1);
    record::unwrap(m.theta);
  }

  /// Applies the terminal's instruments and reduces the response to the record's samples.
  void measure(std::size_t terminal, const Sampling& at) {
    Modelled& m = out.responses[terminal];
    const SystemTerminal& t = s_.terminals[terminal];
    if (!t.instruments.empty()) {
      sim::Phasors phasors = phasors_at(t, m, at.rate);
      if (sim::plant::memory(t.instruments) > 0)
        for (const double switching_time : switching_times_of(event_))
          for (auto* y : {&phasors.V, &phasors.I}) place_step(*y, (switching_time - at.first) * at.rate);
      sim::plant::measure(t.instruments, 1, phasors);
      const sim::plant::TerminalRecord seen = sim::plant::terminal_of(phasors, m.theta.front());
      m.V = seen.V;
      m.theta = seen.theta;
      if (t.plant >= 0) m.P = seen.P, m.Q = seen.Q;
    }
    for (auto* channel : {&m.V, &m.theta, &m.P, &m.Q, &m.speed, &m.Efd, &m.Ifd})
      thin(*channel, at.samples, at.stride);
  }
  [[nodiscard]] sim::Phasors phasors_at(const SystemTerminal& t, const Modelled& m, double rate) const {
    const double frequency = s_.base.frequency;
    if (t.plant >= 0)
      return sim::plant::phasors_of({m.V, m.theta, m.P, m.Q, {}}, rate, frequency, "terminal " + t.name);
    sim::Phasors bus{rate,
                     frequency,
                     {},
                     std::vector<Complex>(m.V.size(), 0.0),
                     sim::frequency_deviation(m.theta, rate, frequency)};
    for (std::size_t k = 0; k < m.V.size(); ++k) bus.V.push_back(std::polar(m.V[k], m.theta[k]));
    return bus;
  }

  const SystemCase& s_;
  const sim::network::Event& event_;
};

}  // namespace

SystemRun run_system(const SystemCase& system, const sim::network::Event& event) {
  return std::move(Player(system, event).out);
}

std::vector<double> switching_times_of(const sim::network::Event& e) {
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

}  // namespace swingbank::validate::system
