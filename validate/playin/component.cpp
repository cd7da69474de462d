#include "validate/playin/component.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/plant/equations.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/playin/detail/recorded.hpp"

namespace swingbank::validate::playin {
namespace {

using record::Component;
using sim::Slot;

struct RecordedMachine {
  static constexpr std::string_view name = "RECORDED",
                                    title = "machine whose signals are those of the record",
                                    source = "the record", description = "";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::array<sim::Parameter, 0> parameters = {};
  static constexpr sim::State states[] = {{"delta", "rad", "constant"}, {"speed", "pu", "constant"}};
  static constexpr int coefficients = recorded::kCoefficients, scratch = recorded::kMoves;

  static void check(const double*, const std::string&, Problems&) {}
  static std::string_view unphysical(const double*) { return ""; }
  template <class T>
  static void prepare(const T*, const sim::Conventions&, T*) {}
  template <class T>
  static void source_impedance(const T*, T& r, T& x) {
    r = T(0.0);
    x = T(1.0);
  }
  template <class T>
  static void emf(const T*, const T*, T*, T& er, T& ei) {
    er = ei = T(0.0);
  }
  /// Does nothing, because the signals already contain the recorded current.
  template <class T>
  static void current(const T*, const T*, T*, sim::Signals<T>&) {}
  template <class T>
  static void electrical(const T* c, const T*, T* m, sim::Signals<T>& s) {
    s.speed = m[recorded::speed];
    s.Ifd = c[recorded::Ifd] + m[recorded::dIfd];
    s.Vs = m[recorded::Vs];
    s.Te = s.P;
  }
  template <class T>
  static void derivative(const T*, const T*, const T*, const sim::Signals<T>&, T* dx) {
    dx[0] = dx[1] = T(0.0);
  }
  template <class T>
  static std::string steady(const T* p, T* c, sim::Signals<T>& s, T* x) {
    x[0] = x[1] = T(0.0);
    s.Efd = p[recorded::Efd];
    s.Tm = p[recorded::Tm];
    s.Ifd = c[recorded::Ifd] = p[recorded::Ifd0];
    return {};
  }
};

/// Perturbation of a signal to test whether any block depends on it.
struct Probe {
  const char* word;
  double reach;
  void (*move)(sim::Signals<double>& s, double* m, double by);
};
constexpr Probe kProbes[] = {
    {"P", 0.3,
     [](sim::Signals<double>& s, double*, double by) {
       s.Ir += by * s.Vr;
       s.Ii += by * s.Vi;
     }},
    {"Q", 0.3,
     [](sim::Signals<double>& s, double*, double by) {
       s.Ir += by * s.Vi;
       s.Ii -= by * s.Vr;
     }},
    {"speed", 0.02, [](sim::Signals<double>&, double* m, double by) { m[recorded::speed] += by; }},
    {"Ifd", 2.0, [](sim::Signals<double>&, double* m, double by) { m[recorded::dIfd] += by; }},
};

/// Returns the signals on which the component's blocks depend, tested at one operating point. Throws
/// InputError if this point has no steady state.
std::vector<std::string> used_signals(const sim::plant::PlantUnderTest& part, double Efd, double Tm) {
  auto p = sim::plant::block_parameters(part.plant);
  p.front() = recorded::operating_parameters<double>(Efd, Efd, Tm);
  const auto at = sim::plant::operating_point_of<double>(part.plant, p, 1.0, 0.6, 0.2, part.conventions);
  const sim::plant::PlantEquations<double> equations(part.plant);
  const auto derivatives = [&](const Probe* probe, double by) {
    sim::Signals<double> s = at.s;
    s.Efd = at.Efd;
    s.Tm = at.Tm;
    s.t = 0;
    std::vector<double> m(static_cast<std::size_t>(equations.scratch()), 0.0), x = at.x;
    std::vector<double> dx(x.size(), 0.0);
    for (double& value : x) value += 1e-6;
    if (probe) probe->move(s, m.data(), by);
    equations.signals(at.c.data(), x.data(), m.data(), s, dx.data());
    dx.push_back(s.Efd);
    dx.push_back(s.Tm);
    dx.push_back(s.Vlimiter);
    return dx;
  };
  const auto still = derivatives(nullptr, 0);
  std::vector<std::string> words;
  for (const Probe& probe : kProbes)
    if (std::ranges::any_of(std::array{-1.0, -0.1, 0.1, 1.0},
                            [&](double share) { return derivatives(&probe, share * probe.reach) != still; }))
      words.emplace_back(probe.word);
  return words;
}

std::vector<std::string> used_signals(const sim::plant::PlantUnderTest& part) {
  for (const double Efd : {2.0, 1.5, 1.0, 2.5, 3.0, 0.6})
    for (const double Tm : {0.6, 0.8, 0.4, 0.2}) {
      try {
        return used_signals(part, Efd, Tm);
      } catch (const InputError&) {  // try the next point
      }
    }
  return {};
}

}  // namespace

const sim::Effect& recorded_machine() {
  static const sim::Effect effect = sim::make_effect<RecordedMachine>();
  return effect;
}

bool is_recorded(const sim::plant::Plant& plant) { return plant.machine.effect == &recorded_machine(); }

bool belongs_to(Component component, Slot slot) {
  switch (component) {
    case Component::plant:
      return true;
    case Component::exciter:
      return slot == Slot::exciter || slot == Slot::stabiliser || slot == Slot::limiter ||
             slot == Slot::compensator || slot == Slot::setpoint;
    case Component::governor:
      return slot == Slot::governor || slot == Slot::shaft || slot == Slot::setpoint;
    case Component::machine:
      return slot == Slot::machine || slot == Slot::transformer || slot == Slot::measurement;
  }
  return false;
}

sim::plant::Plant component_of(const sim::plant::Plant& plant, Component component) {
  if (component == Component::plant) return plant;
  sim::plant::Plant part = plant;
  std::erase_if(part.controls, [&](const auto& b) { return !belongs_to(component, b.effect->slot); });
  if (component == Component::machine) return part;
  part.machine = {&recorded_machine(), {}};
  part.transformer = {};
  part.measurements.clear();
  return part;
}

sim::plant::Plant put_back(const sim::plant::Plant& whole, const sim::plant::Plant& part,
                           Component component) {
  if (component == Component::plant) return part;
  sim::plant::Plant all = whole;
  std::erase_if(all.controls, [&](const auto& b) { return belongs_to(component, b.effect->slot); });
  for (const auto& block : part.controls) sim::plant::insert_block(all, block);
  if (component != Component::machine) return all;
  all.machine = part.machine;
  all.transformer = part.transformer;
  all.measurements = part.measurements;
  return all;
}

std::vector<std::vector<std::string>> needed_columns(const sim::plant::PlantUnderTest& part, Component of) {
  if (of == Component::plant) return {};
  if (of == Component::machine) return {{"V"}, {"theta", "f"}, {"Efd"}, {"P"}, {"Q"}};
  std::vector<std::vector<std::string>> all;
  if (of == Component::exciter) all = {{"V"}, {"Efd"}};
  if (of == Component::governor) all = {{"speed", "f"}, {"Pm", "gate"}, {"Pm", "P"}};
  for (const auto& word : used_signals(part)) {
    if (of == Component::governor && word == "speed") continue;
    all.push_back(word == "speed" ? std::vector<std::string>{"speed", "f"} : std::vector{word});
  }
  return all;
}

std::vector<Output> compared_outputs(const record::Record& record, bool measured_states) {
  std::vector<Output> all;
  if (record.breaker()) {
    all = {Output::V};
    if (measured_states) all.insert(all.end(), {Output::speed, Output::Ifd});
    if (measured_states && record.component == Component::plant) all.push_back(Output::Efd);
    std::erase_if(all, [&](Output o) { return output_of(record, o).empty(); });
    return all;
  }
  switch (record.component) {
    case Component::plant:
      all = {Output::P, Output::Q};
      if (measured_states) all.insert(all.end(), {Output::speed, Output::Efd, Output::Ifd});
      break;
    case Component::exciter:
      return {Output::Efd};
    case Component::governor:
      all = {Output::Pm, Output::gate};
      break;
    case Component::machine:
      all = {Output::P, Output::Q};
      if (measured_states) all.insert(all.end(), {Output::speed, Output::Ifd});
      break;
  }
  std::erase_if(all, [&](Output o) { return output_of(record, o).empty(); });
  return all;
}

}  // namespace swingbank::validate::playin
