// Runs over every registered control, transformer and load, including later ones. Each is placed in a plant
// (a GENROU with the controls that the effect needs) or at a bus and checked against the contract of effects.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sim/library/library.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::effects {
namespace {

constexpr double kBase = 100.0;
const Complex kVoltage = std::polar(1.02, 0.1), kPower(0.6, 0.15);

plant::Block standard(const Effect& effect) { return {&effect, effect.default_parameters()}; }
plant::Block standard(const char* name) { return standard(*library::compiled().find(name)); }

plant::Plant converter_host(plant::Plant plant, const Effect& effect) {
  plant.machine = standard("REGCA1");
  plant.controls.push_back(standard(effect));
  if (effect.slot != Slot::electrical_control) plant.controls.push_back(standard("REECB1"));
  if (effect.slot == Slot::torque_control) plant.controls.push_back(standard("WTDTA1"));  // the drive train
  std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
  return plant;
}

/// Plant with the effect in its slot and, if necessary, a control that reads its signal.
plant::Plant host(const Effect& effect) {
  plant::Plant plant;
  plant.name = std::string(effect.name);
  plant.bus = 0;
  plant.generation = kPower;
  const Slot slot = effect.slot;
  if (is_of_converter(slot)) return converter_host(std::move(plant), effect);
  plant.machine = standard("GENROU");
  if (slot == Slot::transformer) plant.transformer = standard(effect);
  if (is_control(slot)) plant.controls.push_back(standard(effect));
  if (slot != Slot::exciter) plant.controls.push_back(standard("SEXS"));
  if (slot != Slot::governor) plant.controls.push_back(standard("TGOV1"));
  std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
  return plant;
}
plant::Block& own_block(plant::Plant& plant, const Effect& effect) {
  if (effect.slot == Slot::transformer) return plant.transformer;
  for (plant::Block& b : plant.controls)
    if (b.effect == &effect) return b;
  throw std::logic_error("not there");
}

std::vector<const Effect*> guests() {
  std::vector<const Effect*> list;
  for (const Effect* e : library::compiled().all())
    if (is_control(e->slot) || e->slot == Slot::transformer) list.push_back(e);
  return list;
}
std::vector<const Effect*> loads() {
  std::vector<const Effect*> list;
  for (const Effect* e : library::compiled().all())
    if (e->slot == Slot::load) list.push_back(e);
  return list;
}

/// Parameters within 5 % of the defaults; codes are unchanged.
std::vector<double> draw(const Effect& e, std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(0.95, 1.05);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    auto p = e.default_parameters();
    for (std::size_t i = 0; i < p.size(); ++i)
      if (!e.parameters[i].is_code()) p[i] *= u(random);
    Problems problems;
    e.check(e.user_model.get(), p.data(), "draw", problems);
    if (problems.empty() && e.unphysical(p.data()).empty()) return p;
  }
  ADD_FAILURE() << e.name << ": values within 5 % of the defaults are refused";
  return e.default_parameters();
}

std::vector<std::vector<double>> parameters(const plant::Plant& plant) {
  std::vector<std::vector<double>> all{plant.machine.p};
  if (plant.transformer.effect) all.push_back(plant.transformer.p);
  for (const plant::Block& b : plant.controls) all.push_back(b.p);
  return all;
}

/// Outputs of a plant at a given bus voltage, as an integrator uses them: all derivatives, P, Q, Efd, Tm.
template <class T>
std::vector<T> outputs(const plant::Plant& plant, const plant::OperatingOf<T>& o, const std::vector<T>& x,
                       double t) {
  const plant::PlantEquations<T> equations(plant);
  std::vector<T> m(static_cast<std::size_t>(equations.scratch()), T(0.0)), out(x.size(), T(0.0));
  Signals<T> s;
  s.Vpr = T(kVoltage.real() - 0.03);  // off the operating point
  s.Vpi = T(kVoltage.imag() + 0.01);
  s.Efd = o.Efd;
  s.Tm = o.Tm;
  s.t = T(t);
  T er, ei, ir, ii, p, q;
  equations.emf(o.c.data(), x.data(), m.data(), er, ei);
  equations.from_grid(o.c.data(), x.data(), m.data(), er, ei, s, ir, ii);
  equations.derivative(o.c.data(), x.data(), m.data(), s, out.data());
  equations.grid_power(o.c.data(), s, p, q);
  for (const T& v : {p, q, s.Efd, s.Tm}) out.push_back(v);
  return out;
}

