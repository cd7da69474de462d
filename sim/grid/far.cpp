#include "sim/grid/far.hpp"

#include <fmt/format.h>

#include <charconv>

#include "sim/grid/detail/dyr_models.hpp"
#include "sim/network/admittance.hpp"

namespace swingbank::sim::grid {
namespace {

/// A circuit is a word in the network and a number in a control's parameters.
bool is_circuit(const std::string& name, int number) {
  int value = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), value);
  return error == std::errc() && end == name.data() + name.size() && value == number;
}

/// The branch in service between two buses with this circuit, or the only one; -1: none.
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

class FarLooker {
 public:
  explicit FarLooker(Grid& grid) : grid_(grid) {}
  plant::FarPlace place(const plant::Plant& plant, const plant::Block& block) {
    plant::FarPlace place;
    const Elsewhere& at = block.effect->elsewhere;
    if (const int bus = number_in(block, at.bus); bus != 0) {
      place.bus = grid_.network.bus_index(bus);
      if (place.bus < 0) left_out(plant, block, fmt::format("bus {}", bus));
      if (place.bus == plant.bus) place.bus = -1;
    }
    const int from = number_in(block, at.from), to = number_in(block, at.to),
              circuit = number_in(block, at.circuit);
    if (from == 0 && to == 0) return place;
    const int first = grid_.network.bus_index(from), second = grid_.network.bus_index(to);
    if (first >= 0 && second >= 0) place.branch = branch_between(grid_.network, first, second, circuit);
    if (place.branch < 0)
      left_out(plant, block, fmt::format("branch {} - {}, circuit {}", from, to, circuit));
    else
      place.at_from = grid_.network.branches[static_cast<std::size_t>(place.branch)].from == first;
    return place;
  }

 private:
  void left_out(const plant::Plant& plant, const plant::Block& block, const std::string& what) {
    grid_.network.remark(
        "controls that are to measure where the network has nothing in service measure at their plant",
        fmt::format("{} of generator {}: {}", block.effect->name, plant.name, what));
  }
  Grid& grid_;
};

/// At the operating point, on the plant's base; nothing where it measures at the plant alone.
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

void look_far(Grid& grid) {
  FarLooker looker(grid);
  for (plant::Plant& plant : grid.plants) {
    plant.far_place = {};
    for (const plant::Block& block : plant.controls)
      if (block.effect->elsewhere.bus >= 0) plant.far_place = looker.place(plant, block);
  }
  measure_far(grid);
}

void measure_far(Grid& grid) {
  for (plant::Plant& plant : grid.plants) plant.far = measured(grid, plant);
}

}  // namespace swingbank::sim::grid
