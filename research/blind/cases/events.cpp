// Random events of a blind case: load steps, faults and losses of generators, with switching times between
// the samples.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "research/blind/cases/detail/world.hpp"

namespace swingbank::research::blind::cases {
namespace {

/// Draws a time that is not a sampling time at 30, 60 or 120/s, nor one of the fine simulation of cases.toml.
double off_grid(double low, double high, BlindDraw& draw) {
  constexpr double kFinest = 960.0 * 4,
                   kAway = 0.05;  // smallest distance, as a share of a quarter of the fine step
  for (;;) {
    const double t = draw.uniform(low, high), x = t * kFinest;
    if (std::abs(x - std::round(x)) > kAway) return t;
  }
}

const sim::plant::Plant& target(const BlindWorld& world) {
  return world.plain().plants[static_cast<std::size_t>(world.plant())];
}

BlindEvent draw_load_step(const BlindWorld& world, double start, BlindDraw& draw) {
  const sim::network::Network& network = world.plain().network;
  double total = 0;
  for (const auto& load : network.loads) total += (load.power + load.current + load.admittance).real();
  const sim::network::Load& at = network.loads[draw.below(network.loads.size())];
  const double p = total * draw.uniform(0.02, 0.05) * (draw.coin() ? 1.0 : -1.0);
  BlindEvent event;
  event.event.load_steps.push_back({at.bus, Complex(p, 0.2 * p), start, {}});
  event.switchings = {start};
  event.text =
      fmt::format("load step of {:.1f} MW and {:.1f} Mvar at bus {}, {:.5f} s", p * network.base_mva,
                  0.2 * p * network.base_mva, network.buses[static_cast<std::size_t>(at.bus)].number, start);
  return event;
}

}  // namespace

BlindEvent draw_fault(const BlindWorld& world, BlindDraw& draw) {
  const sim::network::Network& network = world.plain().network;
  int bus = 0;
  do {
    bus = static_cast<int>(draw.below(network.buses.size()));
  } while (
      bus == target(world).bus ||
      network.buses[static_cast<std::size_t>(bus)].is_star());  // V = 0 at the plant: its angle is undefined
  BlindEvent event;
  sim::network::BusFault fault{bus, off_grid(1.5, 2.0, draw), 0.0, {}};
  fault.t_off = fault.t_on + off_grid(0.05, 0.15, draw);
  if (draw.coin()) fault.z = Complex(draw.uniform(0.0, 0.01), draw.uniform(0.005, 0.05));
  event.event.faults.push_back(fault);
  event.switchings = {fault.t_on, fault.t_off};
  event.text = fmt::format("fault at bus {} from {:.5f} to {:.5f} s through {:.4f} + j{:.4f} pu",
                           network.buses[static_cast<std::size_t>(bus)].number, fault.t_on, fault.t_off,
                           fault.z.real(), fault.z.imag());
  return event;
}

BlindEvent draw_frequency_event(const BlindWorld& world, BlindDraw& draw) {
  const sim::grid::Grid& grid = world.plain();
  const double start = off_grid(1.5, 2.0, draw);
  std::vector<std::size_t> small;
  double total = 0;
  for (const sim::plant::Plant& plant : grid.plants) total += plant.generation.real();
  for (std::size_t i = 0; i < grid.plants.size(); ++i) {
    const double p = grid.plants[i].generation.real();
    if (!std::ranges::count(world.recorded(), static_cast<int>(i)) && p > 0.01 * total && p < 0.12 * total)
      small.push_back(i);
  }
  if (!world.controlled() || small.empty() || draw.coin()) return draw_load_step(world, start, draw);
  const sim::plant::Plant& lost = grid.plants[small[draw.below(small.size())]];
  BlindEvent event;
  event.event.generator_trips.push_back({lost.generator, start});
  event.switchings = {start};
  event.text = fmt::format("generator {} with {:.1f} MW lost at {:.5f} s", lost.name,
                           lost.generation.real() * grid.network.base_mva, start);
  return event;
}

}  // namespace swingbank::research::blind::cases
