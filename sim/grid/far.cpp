#include "sim/grid/far.hpp"

#include <fmt/format.h>

#include <charconv>

#include "sim/grid/detail/dyr_models.hpp"
#include "sim/network/admittance.hpp"

namespace swingbank::sim::grid {
namespace {

/// Whether a circuit id of the network (text) equals a control's parameter (number).
bool is_circuit(const std::string& name, int number) {
  int value = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), value);
  return error == std::errc() && end == name.data() + name.size() && value == number;
}

/// Returns the branch in service between two buses with this circuit id. If no id matches, returns the only
/// branch between the buses, or -1 if there are none or several.
int branch_between(const network::Network& n, int from, int to, int circuit) {
  int only = -1, count = 0;
  for (std::size_t i = 0; i < n.branches.size(); ++i) {
    const network::Branch& b = n.branches[i];
    if (!b.in_service || !((b.from == from && b.to == to) || (b.from == to && b.to == from))) continue;
    if (is_circuit(b.circuit, circuit)) return static_cast<int>(i);
    only = static_cast<int>(i);
    ++count;
  }
  return count == 1 ? only : -1;
}

/// Returns the bus and branch that a control of `plant` measures.
plant::FarPlace place_of(const network::Network& network, const plant::Plant& plant,
                         const plant::Block& block, std::vector<NotThere>& missing) {
  plant::FarPlace place;
  const Elsewhere& at = block.effect->elsewhere;
  const auto none = [&](std::string what) {
    missing.push_back({std::string(block.effect->name), std::move(what)});
  };
  if (const int bus = number_in(block, at.bus); bus != 0) {
    place.bus = network.bus_index(bus);
    if (place.bus >= 0 &&
        network.buses[static_cast<std::size_t>(place.bus)].type == network::BusType::isolated)
      place.bus = -1;
    if (place.bus < 0) none(fmt::format("bus {}", bus));
    if (place.bus == plant.bus) place.bus = -1;
  }
  const int from = number_in(block, at.from), to = number_in(block, at.to),
            circuit = number_in(block, at.circuit);
  if (from == 0 && to == 0) return place;
  const int first = network.bus_index(from), second = network.bus_index(to);
  if (first >= 0 && second >= 0) place.branch = branch_between(network, first, second, circuit);
  if (place.branch < 0)
    none(fmt::format("branch {} - {}, circuit {}", from, to, circuit));
  else
    place.at_from = network.branches[static_cast<std::size_t>(place.branch)].from == first;
  return place;
}

/// Returns the remote measurements at the operating point, on the plant's base [pu]; none without a remote
/// place.
std::optional<Far<double>> measured(const Grid& grid, const plant::Plant& plant) {
  const auto& [bus, branch, at_from] = plant.far_place;
  if (bus < 0 && branch < 0) return {};
  const auto volts = [&](int index) { return grid.flow.voltage[static_cast<std::size_t>(index)]; };
  const double per_unit = grid.network.base_mva / plant.mva;
  const Complex own = volts(plant.bus), V = volts(bus < 0 ? plant.bus : bus);
  Complex S = plant.generation * per_unit, I = std::conj(S / own);
  if (branch >= 0) {
    const network::Branch& b = grid.network.branches[static_cast<std::size_t>(branch)];
    const network::BranchEnd end = network::branch_end(b, at_from);
    const Complex near = volts(at_from ? b.from : b.to), other = volts(at_from ? b.to : b.from);
    I = (end.own * near + end.other * other) * per_unit;
    S = near * std::conj(I);
  }
  return Far<double>{V.real(), V.imag(), I.real(), I.imag(), S.real(), S.imag()};
}

}  // namespace

std::vector<NotThere> look_far(const Grid& grid, plant::Plant& plant) {
  std::vector<NotThere> missing;
  plant.far_place = {};
  for (const plant::Block& block : plant.controls)
    if (block.effect->elsewhere.bus >= 0) plant.far_place = place_of(grid.network, plant, block, missing);
  plant.far = measured(grid, plant);
  return missing;
}

void look_far(Grid& grid) {
  for (plant::Plant& plant : grid.plants)
    for (const NotThere& missing : look_far(grid, plant))
      grid.network.remark(
          "controls whose remote bus or branch does not exist or is not in service measure at their plant",
          fmt::format("{} of generator {}: {}", missing.control, plant.name, missing.what));
}

void measure_far(Grid& grid) {
  for (plant::Plant& plant : grid.plants) plant.far = measured(grid, plant);
}

}  // namespace swingbank::sim::grid
