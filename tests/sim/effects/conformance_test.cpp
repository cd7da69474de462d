// Runs over every registered effect, including later ones: records, steady state, SIMD batch against double,
// dual numbers against central differences, no influence at the null value.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <random>
#include <set>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::effects {
namespace {

/// Evaluates a machine once. Outputs as an integrator uses them: emf (or the current, if the machine returns
/// it), speed, Te, Ifd and all derivatives.
template <class T>
struct MachineCase {
  std::vector<T> p, c, x, m;
  Signals<T> s;
  std::vector<T> outputs(const Effect& e) {
    const auto& ops = e.get<T>().machine;
    std::vector<T> dx(e.states.size(), T(0.0)), out;
    T er, ei;
    ops.emf(c.data(), x.data(), m.data(), er, ei);
    if (ops.current) {
      ops.current(c.data(), x.data(), m.data(), s);
      er = s.Ir;
      ei = s.Ii;
    }
    ops.electrical(c.data(), x.data(), m.data(), s);
    ops.derivative(c.data(), x.data(), m.data(), s, dx.data());
    out = {er, ei, s.speed, s.Te, s.Ifd};
    out.insert(out.end(), dx.begin(), dx.end());
    return out;
  }
};

template <class T>
MachineCase<T> at_steady(const Effect& e, const std::vector<T>& p, const Conventions& conventions, double vr,
                         double vi, double ir, double ii) {
  MachineCase<T> k;
  k.p = p;
  k.c.assign(static_cast<std::size_t>(e.coefficients), T(0.0));
  k.m.assign(static_cast<std::size_t>(e.scratch), T(0.0));
  k.x.assign(e.states.size(), T(0.0));
  k.s.Vr = T(vr);
  k.s.Vi = T(vi);
  k.s.Ir = T(ir);
  k.s.Ii = T(ii);
  e.get<T>().prepare(k.p.data(), conventions, k.c.data());
  EXPECT_EQ(e.get<T>().machine.steady(k.p.data(), k.c.data(), k.s, k.x.data()), "");
  return k;
}

/// Returns whether a plant refuses the operating point because a state is outside its limits.
bool beyond_limits(const Effect& e, const MachineCase<double>& k) {
  for (std::size_t i = 0; i < k.x.size(); ++i) {
    const State& state = e.states[i];
    const auto limit = [&](int index) { return k.c[static_cast<std::size_t>(index)]; };
    if ((state.low >= 0 && k.x[i] < limit(state.low)) || (state.high >= 0 && k.x[i] > limit(state.high)))
      return true;
  }
  return false;
}

/// Physical parameters: each within 5 % of its default or, if the default is zero, about 1 % of its range
/// above the lower end.
std::vector<double> draw(const Effect& e, std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(0.95, 1.05);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    auto p = e.default_parameters();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto& r = e.parameters[i];
      if (r.is_code()) continue;
      p[i] = p[i] == 0.0 ? r.low + 0.01 * u(random) * (r.high - r.low) : p[i] * u(random);
    }
    if (e.unphysical(p.data()).empty()) return p;
  }
  ADD_FAILURE() << e.name << ": no drawn values are physical";
  return e.default_parameters();
}

std::vector<const Effect*> machines() {
  std::vector<const Effect*> list;
  for (const auto& e : library::compiled_effects())
    if (e.slot == Slot::machine) list.push_back(&e);
  return list;
}

TEST(Conformance, RecordsAreComplete) {
  ASSERT_FALSE(library::compiled_effects().empty());
  std::set<std::string_view> names;
  for (const auto& e : library::compiled_effects()) {
    EXPECT_TRUE(names.insert(e.name).second) << e.name << " twice";
    EXPECT_FALSE(e.source.empty()) << e.name;
    std::set<std::string_view> parameters;
    for (const auto& r : e.parameters) {
      EXPECT_TRUE(parameters.insert(r.name).second) << e.name << "." << r.name << " twice";
      EXPECT_LE(r.low, r.default_value) << e.name << "." << r.name;
      EXPECT_LE(r.default_value, r.high) << e.name << "." << r.name;
      EXPECT_FALSE(r.unit.empty() || r.meaning.empty()) << e.name << "." << r.name;
      EXPECT_TRUE(r.default_from.given() && r.bounds_from.given()) << e.name << "." << r.name;
      if (r.null_value == r.null_value) {  // not NaN: a null value exists
        EXPECT_TRUE(std::min(r.low, 0.0) <= r.null_value && r.null_value <= r.high)
            << e.name << "." << r.name;
      }
    }
    for (int column : e.dyr_columns) EXPECT_LT(column, static_cast<int>(e.parameters.size())) << e.name;
    Problems problems;
    e.check(nullptr, e.default_parameters().data(), "test", problems);
    EXPECT_TRUE(problems.empty()) << e.name << ": default values are refused";
  }
}

