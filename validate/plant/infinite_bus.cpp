#include "validate/plant/infinite_bus.hpp"

#include <cmath>
#include <string>

namespace swingbank::validate::plant {
namespace {

namespace network = sim::network;

/// Returns the plant without the parts that belong to a record: instruments and reference changes.
sim::plant::Plant without_record(sim::plant::Plant plant) {
  plant.measurements.clear();
  std::erase_if(plant.controls, [](const sim::plant::Block& b) {
    return b.effect->slot == sim::Slot::setpoint && b.effect->dyr_name.empty();
  });
  return plant;
}

}  // namespace

sim::grid::Grid infinite_bus_grid(const PlantModel& model, Complex voltage, Complex power,
                                  const InfiniteBusLink& link) {
  sim::grid::Grid grid;
  grid.library = model.library;
  grid.conventions = model.conventions;
  network::Network& net = grid.network;
  net.title = net.origin = model.name;
  net.base_mva = model.plant.mva;
  net.frequency = model.conventions.frequency;
  Complex admittance = 0;
  for (const Complex z : link.lines) {
    network::Branch line{};
    line.from = 0;
    line.to = 1;
    line.circuit = std::to_string(net.branches.size() + 1);
    line.r = z.real();
    line.x = z.imag();
    net.branches.push_back(line);
    admittance += 1.0 / z;
  }
  const Complex current = std::conj(power / voltage), far = voltage - current / admittance;
  const auto bus = [&](int number, const char* name, network::BusType type, Complex v) {
    net.buses.push_back({number, name, 1.0, type, std::abs(v), std::arg(v)});
    grid.flow.voltage.push_back(v);
  };
  bus(1, "PLANT", network::BusType::generator, voltage);
  bus(2, "INFINITE", network::BusType::slack, far);
  const auto generator = [&](int at_bus, Complex s, sim::plant::Plant unit) {
    network::Generator g{};
    g.bus = at_bus;
    g.id = "1";
    g.p = s.real();
    g.q = s.imag();
    g.vset = std::abs(grid.flow.voltage[static_cast<std::size_t>(at_bus)]);
    g.mva = net.base_mva;
    g.in_service = true;
    net.generators.push_back(g);
    grid.flow.generation.push_back(s);
    unit.bus = at_bus;
    unit.generator = at_bus;
    unit.generation = s;
    unit.mva = net.base_mva;
    grid.plants.push_back(std::move(unit));
  };
  generator(0, power, without_record(model.plant));
  grid.plants.front().name = model.name;
  sim::plant::Plant infinite;
  infinite.name = "infinite bus";
  infinite.machine.effect = grid.library.find("GENCLS");
  infinite.machine.p = {0, 0, 0, link.source};
  generator(1, far * std::conj(-current), std::move(infinite));
  return grid;
}

}  // namespace swingbank::validate::plant
