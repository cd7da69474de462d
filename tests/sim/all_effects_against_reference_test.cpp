// The lanes kernel against IDA on random events drawn over every registered effect: each grid dresses the
// machines of IEEE 39 in random machine models, controls, drives and loads; each event is a fault, a line or
// generator trip, a load step or a setpoint step. A new effect joins by existing.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "reference_support.hpp"
#include "sim/solve/batch.hpp"
#include "sim/solve/load_choice.hpp"
#include "sim/solve/load_equations.hpp"

namespace swingbank::sim {
namespace {

constexpr double kLimit = 1e-4;       ///< of max(1 pu, the channel's swing): the issue's
constexpr double kNearSwitch = 2e-3;  ///< samples this close to a switching are left out [s]
constexpr int kEventsPerGrid = 10;

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  std::size_t index(std::size_t n) { return random_() % n; }
  bool chance(double p) { return uniform(0, 1) < p; }

 private:
  std::mt19937_64 random_;
};

std::vector<const Effect*> effects_in(Slot slot) {
  std::vector<const Effect*> list;
  for (const Effect* e : every_effect())
    if (e->slot == slot) list.push_back(e);
  return list;
}

/// Standard values within 5 %; nothing if the slot is empty.
Block draw(Slot slot, Draws& draws) {
  const auto list = effects_in(slot);
  if (list.empty()) return {};
  const Effect& e = *list[draws.index(list.size())];
  for (int attempt = 0; attempt < 100; ++attempt) {
    Block block{&e, e.standard_parameters()};
    for (std::size_t i = 0; i < block.p.size(); ++i)
      if (!e.parameters[i].is_code()) block.p[i] *= draws.uniform(0.95, 1.05);
    Problems problems;
    e.check(e.law.get(), block.p.data(), "draw", problems);
    if (problems.empty() && e.unphysical(block.p.data()).empty()) return block;
  }
  ADD_FAILURE() << e.name << " refuses its standard values";
  return {};
}

void dress(Plant& plant, Draws& draws) {
  if (draws.chance(0.6)) {
    const auto mine = plant.machine;
    plant.machine = draw(Slot::machine, draws);
    if (plant.machine.effect->name == "GENCLS") plant.machine = mine;  // a grid of them is another test
  }
  plant.controls.clear();
  const auto add = [&](Slot slot, double chance) {
    if (!draws.chance(chance)) return;
    Block block = draw(slot, draws);
    if (block.effect) plant.controls.push_back(std::move(block));
  };
  add(Slot::compensator, 0.2);
  add(Slot::setpoint, 0.2);
  add(Slot::governor, 0.8);
  add(Slot::shaft, 0.2);
  add(Slot::stabiliser, 0.4);
  add(Slot::limiter, 0.3);
  add(Slot::exciter, 0.9);
  const bool linear = plant.machine.effect->get<double>().machine.current == nullptr;
  if (linear && draws.chance(0.2)) plant.transformer = draw(Slot::transformer, draws);
}

bool holds(const Plant& plant, const Grid& grid) {
  try {
    (void)operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                          grid.network.base_mva, grid.conventions);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Every load effect at some of the loads, where it can be held.
void dress_loads(Grid& grid, Draws& draws) {
  for (std::size_t i = 0; i < grid.network.loads.size(); ++i) {
    if (!draws.chance(0.2)) continue;
    Grid next = grid;
    Problems problems;
    set_load(next, static_cast<int>(i), draw(Slot::load, draws), "draw", problems);
    if (!problems.empty()) continue;  // a load that draws nothing
    const Consumer& load = *std::ranges::find(next.loads, static_cast<int>(i), &Consumer::load);
    try {
      (void)load_operating_point(load, load.block.p, next.flow.voltage[static_cast<std::size_t>(load.bus)],
                                 next.network.base_mva, next.conventions);
      grid = std::move(next);
    } catch (const InputError&) {
    }
  }
}

Grid dressed(const Grid& plain, Draws& draws, Draws& of_loads) {
  Grid grid = plain;
  for (Plant& plant : grid.plants)
    for (int attempt = 0; attempt < 20; ++attempt) {
      Plant next = plant;
      dress(next, draws);
      if (!holds(next, grid)) continue;  // a limit does not admit this dispatch
      plant = std::move(next);
      break;
    }
  Problems problems;
  if (draws.chance(0.3)) loads_as_composed(grid, problems);
  EXPECT_TRUE(problems.empty());
  if (of_loads.chance(0.5)) dress_loads(grid, of_loads);
  return grid;
}

Event event_on(const Grid& grid, Draws& draws) {
  Event event;
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

struct Tally {
  int compared = 0, unstable = 0, refused = 0, near_critical = 0;
  double worst = 0.0;
  std::map<std::string, int> missed;
  std::set<std::string_view> seen;
};

std::string outfit(const Grid& grid) {
  std::string text;
  for (const Plant& p : grid.plants) {
    text += p.name + ":" + std::string(p.machine.effect->name) + (p.transformer.effect ? "+T" : "");
    for (const Block& b : p.controls) text += "+" + std::string(b.effect->name);
    text += " ";
  }
  for (const Consumer& c : grid.loads) text += c.name + ":" + std::string(c.block.effect->name) + " ";
  return text;
}

/// Worst difference over all channels, in units of max(1, swing), away from the switchings.
double difference(const Grid& grid, const Event& event, const Trajectory& a, const Trajectory& b,
                  std::string& where) {
  std::vector<double> instants;
  std::vector<double> jumps;
  for (const Plant& p : grid.plants)
    for (const double t : instants_of(p)) jumps.push_back(t);
  for (const Segment& s : segments(event, grid.network, jumps)) instants.push_back(s.start);
  double worst = 0.0;
  for (int row = 0; row < a.rows(); ++row) {
    const auto [low, high] = std::minmax_element(b.row(row), b.row(row) + b.samples);
    const double unit = std::max(1.0, *high - *low);
    for (int k = 0; k < a.samples; ++k) {
      const double t = k / a.rate;
      if (std::ranges::any_of(instants, [&](double i) { return std::abs(t - i) < kNearSwitch; })) continue;
      const double error = std::abs(a.row(row)[k] - b.row(row)[k]) / unit;
      if (error <= worst) continue;
      worst = error;
      const auto channels = static_cast<int>(a.channels.size());
      where = grid.plants[static_cast<std::size_t>(row / channels)].name + "." +
              std::string(
                  kChannels[static_cast<std::size_t>(a.channels[static_cast<std::size_t>(row % channels)])]
                      .name) +
              " at " + std::to_string(t) + " s";
    }
  }
  return worst;
}

/// Whether a fault 2 % longer would not be survived.
bool is_near_critical(const Grid& grid, Event event, BatchOptions options) {
  if (event.faults.empty()) return false;
  auto& f = event.faults[0];
  f.t_off = f.t_on + 1.02 * (f.t_off - f.t_on);
  Batch batch(grid, options);
  bool given = false, lost = false;
  batch.run([&](Job& job) { return !std::exchange(given, true) && (job.event = event, true); },
            [&](const Job&, const Trajectory& t) { lost = t.outcome != Outcome::stable; });
  return lost;
}

void compare(const Grid& grid, Draws& draws, Tally& tally) {
  ReferenceOptions exact;
  exact.t_end = 6.0;
  exact.rate = 60.0;
  std::vector<Job> jobs;
  std::map<std::uint64_t, ReferenceRun> expected;
  for (std::uint64_t id = 0; id < kEventsPerGrid; ++id) {
    Job job;
    job.id = id;
    job.event = event_on(grid, draws);
    try {
      ReferenceRun run = run_reference(grid, job.event, exact);
      if (run.outcome != Outcome::stable) {
        ++tally.unstable;
        continue;
      }
      expected.emplace(id, std::move(run));
      jobs.push_back(std::move(job));
    } catch (const InputError&) {
      ++tally.refused;  // a trip that islands a bus
    }
  }
  BatchOptions options;
  options.t_end = exact.t_end;
  options.rate = exact.rate;
  Batch batch(grid, options);
  std::size_t next = 0;
  batch.run([&](Job& job) { return next < jobs.size() && (job = jobs[next++], true); },
            [&](const Job& job, const Trajectory& run) {
              std::string where;
              const ReferenceRun& reference = expected.at(job.id);
              const double error =
                  run.outcome == Outcome::stable ? difference(grid, job.event, run, reference, where) : 1.0;
              if (error > kLimit && is_near_critical(grid, job.event, options)) {
                ++tally.near_critical;
                return;
              }
              ++tally.compared;
              tally.worst = std::max(tally.worst, error);
              if (error > kLimit)
                ++tally.missed[where + " off by " + std::to_string(error) + " (" +
                               std::string(outcome_name(run.outcome)) + ") in " + outfit(grid)];
            });
}

void run_events(int grids, std::uint64_t seed) {
  const Grid plain = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  Draws draws(seed), of_loads(seed + 1);
  Tally tally;
  for (int g = 0; g < grids; ++g) {
    const Grid grid = dressed(plain, draws, of_loads);
    for (const Plant& p : grid.plants) {
      tally.seen.insert(p.machine.effect->name);
      for (const Block& b : p.controls) tally.seen.insert(b.effect->name);
    }
    for (const Consumer& c : grid.loads) tally.seen.insert(c.block.effect->name);
    compare(grid, draws, tally);
  }
  testing::Test::RecordProperty("compared", tally.compared);
  testing::Test::RecordProperty("unstable", tally.unstable);
  testing::Test::RecordProperty("refused", tally.refused);
  testing::Test::RecordProperty("near_critical", tally.near_critical);
  testing::Test::RecordProperty("worst", testing::PrintToString(tally.worst));
  testing::Test::RecordProperty("effects_seen", static_cast<int>(tally.seen.size()));
  EXPECT_GT(tally.compared, grids * kEventsPerGrid / 3);  // else the draws say little
  for (const auto& [what, count] : tally.missed) ADD_FAILURE() << what;
}

TEST(AllEffectsAgainstReference, FiftyRandomEvents) { run_events(5, 20211); }
TEST(AllEffectsAgainstReferenceFull, ThousandRandomEvents) { run_events(100, 20212); }

}  // namespace
}  // namespace swingbank::sim
