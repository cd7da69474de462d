#include "mpi/draw/operating_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpi/draw/detail/random.hpp"
#include "sim/grid/operating_point.hpp"
#include "sim/network/connectivity.hpp"

namespace swingbank::mpi::draw {

namespace {

namespace network = sim::network;

/// Largest number of unusable operating points in a row; more indicate an infeasible config. It is also the
/// number of random-number keys per block, which determines the content of datasets: never change it.
constexpr std::uint64_t kMostDraws = 100;
/// Range of plausible bus voltages [pu]. The power flow may have solutions outside of it, but no grid
/// operates there for long.
constexpr double kLowestPlausible = 0.85, kHighestVoltage = 1.15;
constexpr int kLineTries = 1000;  ///< largest number of lines tried for removal

void draw_loads(const OperatingPointConfig& c, double common, Random& random, network::Network& n) {
  for (auto& load : n.loads) {
    if (load.kind == network::LoadKind::shunt) continue;  // switched shunts keep their admittance
    const double s = common * random.uniform(1.0 - c.load_spread, 1.0 + c.load_spread);
    load.power *= s;
    load.current *= s;
    load.admittance *= s;
  }
}

/// Draws dispatch and voltage setpoints. Generators at one bus share the setpoint of the first one.
void draw_generators(const OperatingPointConfig& c, double common, Random& random, network::Network& n) {
  std::vector<double> setpoint(n.buses.size(), 0.0);
  for (auto& g : n.generators) {
    g.p *= common * random.uniform(c.dispatch_low, c.dispatch_high);
    const double v = g.vset + random.uniform(-c.voltage, c.voltage);
    if (!g.in_service) continue;
    double& here = setpoint[static_cast<std::size_t>(g.bus)];
    if (here == 0.0) here = v;
    g.vset = here;
  }
}

/// Takes lines out of service without splitting the grid. Returns false if too few such lines are found.
bool draw_lines(const OperatingPointConfig& c, Random& random, network::Network& n) {
  const auto parts = [&] { return std::ranges::max(network::islands(n)); };
  const int whole = parts();
  auto left = static_cast<std::uint64_t>(c.lines_out_low) +
              random.below(static_cast<std::uint64_t>(c.lines_out_high - c.lines_out_low + 1));
  for (int i = 0; left > 0 && i < kLineTries; ++i) {
    auto& line = n.branches[random.below(n.branches.size())];
    if (line.transformer || !line.in_service) continue;
    line.in_service = false;
    if (parts() == whole)
      --left;
    else
      line.in_service = true;
  }
  return left == 0;
}

/// Draws machine bases: apparent power in the power flow divided by a random loading.
void draw_bases(const OperatingPointConfig& c, Random& random, sim::grid::Grid& grid) {
  for (std::size_t i = 0; i < grid.plants.size(); ++i) {
    const double loading = random.uniform(c.loading_low, c.loading_high);
    const bool oversized = random.uniform() < c.oversized_share;
    const double times = random.uniform(c.oversized_low, c.oversized_high);
    if (!c.draws_bases()) continue;
    const double mva = std::abs(grid.plants[i].generation) * grid.network.base_mva;
    sim::grid::set_machine_base(grid, i, mva / loading * (oversized ? times : 1.0));
  }
}

bool plausible(const sim::grid::Grid& grid, const sim::grid::Grid& own) {
  for (std::size_t i = 0; i < grid.network.buses.size(); ++i) {
    const double v = std::abs(grid.flow.voltage[i]);
    const bool live = grid.network.buses[i].type != network::BusType::isolated;
    if (live && !(v >= kLowestPlausible && v <= kHighestVoltage)) return false;
  }
  for (std::size_t i = 0; i < grid.plants.size(); ++i) {
    const auto& plant = grid.plants[i];
    // No generator may become a motor. The slack generator might, because it balances the power of the other
    // generators.
    if (own.plants[i].generation.real() > 0.0 && plant.generation.real() <= 0.0) return false;
    if (!(plant.mva > 0.0)) return false;
    try {
      sim::plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                  grid.network.base_mva, grid.conventions);
    } catch (const InputError&) {
      return false;
    }
  }
  return true;
}

/// Draws one operating point. If it is unusable, counts the reason and returns null.
std::shared_ptr<const sim::grid::Grid> try_once(const Study& study, std::uint64_t key, Redrawn& redrawn) {
  const OperatingPointConfig& c = *study.config.operating_point;
  Random random(study.config.seed, Stream::operating_point, key);
  network::Network n = study.grid.network;
  const double common = random.uniform(c.loads_low, c.loads_high);
  draw_loads(c, common, random, n);
  draw_generators(c, common, random, n);
  if (!draw_lines(c, random, n)) {
    ++redrawn.implausible;
    return {};
  }
  std::shared_ptr<sim::grid::Grid> grid;
  try {
    grid = std::make_shared<sim::grid::Grid>(sim::grid::at_operating_point(study.grid, std::move(n)));
  } catch (const InputError&) {
    ++redrawn.no_power_flow;
    return {};
  }
  draw_bases(c, random, *grid);
  if (plausible(*grid, study.grid)) return grid;
  ++redrawn.implausible;
  return {};
}

OperatingPoint draw_point(const Study& study, std::uint64_t block) {
  OperatingPoint point;
  for (std::uint64_t i = 0; i < kMostDraws && !point.grid; ++i)
    point.grid = try_once(study, block * kMostDraws + i, point.redrawn);
  if (point.grid) return point;
  throw InputError({fmt::format("no operating point for block {} of draws", block),
                    study.config.file.string(),
                    fmt::format("the power flow did not converge for {} of {} random operating points, and "
                                "{} others were implausible",
                                point.redrawn.no_power_flow, kMostDraws, point.redrawn.implausible),
                    "narrow loads, dispatch, voltage or lines_out of [operating_point]"});
}

}  // namespace

const OperatingPoint& OperatingPoints::at(std::uint64_t block) {
  if (!latest_ || block_ != block) {
    latest_ = draw_point(study_, block);
    block_ = block;
  }
  return *latest_;
}

}  // namespace swingbank::mpi::draw
