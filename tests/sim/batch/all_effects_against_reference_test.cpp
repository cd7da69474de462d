// The SIMD kernel against IDA, and IDA against itself, on random grids and events that use every registered
// effect (random_grids.hpp).
#include <cstdlib>
#include <map>

#include "sim/batch/batch.hpp"
#include "sim/core/float_pack.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/batch/random_grids.hpp"

namespace swingbank::sim::batch {
namespace {

using test::Difference;
using test::Draws;

constexpr double kLimit = 1e-4;  ///< required limit, relative to max(1 pu, the channel's swing)
/// Weight of Efd differences in float: the limit for Efd is then 1e-3, because an exciter amplifies the
/// rounding of the voltage by its gain (REXS: 2,800).
constexpr double kEfdInFloat = 0.1;
constexpr int kEventsPerGrid = 10;

reference::ReferenceOptions exact() {
  reference::ReferenceOptions options;
  options.t_end = 6.0;
  options.rate = 60.0;
  return options;
}

struct Tally {
  int compared = 0, unstable = 0, refused = 0, grids_that_fall = 0;
  double worst = 0.0;
  std::string worst_where;
  std::map<std::string, int> missed, near_critical;
  std::set<std::string_view> seen;

  void add(const Difference& d) {
    ++compared;
    if (d.value <= worst) return;
    worst = d.value;
    worst_where = d.where;
  }
  void record() const {
    testing::Test::RecordProperty("compared", compared);
    testing::Test::RecordProperty("unstable", unstable);
    testing::Test::RecordProperty("refused", refused);
    testing::Test::RecordProperty("near_critical", static_cast<int>(near_critical.size()));
    testing::Test::RecordProperty("worst", testing::PrintToString(worst) + " " + worst_where);
    testing::Test::RecordProperty("effects_seen", static_cast<int>(seen.size()));
    for (const auto& [what, count] : near_critical) std::cout << "near critical: " << what << "\n";
    testing::Test::RecordProperty("grids_that_fall", grids_that_fall);
    std::cout << compared << " compared, " << unstable << " unstable, " << refused << " refused, "
              << grids_that_fall << " grids unstable without an event, " << near_critical.size()
              << " near critical, " << seen.size() << " effects; worst " << worst << " " << worst_where
              << "\n";
  }
};

/// Returns whether a fault 2 % longer leads to instability.
bool is_near_critical(const grid::Grid& grid, network::Event event, BatchOptions options) {
  if (event.faults.empty()) return false;
  auto& f = event.faults[0];
  f.t_off = f.t_on + 1.02 * (f.t_off - f.t_on);
  Batch batch(grid, options);
  bool given = false, lost = false;
  batch.run([&](Job& job) { return !std::exchange(given, true) && (job.event = event, true); },
            [&](const Job&, const Trajectory& t) { lost = t.outcome != Outcome::stable; });
  return lost;
}

/// Returns whether the operating point is stable: a load step of 1e-4 pu for 0.2 s does not change any Efd by
/// 0.3 pu within `seconds`. Randomly drawn controls may be unstable (a stabiliser with input V: growth rate
/// 30/s), and rounding then determines when the run diverges.
bool is_stable(const grid::Grid& grid, double seconds) {
  BatchOptions options;
  options.t_end = seconds;
  options.rate = 60.0;
  options.channels = {Channel::Efd};
  Batch batch(grid, options);
  network::Event nudge;
  nudge.load_steps = {{0, {1e-4, 0.0}, 0.5, 0.7}};
  std::uint64_t given = 0;
  std::map<std::uint64_t, Trajectory> runs;
  batch.run(
      [&](Job& job) {
        job.id = given;
        job.event = given == 0 ? network::Event{} : nudge;
        return given++ < 2;
      },
      [&](const Job& job, const Trajectory& run) { runs[job.id] = run; });
  if (runs[0].outcome != runs[1].outcome) return false;
  for (std::size_t k = 0; k < runs[0].values.size(); ++k)
    if (std::abs(runs[1].values[k] - runs[0].values[k]) > 0.3) return false;
  return true;
}

/// Returns whether an island is so fast that a rotor advances by half a turn between samples: the reference
/// then unwraps theta wrongly.
bool runs_away(const Trajectory& run) {
  const auto delta = static_cast<int>(Channel::delta);
  for (int plant = 0; plant < static_cast<int>(run.plants.size()); ++plant)
    for (int k = 1; k < run.samples; ++k)
      if (std::abs(run.at(plant, delta)[k] - run.at(plant, delta)[k - 1]) > 3.0) return true;
  return false;
}

/// Events that are stable in the reference integrator, with the reference's runs.
std::map<std::uint64_t, std::pair<Job, reference::ReferenceRun>> references(const grid::Grid& grid,
                                                                            Draws& draws, Tally& tally) {
  std::map<std::uint64_t, std::pair<Job, reference::ReferenceRun>> runs;
  for (std::uint64_t id = 0; id < kEventsPerGrid; ++id) {
    Job job;
    job.id = id;
    job.event = test::draw_event(grid, draws);
    try {
      reference::ReferenceRun run = reference::run_reference(grid, job.event, exact());
      if (run.outcome == Outcome::stable && !runs_away(run))
        runs.emplace(id, std::pair(std::move(job), std::move(run)));
      else
        ++tally.unstable;
    } catch (const InputError&) {
      ++tally.refused;  // a trip that islands a bus
    }
  }
  return runs;
}

void compare(const grid::Grid& grid, Draws& draws, Tally& tally, int lanes = 0) {
  const auto runs = references(grid, draws, tally);
  BatchOptions options;
  options.lanes = lanes;
  options.t_end = exact().t_end;
  options.rate = exact().rate;
  Batch batch(grid, options);
  auto next = runs.begin();
  batch.run([&](Job& job) { return next != runs.end() && (job = (next++)->second.first, true); },
            [&](const Job& job, const Trajectory& run) {
              Difference d{1.0, "its end"};
              if (run.outcome == Outcome::stable)
                d = test::difference(grid, job.event, run, runs.at(job.id).second,
                                     lanes == FloatPack::lanes ? kEfdInFloat : 1.0);
              const std::string what = d.where + " off by " + std::to_string(d.value) + " (" +
                                       std::string(outcome_name(run.outcome)) + ") in " + test::outfit(grid);
              if (d.value > kLimit && is_near_critical(grid, job.event, options)) {
                ++tally.near_critical[what];
                return;
              }
              tally.add(d);
              if (d.value > kLimit) ++tally.missed[what];
            });
}

/// All effects used with synchronous machines (converters: converters_test.cpp).
std::set<std::string_view> all_names() {
  std::set<std::string_view> names;
  for (const Effect* e : library::compiled().all())
    if (e->slot != Slot::measurement && !e->converter && !is_of_converter(e->slot)) names.insert(e->name);
  return names;
}

/// Draws a grid's events and discards them, so that later draws stay the same.
void pass_over(const grid::Grid& grid, Draws& draws) {
  for (int i = 0; i < kEventsPerGrid; ++i) test::draw_event(grid, draws);
}

/// Returns the next stable grid, tested over half an event in double and a whole event in float. An
/// instability that grows slowly (PSS2C before ST5B: 2/s) ends in a limit cycle, whose phase depends on
/// rounding.
constexpr double kLookedAt = 3.0, kLookedAtInFloat = 6.0;  // [s]
grid::Grid drawn(const grid::Grid& plain, Draws& draws, Tally& tally, double seconds = kLookedAt) {
  while (true) {
    grid::Grid grid = test::dressed(plain, draws);
    if (is_stable(grid, seconds)) {
      test::add_effects(grid, tally.seen);
      return grid;
    }
    ++tally.grids_that_fall;
    pass_over(grid, draws);
  }
}

/// Draws grids and compares their events until at least `wanted` events were compared.
Tally run_events(int wanted, std::uint64_t seed) {
  const grid::Grid plain = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  Draws draws(seed);
  Tally tally;
  const int most = wanted / kEventsPerGrid * 3;  // otherwise too few draws are comparable
  for (int g = 0; g < most && tally.compared < wanted; ++g) {
    const grid::Grid grid = drawn(plain, draws, tally);
    compare(grid, draws, tally);
  }
  tally.record();
  EXPECT_GE(tally.compared, wanted);
  for (const auto& [what, count] : tally.missed) ADD_FAILURE() << what;
  return tally;
}

/// Compares events in float, on grids of machines whose current is linear in the voltage.
Tally run_in_float(int wanted, std::uint64_t seed) {
  const grid::Grid plain = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  std::set<std::string_view> sought;
  for (const Effect* e : library::compiled().all())
    if (e->slot == Slot::machine && e->get<double>().machine.current != nullptr) sought.insert(e->name);
  Draws draws(seed, sought);
  Tally tally;
  while (tally.compared < wanted) {
    const grid::Grid grid = drawn(plain, draws, tally, kLookedAtInFloat);
    if (grid.loads.empty()) compare(grid, draws, tally, FloatPack::lanes);
  }
  tally.record();
  for (const auto& [what, count] : tally.missed) ADD_FAILURE() << what;
  return tally;
}

TEST(AllEffectsAgainstReferenceFull, FiftyRandomEventsInFloat) { run_in_float(50, 20214); }
TEST(AllEffectsAgainstReferenceNightly, FiveHundredRandomEventsInFloat) { run_in_float(500, 20214); }

TEST(AllEffectsAgainstReference, TwentyRandomEvents) { run_events(20, 20211); }

TEST(AllEffectsAgainstReferenceFull, FortyRandomEvents) { run_events(40, 20212); }

/// SWINGBANK_SEED in the environment draws other events.
TEST(AllEffectsAgainstReferenceNightly, ThousandRandomEvents) {
  const char* seed = std::getenv("SWINGBANK_SEED");
  const Tally tally = run_events(1000, seed ? std::strtoull(seed, nullptr, 10) : 20212);
  EXPECT_EQ(tally.seen, all_names());
}

/// Effects added after 2026-11-23.
const std::set<std::string_view> kLater = {
    "DEGOV",  "DEGOV1",  "DERA1",  "ESAC6A", "ESDC1A", "ESDC2A", "ESST1A", "ESST3A", "EXAC2",
    "EXPIC1", "FVFAULT", "GENQEC", "GENTPF", "HYG3",   "IEEEG2", "IEEEG3", "IEEET2", "IEEET3",
    "IEEEX1", "IEESGO",  "LCFB1",  "MAXEX1", "OEL1",   "PIDGOV", "PSS2C",  "REXS",   "SCRX",
    "ST2CUT", "ST5B",    "STAB2A", "SVSMO1", "TGOV3",  "UEL2",   "WSHYGP", "WSIEG1"};

/// Three grids with events that exceeded the limit before decision 04 was amended on 2026-11-23. They are
/// drawn from the effects that existed that day.
TEST(AllEffectsAgainstReferenceFull, EventsBeyondTheFormerLimit) {
  const grid::Grid plain = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  const std::set<int> missed = {37, 45, 85};
  Draws draws(20261123, kLater);
  Tally tally;
  for (int g = 0; g <= *missed.rbegin(); ++g) {
    const grid::Grid grid = drawn(plain, draws, tally);
    if (missed.contains(g))
      compare(grid, draws, tally);
    else
      pass_over(grid, draws);
  }
  tally.record();
  EXPECT_EQ(tally.compared, 30);
  for (const auto& [what, count] : tally.missed) ADD_FAILURE() << what;
}

/// For one drawn machine with REXS (default gain 2,800), Efd differs by 2.3e-6 of its swing within six
/// seconds. With an error weight of 50 instead of 10 it differs by 4.1e-6. The reason is unknown.
const std::set<std::string_view> kBeyondOwnLimit = {"REXS"};

/// The reference's own error: rtol 1e-8 against 1e-10.
Tally run_references(int wanted, std::uint64_t seed) {
  constexpr double limit = 1e-6;  // required limit, in the same units
  const grid::Grid plain = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  reference::ReferenceOptions finer = exact();
  finer.rtol = 1e-10;
  finer.atol = 1e-12;
  Draws draws(seed, kBeyondOwnLimit);
  Tally tally;
  while (tally.compared < wanted && tally.unstable + tally.refused < wanted) {
    const grid::Grid grid = drawn(plain, draws, tally);
    for (const auto& [id, run] : references(grid, draws, tally)) {
      const reference::ReferenceRun fine = reference::run_reference(grid, run.first.event, finer);
      const Difference d = test::difference(grid, run.first.event, run.second, fine);
      tally.add(d);
      EXPECT_LE(d.value, limit) << d.where << " in " << test::outfit(grid);
    }
  }
  tally.record();
  EXPECT_GE(tally.compared, wanted);
  return tally;
}

TEST(AllEffectsAgainstReferenceFull, ReferenceAgainstItself) { run_references(20, 20213); }
TEST(AllEffectsAgainstReferenceNightly, ReferenceAgainstItself) { run_references(200, 20213); }

}  // namespace
}  // namespace swingbank::sim::batch