/// States shifted from equilibrium.
std::vector<double> shifts(const plant::Plant& plant, std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<double> list;
  const auto add = [&](const plant::Block& b) {
    for (std::size_t i = 0; i < b.effect->states.size(); ++i)
      list.push_back((b.effect == plant.machine.effect && i == 1 ? 0.005 : 0.02) * u(random));
  };
  add(plant.machine);
  for (const plant::Block& b : plant.controls) add(b);
  return list;
}

/// Time at which every disturbance acts: half a second after its first step.
double busy_time(const plant::Plant& plant) {
  const auto switching_times = plant::switching_times_of(plant);
  return switching_times.empty() ? 1.0 : switching_times.front() + 0.5;
}

TEST(PlantConformance, StaysAtItsOperatingPoint) {
  std::mt19937_64 random(11);
  for (const Effect* e : guests()) {
    plant::Plant plant = host(*e);
    for (int trial = 0; trial < 20; ++trial) {
      own_block(plant, *e).p = draw(*e, random);
      // operating_point itself evaluates every derivative and refuses more than 1e-9 per second
      EXPECT_NO_THROW(plant::operating_point(plant, kVoltage, kBase, Conventions::psse())) << e->name;
      EXPECT_NO_THROW(plant::operating_point(plant, kVoltage, kBase, Conventions::andes())) << e->name;
    }
  }
}

template <class P>
void batch_equals_double(const Effect& e, std::mt19937_64& random) {
  plant::Plant plant = host(e);
  std::vector<std::vector<double>> alone;
  plant::OperatingOf<P> together;
  std::vector<P> x;
  double t = busy_time(plant);
  for (int l = 0; l < P::lanes; ++l) {
    own_block(plant, e).p = draw(e, random);
    const plant::Operating o = plant::operating_point(plant, kVoltage, kBase, Conventions::psse());
    auto states = o.x;
    const auto shift = shifts(plant, random);
    for (std::size_t i = 0; i < states.size(); ++i) states[i] += shift[i];
    alone.push_back(outputs<double>(plant, o, states, t));
    together.c.resize(o.c.size());
    x.resize(states.size());
    for (std::size_t i = 0; i < o.c.size(); ++i) together.c[i].set(l, o.c[i]);
    for (std::size_t i = 0; i < states.size(); ++i) x[i].set(l, states[i]);
    together.Efd.set(l, o.Efd);
    together.Tm.set(l, o.Tm);
  }
  const auto out = outputs<P>(plant, together, x, t);
  for (int l = 0; l < P::lanes; ++l)
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double expected = alone[static_cast<std::size_t>(l)][i];
      // a few ulp, because packs have their own sincos, times gains of up to 1e3
      EXPECT_NEAR(out[i][l], expected, 1e-11 * (1.0 + std::fabs(expected))) << e.name << " output " << i;
    }
}

TEST(PlantConformance, LanesEqualDouble) {
  std::mt19937_64 random(12);
  for (const Effect* e : guests()) {
    batch_equals_double<P4>(*e, random);
    batch_equals_double<P8>(*e, random);
  }
}

template <class T>
std::vector<T> moved(const plant::Plant& plant, const std::vector<std::vector<T>>& p,
                     const std::vector<double>& shift) {
  const auto o = plant::operating_point_of<T>(plant, p, kVoltage, kBase, Conventions::psse());
  auto x = o.x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i] + T(shift[i]);
  return outputs<T>(plant, o, x, busy_time(plant));
}

