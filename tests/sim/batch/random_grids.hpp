#pragma once
// Random grids and events over every registered effect: random machine models, controls, disturbances and
// loads, with faults, trips and steps. New effects are included automatically.
#include <algorithm>
#include <random>
#include <set>

#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::test {

/// Uniform draws, the same on every platform (std::uniform_real_distribution is not).
class Draws {
 public:
  explicit Draws(std::uint64_t seed, std::set<std::string_view> without = {})
      : without_(std::move(without)), random_(seed) {}
  /// Whether an effect may be drawn. Without it, the draws equal those made before the effect existed.
  [[nodiscard]] bool knows(const Effect& e) const { return !without_.contains(e.name); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  std::size_t index(std::size_t n) { return random_() % n; }
  bool chance(double p) { return uniform(0, 1) < p; }

 private:
  std::set<std::string_view> without_;
  std::mt19937_64 random_;
};

inline std::vector<const Effect*> effects_in(Slot slot, const Draws& draws) {
  std::vector<const Effect*> list;
  for (const Effect* e : library::compiled().all())
    if (e->slot == slot && !e->converter && draws.knows(*e)) list.push_back(e);
  return list;
}

/// Values within 10 % of the defaults. With a probability of 15 %, a default of zero becomes a value within
/// 0.2 % of the range, and a code changes, so that every branch of the equations occurs.
inline double draw_value(const Parameter& record, double standard, Draws& draws) {
  const bool moved = draws.chance(0.15);
  if (record.is_code()) return moved ? std::floor(draws.uniform(record.low, record.high + 1.0)) : standard;
  if (standard != 0.0) return standard * draws.uniform(0.9, 1.1);
  return moved ? draws.uniform(0.002 * record.low, 0.002 * record.high) : 0.0;
}

/// One effect of a slot with values that it accepts and that are physical.
inline plant::Block draw_block(Slot slot, Draws& draws) {
  const auto list = effects_in(slot, draws);
  if (list.empty()) return {};
  const Effect& e = *list[draws.index(list.size())];
  constexpr int attempts = 3000;  // values are independent; required orderings occur by chance
  for (int attempt = 0; attempt < attempts; ++attempt) {
    plant::Block block{&e, e.default_parameters()};
    for (std::size_t i = 0; i < block.p.size(); ++i)
      block.p[i] = draw_value(e.parameters[i], block.p[i], draws);
    Problems problems;
    e.check(e.user_model.get(), block.p.data(), "draw", problems);
    if (problems.empty() && e.unphysical(block.p.data()).empty()) return block;
  }
  ADD_FAILURE() << e.name << " refuses values around its defaults";
  return {};
}

inline void dress(plant::Plant& plant, Draws& draws) {
  if (draws.chance(0.6)) plant.machine = draw_block(Slot::machine, draws);
  plant.controls.clear();
  const auto add = [&](Slot slot, double chance) {
    if (!draws.chance(chance)) return;
    plant::Block block = draw_block(slot, draws);
    if (block.effect) plant.controls.push_back(std::move(block));
  };
  add(Slot::compensator, 0.2);
  add(Slot::setpoint, 0.2);
  add(Slot::governor, 0.8);
  add(Slot::shaft, 0.2);
  add(Slot::stabiliser, 0.4);
  add(Slot::limiter, 0.3);
  add(Slot::exciter, 0.9);
  if (draws.chance(0.2)) plant.transformer = draw_block(Slot::transformer, draws);
}

inline bool has_operating_point(const plant::Plant& plant, const grid::Grid& grid) {
  try {
    (void)plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                 grid.network.base_mva, grid.conventions);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Gives some of the loads a random load effect, if the operating point is feasible.
inline void dress_loads(grid::Grid& grid, Draws& draws) {
  for (std::size_t i = 0; i < grid.network.loads.size(); ++i) {
    if (!draws.chance(0.2)) continue;
    grid::Grid next = grid;
    Problems problems;
    grid::set_load(next, static_cast<int>(i), draw_block(Slot::load, draws), "draw", problems);
    if (!problems.empty()) continue;  // a load without power
    const plant::Consumer& load = *std::ranges::find(next.loads, static_cast<int>(i), &plant::Consumer::load);
    try {
      (void)plant::load_operating_point(load, load.block.p,
                                        next.flow.voltage[static_cast<std::size_t>(load.bus)],
                                        next.network.base_mva, next.conventions);
      grid = std::move(next);
    } catch (const InputError&) {
    }
  }
}

inline grid::Grid dressed(const grid::Grid& plain, Draws& draws) {
  grid::Grid grid = plain;
  for (plant::Plant& plant : grid.plants)
    for (int attempt = 0; attempt < 20; ++attempt) {
      plant::Plant next = plant;
      dress(next, draws);
      if (!has_operating_point(next, grid)) continue;  // a limit does not admit this dispatch
      plant = std::move(next);
      break;
    }
  Problems problems;
  if (draws.chance(0.3)) grid::loads_as_composed(grid, problems);
  EXPECT_TRUE(problems.empty());
  if (draws.chance(0.5)) dress_loads(grid, draws);
  return grid;
}

/// A bolted fault (twice as often as the others), a line or a generator trip, or steps of load and set
/// points.
inline network::Event draw_event(const grid::Grid& grid, Draws& draws) {
  network::Event event;
  const auto generator = [&] { return grid.plants[draws.index(grid.plants.size())].generator; };
  const auto bus = [&] { return static_cast<int>(draws.index(grid.network.buses.size())); };
  switch (draws.index(5)) {
    case 0:
    case 1:
      event.faults = {{bus(), 1.0, 1.0 + draws.uniform(0.03, 0.12), {}}};
      break;
    case 2:
      event.trips = {{static_cast<int>(draws.index(grid.network.branches.size())), 1.0, {}}};
      break;
    case 3:
      event.generator_trips = {{generator(), 1.0}};
      break;
    default:
      event.load_steps = {{bus(), {draws.uniform(-1, 1), draws.uniform(-0.3, 0.3)}, 1.0, 2.0}};
      event.setpoint_steps = {{generator(), 1.5, draws.uniform(-0.02, 0.02), draws.uniform(-0.02, 0.02)}};
  }
  return event;
}

/// "30:GENROU+SEXS 31:GENSAL+T+HYGOV 8:ZIP", for messages.
inline std::string outfit(const grid::Grid& grid) {
  std::string text;
  for (const plant::Plant& p : grid.plants) {
    text += p.name + ":" + std::string(p.machine.effect->name) + (p.transformer.effect ? "+T" : "");
    for (const plant::Block& b : p.controls) text += "+" + std::string(b.effect->name);
    text += " ";
  }
  for (const plant::Consumer& c : grid.loads) text += c.name + ":" + std::string(c.block.effect->name) + " ";
  return text;
}

/// Names of all effects in a grid.
inline void add_effects(const grid::Grid& grid, std::set<std::string_view>& seen) {
  for (const plant::Plant& p : grid.plants) {
    seen.insert(p.machine.effect->name);
    if (p.transformer.effect) seen.insert(p.transformer.effect->name);
    for (const plant::Block& b : p.controls) seen.insert(b.effect->name);
  }
  for (const plant::Consumer& c : grid.loads) seen.insert(c.block.effect->name);
}

struct Difference {
  double value = 0.0;  ///< in units of max(1 pu, the channel's swing)
  std::string where;
};

/// Largest difference over all channels, except near switching times. Differences of Efd are weighted by
/// `efd`.
inline Difference difference(const grid::Grid& grid, const network::Event& event, const Trajectory& a,
                             const Trajectory& b, double efd = 1.0) {
  constexpr double near = 2e-3;  // samples this close to a switching time are excluded [s]
  std::vector<double> switching_times, discontinuities;
  for (const plant::Plant& p : grid.plants)
    for (const double t : plant::switching_times_of(p)) discontinuities.push_back(t);
  for (const network::Segment& s : network::segments(event, grid.network, discontinuities))
    switching_times.push_back(s.start);
  Difference worst;
  const auto channels = static_cast<int>(a.channels.size());
  for (int row = 0; row < a.rows(); ++row) {
    const auto [low, high] = std::minmax_element(b.row(row), b.row(row) + b.samples);
    const auto channel = a.channels[static_cast<std::size_t>(row % channels)];
    const double unit = std::max(1.0, *high - *low) / (channel == Channel::Efd ? efd : 1.0);
    for (int k = 0; k < a.samples; ++k) {
      const double t = k / a.rate, error = std::abs(a.row(row)[k] - b.row(row)[k]) / unit;
      if (error <= worst.value) continue;
      if (std::ranges::any_of(switching_times, [&](double i) { return std::abs(t - i) < near; })) continue;
      worst.value = error;
      worst.where = grid.plants[static_cast<std::size_t>(row / channels)].name + "." +
                    std::string(kChannels[static_cast<std::size_t>(channel)].name) + " at " +
                    std::to_string(t) + " s";
    }
  }
  return worst;
}

}  // namespace swingbank::sim::test