/// Returns the words of a text that may be a name of an effect.
std::set<std::string, std::less<>> words_of(const std::string& text) {
  std::set<std::string, std::less<>> words;
  std::string word;
  for (const char c : text + ' ')
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      word += c;
    } else {
      words.insert(std::exchange(word, {}));
    }
  return words;
}

TEST(Conformance, ProblemsNameTheEffectAndItsParameters) {
  for (const auto& e : library::compiled_effects())
    for (const double sign : {-1.0, 0.0, 1.0})
      for (std::size_t i = 0; i < e.parameters.size(); ++i) {
        std::vector<double> p = e.default_parameters();
        p[i] = sign * 1234.5;
        Problems problems;
        e.check(e.user_model.get(), p.data(), "test", problems);
        for (const Problem& problem : problems.list()) {
          const auto words = words_of(problem.what + ' ' + problem.why);
          for (const auto& other : library::compiled_effects())
            EXPECT_TRUE(&other == &e || !words.contains(other.name)) << e.name << ": " << problem.sentence();
          const auto equals = problem.what.find(" = ");
          if (equals == std::string::npos) continue;
          EXPECT_GE(e.parameter_index(problem.what.substr(0, equals)), 0)
              << e.name << ": " << problem.sentence();
        }
      }
}

TEST(Conformance, SteadyStateHasZeroDerivatives) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (const Effect* e : machines())
    for (const auto& conventions : {Conventions::psse(), Conventions::andes()})
      for (int trial = 0; trial < 100; ++trial) {
        auto k = at_steady<double>(*e, draw(*e, random), conventions, 1.0 + 0.1 * u(random), 0.3 * u(random),
                                   0.8 + 0.2 * u(random), 0.4 * u(random));
        if (beyond_limits(*e, k)) continue;
        const double vr = k.s.Vr, vi = k.s.Vi, ir = k.s.Ir, ii = k.s.Ii;
        const auto out = k.outputs(*e);
        for (std::size_t i = 5; i < out.size(); ++i)
          EXPECT_NEAR(out[i], 0.0, 1e-11)
              << e->name << "." << e->states[i - 5].name;  // rounding, over T'' >= 0.005 s
        if (e->get<double>().machine.current) {
          EXPECT_NEAR(out[0], ir, 1e-12) << e->name << ": its current is not the operating point's";
          EXPECT_NEAR(out[1], ii, 1e-12) << e->name;  // rounding divided by a reactance of 0.2 pu
          continue;
        }
        double r, x;
        e->get<double>().machine.source_impedance(k.p.data(), r, x);
        EXPECT_NEAR(out[0], vr + r * ir - x * ii, 1e-13)
            << e->name << ": the emf does not give the terminal voltage back";
        EXPECT_NEAR(out[1], vi + r * ii + x * ir, 1e-13) << e->name;
      }
}

template <class P>
void batch_equals_double(const Effect& e, std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  MachineCase<P> pack;
  std::vector<MachineCase<double>> each;
  for (int l = 0; l < P::lanes; ++l) {
    auto k = at_steady<double>(e, draw(e, random), Conventions::psse(), 1.0 + 0.1 * u(random),
                               0.3 * u(random), 0.8, 0.4 * u(random));
    for (std::size_t i = 0; i < k.x.size(); ++i) k.x[i] += (i == 1 ? 0.01 : 0.3) * u(random);
    each.push_back(k);
  }
  const auto gather = [&](auto member, std::vector<P>& to) {
    to.assign((each[0].*member).size(), P(0.0));
    for (int l = 0; l < P::lanes; ++l)
      for (std::size_t i = 0; i < to.size(); ++i)
        to[i].set(l, (each[static_cast<std::size_t>(l)].*member)[i]);
  };
  gather(&MachineCase<double>::c, pack.c);
  gather(&MachineCase<double>::x, pack.x);
  gather(&MachineCase<double>::m, pack.m);
  for (int l = 0; l < P::lanes; ++l) {
    const auto& s = each[static_cast<std::size_t>(l)].s;
    pack.s.Vr.set(l, s.Vr);
    pack.s.Vi.set(l, s.Vi);
    pack.s.Ir.set(l, s.Ir);
    pack.s.Ii.set(l, s.Ii);
    pack.s.Efd.set(l, s.Efd);
    pack.s.Tm.set(l, s.Tm);
  }
  const auto together = pack.outputs(e);
  for (int l = 0; l < P::lanes; ++l) {
    const auto alone = each[static_cast<std::size_t>(l)].outputs(e);
    for (std::size_t i = 0; i < alone.size(); ++i)  // a few ulp: packs have their own sincos
      EXPECT_NEAR(together[i][l], alone[i], 1e-12 * (1.0 + std::fabs(alone[i]))) << e.name << " output " << i;
  }
}