TEST(PlantConformance, DualsEqualCentralDifferences) {
  std::mt19937_64 random(13);
  for (const Effect* e : guests()) {
    plant::Plant plant = host(*e);
    own_block(plant, *e).p = draw(*e, random);
    const std::size_t block = e->slot == Slot::transformer ? 1 : [&] {
      std::size_t k = 1;
      for (const plant::Block& b : plant.controls) {
        if (b.effect == e) return k;
        ++k;
      }
      return k;
    }();
    const auto shift = shifts(plant, random);
    const auto values = parameters(plant);
    for (std::size_t j = 0; j < e->parameters.size(); ++j) {
      const Parameter& record = e->parameters[j];
      if (record.is_code()) continue;
      // A time constant of zero is a bypass: there is no derivative across its onset.
      if (values[block][j] == 0.0 && record.low == 0.0) continue;
      std::vector<std::vector<D8>> dual;
      for (const auto& v : values) dual.emplace_back(v.begin(), v.end());
      dual[block][j].d.set(0, 1.0);
      const auto exact = moved<D8>(plant, dual, shift);
      const double h = 1e-6 * std::max(1e-2, std::fabs(values[block][j]));
      auto up = values, down = values;
      up[block][j] += h;
      down[block][j] -= h;
      const auto a = moved<double>(plant, up, shift), b = moved<double>(plant, down, shift);
      const auto here = moved<double>(plant, values, shift);
      for (std::size_t i = 0; i < exact.size(); ++i) {
        const double quotient = (a[i] - b[i]) / (2 * h);
        // At a kink (a parameter whose sign selects its meaning) the dual number is the derivative of one
        // side.
        const double kink = std::fabs(a[i] - 2 * here[i] + b[i]) / (2 * h);
        // rounding of the quotient: a few ulp of the inputs, times gains of up to 1e3 (REXS)
        const double rounding = 1e-13 * std::fabs(here[i]) / h;
        EXPECT_NEAR(exact[i].d[0], quotient, 1e-5 * (1.0 + std::fabs(quotient)) + kink + rounding)
            << e->name << " output " << i << " of " << here[i] << " by " << record.name;
      }
    }
  }
}

/// Effects that are switched off by their own parameters change nothing.
TEST(PlantConformance, VanishesAtNullValue) {
  std::mt19937_64 random(14);
  for (const Effect* e : guests()) {
    if (e->slot == Slot::exciter || e->slot == Slot::governor || e->slot == Slot::electrical_control)
      continue;  // no null value
    plant::Plant with = host(*e);
    plant::Block& own = own_block(with, *e);
    bool any = false;
    for (std::size_t i = 0; i < own.p.size(); ++i) {
      const double null_value = e->parameters[i].null_value;
      if (null_value != null_value) continue;
      own.p[i] = null_value;
      any = true;
    }
    if (!any) continue;
    plant::Plant without = with;
    if (e->slot == Slot::transformer)
      without.transformer = {};
    else
      std::erase_if(without.controls, [&](const plant::Block& b) { return b.effect == e; });
    const plant::Operating a = plant::operating_point(with, kVoltage, kBase, Conventions::psse()),
                           b = plant::operating_point(without, kVoltage, kBase, Conventions::psse());
    const double t = busy_time(with);
    const auto x = outputs<double>(with, a, a.x, t), y = outputs<double>(without, b, b.x, t);
    for (std::size_t i = 0; i < 4; ++i)  // P, Q, Efd, Tm: rounding only
      EXPECT_NEAR(x[x.size() - 4 + i], y[y.size() - 4 + i], 1e-12) << e->name << " output " << i;
  }
}

