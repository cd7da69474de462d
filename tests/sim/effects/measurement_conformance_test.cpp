// Runs over every registered measurement, including later ones.
#include <cstring>

#include "sim/library/library.hpp"
#include "tests/sim/effects/measurement_bench.hpp"

namespace swingbank::sim::effects {
namespace {

using test::measured;
using test::swing;

std::vector<const Effect*> instruments() {
  std::vector<const Effect*> list;
  for (const Effect* e : library::compiled().all())
    if (e->slot == Slot::measurement) list.push_back(e);
  return list;
}

std::vector<double> null_value(const Effect& e) {
  auto p = e.default_parameters();
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!std::isnan(e.parameters[i].null_value)) p[i] = e.parameters[i].null_value;
  return p;
}

/// Parameters at which the instrument has an effect: a fiftieth of the range away from the null value towards
/// the highest value.
std::vector<double> busy(const Effect& e) {
  auto p = null_value(e);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!std::isnan(e.parameters[i].null_value))
      p[i] += 0.02 * (e.parameters[i].high - e.parameters[i].null_value);
  return p;
}

/// busy() with every choice ("code") at its lowest and highest value that check() accepts.
std::vector<std::vector<double>> variants(const Effect& e) {
  std::vector<std::vector<double>> list{busy(e)}, allowed;
  for (std::size_t i = 0; i < e.parameters.size(); ++i) {
    if (!e.parameters[i].is_code()) continue;
    const auto before = list;
    for (auto p : before) {
      p[i] = e.parameters[i].low;
      list.push_back(p);
      p[i] = e.parameters[i].high;
      list.push_back(p);
    }
  }
  for (const auto& p : list) {
    Problems problems;
    e.check(nullptr, p.data(), "test", problems);
    if (problems.empty()) allowed.push_back(p);
  }
  EXPECT_FALSE(allowed.empty()) << e.name;
  return allowed;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
bool same_bits(const Phasors& a, const Phasors& b) {
  return same_bits(a.V, b.V) && same_bits(a.I, b.I) && same_bits(a.df, b.df);
}

bool is_random(const Effect& e) {
  const auto p = busy(e);
  return !same_bits(measured(e, p, swing(120.0), 1), measured(e, p, swing(120.0), 2));
}

/// Largest difference between two samples, of V, I [pu] and df [pu of the system frequency].
double distance(const Phasors& a, const Phasors& b, std::size_t k, std::size_t l) {
  return std::max({std::abs(a.V[k] - b.V[l]), std::abs(a.I[k] - b.I[l]), std::fabs(a.df[k] - b.df[l])});
}

TEST(MeasurementConformance, VanishesAtNullValue) {
  ASSERT_FALSE(instruments().empty());
  for (const Effect* e : instruments()) {
    ASSERT_NE(e->measure, nullptr) << e->name;
    const auto p = null_value(*e);
    EXPECT_TRUE(same_bits(measured(*e, p, swing(120.0)), swing(120.0))) << e->name;
    EXPECT_EQ(e->memory ? e->memory(p.data()) : 0.0, 0.0) << e->name;
  }
}

TEST(MeasurementConformance, EachParameterWithANullValueActs) {
  for (const Effect* e : instruments()) {
    int acting = 0;
    for (std::size_t i = 0; i < e->parameters.size(); ++i) {
      const Parameter& r = e->parameters[i];
      if (std::isnan(r.null_value)) continue;
      ++acting;
      auto p = null_value(*e);
      p[i] += 0.02 * (r.high - r.null_value);
      EXPECT_FALSE(same_bits(measured(*e, p, swing(120.0)), swing(120.0))) << e->name << "." << r.name;
    }
    EXPECT_GT(acting, 0) << e->name << ": no parameter has a null value";
  }
}

TEST(MeasurementConformance, SameSeedGivesSameResult) {
  for (const Effect* e : instruments()) {
    const auto p = busy(*e);
    const Phasors first = measured(*e, p, swing(120.0), 7);
    EXPECT_TRUE(same_bits(first, measured(*e, p, swing(120.0), 7))) << e->name;
    EXPECT_EQ(first.V.size(), swing(120.0).V.size()) << e->name;
    EXPECT_EQ(first.I.size(), first.V.size()) << e->name;
    EXPECT_EQ(first.df.size(), first.V.size()) << e->name;
  }
}

TEST(MeasurementConformance, ResultDoesNotDependOnTheRate) {
  for (const Effect* e : instruments()) {
    if (is_random(*e)) continue;
    for (const auto& p : variants(*e)) {
      const Phasors once = measured(*e, p, swing(120.0)), twice = measured(*e, p, swing(240.0));
      const double reach = e->memory ? e->memory(p.data()) : 0.0;
      const auto edge = static_cast<std::size_t>(reach * 120.0) + 3;
      // Interpolation between samples of a 1.3 Hz swing at 120/s: 0.016 (2 pi 1.3 / 120)^3 = 5e-6.
      for (std::size_t k = edge; k + edge < once.V.size(); ++k)
        ASSERT_LT(distance(once, twice, k, 2 * k), 2e-5) << e->name << " sample " << k;
    }
  }
}

TEST(MeasurementConformance, RespectsItsStatedMemory) {
  for (const Effect* e : instruments()) {
    if (is_random(*e)) continue;
    for (const auto& p : variants(*e)) {
      const double rate = 240.0;
      Phasors moved = swing(rate);
      const std::size_t at = moved.V.size() / 2;
      moved.V[at] += 0.1;
      moved.I[at] += 0.1;
      moved.df[at] += 0.001;
      const Phasors a = measured(*e, p, swing(rate)), b = measured(*e, p, moved);
      const double reach = e->memory ? e->memory(p.data()) : 0.0;
      const double samples = reach * rate + (reach > 0 ? 3.0 : 0.0);  // interpolation uses two more
      for (std::size_t k = 0; k < a.V.size(); ++k) {
        if (std::fabs(static_cast<double>(k) - static_cast<double>(at)) <= samples) continue;
        ASSERT_LT(distance(a, b, k, k), 1e-14) << e->name << " sample " << k << ", moved at " << at;
      }
    }
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