TEST(Conformance, StatesStayConstantWithoutTheirMovers) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int tested = 0;
  for (const auto& e : library::compiled_effects())
    for (std::size_t i = 0; i < e.states.size(); ++i) {
      const auto [first, second] = e.states[i].moved_by;
      if (first < 0) continue;
      ASSERT_TRUE(is_control(e.slot)) << e.name << ": this test knows controls only";
      const auto& ops = e.get<double>();
      std::vector<double> p = e.default_parameters(), x(e.states.size()), dx(x.size());
      std::vector<double> c(static_cast<std::size_t>(e.coefficients));
      Signals<double> s;
      s.Vr = s.V = s.Vc = s.Efd = 1.0;
      s.P = s.Tm = 0.5;
      ops.prepare(p.data(), Conventions::psse(), c.data());
      for (const int mover : {first, second})
        if (mover >= 0) c[static_cast<std::size_t>(mover)] = 0.0;
      ASSERT_EQ(ops.control.steady(nullptr, p.data(), c.data(), s, x.data()), "") << e.name;
      for (std::size_t j = 0; j < x.size(); ++j)
        if (j != i) x[j] += 0.1 * u(random);
      for (double* signal : {&s.Vr, &s.Vi, &s.V, &s.Vc, &s.P, &s.speed, &s.Tm, &s.Vs, &s.Ifd, &s.dVref})
        *signal += 0.1 * u(random);
      ops.control.evaluate(nullptr, c.data(), x.data(), s, dx.data());
      if (ops.control.afterwards) ops.control.afterwards(c.data(), x.data(), s, dx.data());
      EXPECT_EQ(dx[i], 0.0) << e.name << "." << e.states[i].name;
      ++tested;
    }
  EXPECT_GT(tested, 20);
}

TEST(Conformance, LanesEqualDouble) {
  std::mt19937_64 random(2);
  for (const Effect* e : machines())
    for (int trial = 0; trial < 50; ++trial) {
      batch_equals_double<P4>(*e, random);
      batch_equals_double<P8>(*e, random);
    }
}

/// Outputs after prepare and steady at parameters p, with the states shifted from equilibrium by `shift`.
template <class T>
std::vector<T> moved(const Effect& e, const std::vector<T>& p, const std::vector<double>& shift) {
  auto k = at_steady<T>(e, p, Conventions::psse(), 1.02, 0.1, 0.7, -0.2);
  for (std::size_t i = 0; i < k.x.size(); ++i) k.x[i] = k.x[i] + T(shift[i]);
  return k.outputs(e);
}

TEST(Conformance, DualsEqualCentralDifferences) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (const Effect* e : machines())
    for (int trial = 0; trial < 20; ++trial) {
      const auto p = draw(*e, random);
      std::vector<double> shift;
      for (std::size_t i = 0; i < e->states.size(); ++i) shift.push_back((i == 1 ? 0.01 : 0.1) * u(random));
      for (std::size_t j = 0; j < p.size(); ++j) {
        std::vector<D8> dual(p.begin(), p.end());
        dual[j].d.set(0, 1.0);
        const auto exact = moved<D8>(*e, dual, shift);
        const double h = 1e-6 * std::max(1e-2, std::fabs(p[j]));
        auto up = p, down = p;
        up[j] += h;
        down[j] -= h;
        const auto a = moved<double>(*e, up, shift), b = moved<double>(*e, down, shift);
        for (std::size_t i = 0; i < exact.size();
             ++i) {  // the difference quotient's own rounding is ~1e-16/h = 1e-8
          const double quotient = (a[i] - b[i]) / (2 * h);
          EXPECT_NEAR(exact[i].d[0], quotient, 1e-6 * (1.0 + std::fabs(quotient)))
              << e->name << " output " << i << " by " << e->parameters[j].name;
        }
      }
    }
}

TEST(Conformance, InfluenceVanishesAtNullValue) {
  // All parameters at their null values, then slightly away: the outputs may change only by a similar amount.
  for (const Effect* e : machines()) {
    auto null_value = e->default_parameters();
    for (std::size_t i = 0; i < null_value.size(); ++i)
      if (e->parameters[i].null_value == e->parameters[i].null_value)
        null_value[i] = e->parameters[i].null_value;
    const std::vector<double> still(e->states.size(), 0.0);
    const auto base = moved<double>(*e, null_value, still);
    for (const double hair : {1e-5, 1e-7}) {
      auto near = null_value;
      for (std::size_t i = 0; i < near.size(); ++i)
        if (e->parameters[i].null_value == e->parameters[i].null_value)
          near[i] += hair * (1.0 + 0.5 * static_cast<double>(i));
      const auto out = moved<double>(*e, near, still);
      for (std::size_t i = 0; i < out.size(); ++i)
        EXPECT_NEAR(out[i], base[i], 100 * hair) << e->name << " output " << i;
    }
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