plant::Consumer consumer(const Effect& e, const std::vector<double>& p) {
  plant::Consumer c;
  c.name = std::string(e.name);
  c.bus = 0;
  c.mva = kBase;
  c.consumption = kPower;
  c.block = {&e, p};
  return c;
}
template <class T>
std::vector<T> load_outputs(const plant::Consumer& load, const plant::OperatingOf<T>& o,
                            const std::vector<T>& x) {
  const plant::LoadEquations<T> equations(load);
  Signals<T> s;
  s.Vpr = s.Vr = T(kVoltage.real() - 0.1);  // it regulates its own bus, if any
  s.Vpi = s.Vi = T(kVoltage.imag() + 0.02);
  equations.current(o.c.data(), x.data(), s);
  std::vector<T> out(x.size(), T(0.0));
  equations.derivative(o.c.data(), x.data(), s, out.data());
  out.push_back(s.Ir);
  out.push_back(s.Ii);
  return out;
}

TEST(LoadConformance, StaysAtItsOperatingPointAndLanesEqualDouble) {
  std::mt19937_64 random(15);
  std::uniform_real_distribution<double> u(-0.02, 0.02);
  for (const Effect* e : loads()) {
    plant::OperatingOf<P8> together;
    std::vector<P8> x;
    std::vector<std::vector<double>> alone;
    for (int l = 0; l < P8::lanes; ++l) {
      const plant::Consumer load = consumer(*e, draw(*e, random));
      const plant::Operating o =
          plant::load_operating_point(load, load.block.p, kVoltage, kBase, Conventions::psse());
      auto states = o.x;
      for (double& v : states) v += u(random);
      alone.push_back(load_outputs<double>(load, o, states));
      together.c.resize(o.c.size());
      x.resize(states.size());
      for (std::size_t i = 0; i < o.c.size(); ++i) together.c[i].set(l, o.c[i]);
      for (std::size_t i = 0; i < states.size(); ++i) x[i].set(l, states[i]);
    }
    const auto out = load_outputs<P8>(consumer(*e, e->default_parameters()), together, x);
    for (int l = 0; l < P8::lanes; ++l)
      for (std::size_t i = 0; i < out.size(); ++i)  // rounding
        EXPECT_NEAR(out[i][l], alone[static_cast<std::size_t>(l)][i],
                    1e-11 * (1.0 + std::fabs(alone[static_cast<std::size_t>(l)][i])))
            << e->name << " output " << i;
  }
}

TEST(LoadConformance, DualsEqualCentralDifferences) {
  std::mt19937_64 random(16);
  for (const Effect* e : loads()) {
    const plant::Consumer load = consumer(*e, draw(*e, random));
    const auto value = [&](const auto& p) {
      using T = typename std::decay_t<decltype(p)>::value_type;
      const auto o = plant::load_operating_point<T>(load, p, kVoltage, kBase, Conventions::psse());
      auto x = o.x;
      for (auto& v : x) v = v + T(0.01);
      return load_outputs<T>(load, o, x);
    };
    for (std::size_t j = 0; j < e->parameters.size(); ++j) {
      if (e->parameters[j].is_code() || (load.block.p[j] == 0.0 && e->parameters[j].low == 0.0)) continue;
      std::vector<D8> dual(load.block.p.begin(), load.block.p.end());
      dual[j].d.set(0, 1.0);
      const auto exact = value(dual);
      const double h = 1e-6 * std::max(1e-2, std::fabs(load.block.p[j]));
      auto up = load.block.p, down = up;
      up[j] += h;
      down[j] -= h;
      const auto a = value(up), b = value(down);
      for (std::size_t i = 0; i < exact.size(); ++i) {
        const double quotient = (a[i] - b[i]) / (2 * h);
        EXPECT_NEAR(exact[i].d[0], quotient, 1e-5 * (1.0 + std::fabs(quotient)))
            << e->name << " output " << i << " by " << e->parameters[j].name;
      }
    }
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
