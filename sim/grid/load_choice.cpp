#include "sim/grid/load_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/grid/detail/dyr_models.hpp"
#include "sim/network/admittance.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::sim::grid {
namespace {

std::string load_name(const network::Network& network, std::size_t load) {
  const network::Load& l = network.loads[load];
  const auto at_bus = std::ranges::count(network.loads, l.bus, &network::Load::bus);
  return std::to_string(network.buses[static_cast<std::size_t>(l.bus)].number) +
         (at_bus > 1 ? "/" + l.id : "");
}

/// Returns the indices of the loads named by "BUS" or "BUS/ID".
std::vector<int> loads_named(const network::Network& network, const std::string& text,
                             const std::string& where, Problems& problems) {
  const auto slash = text.find('/');
  const std::string number = text.substr(0, slash), id = slash == text.npos ? "" : text.substr(slash + 1);
  std::vector<int> list;
  std::string names;
  for (std::size_t i = 0; i < network.loads.size(); ++i) {
    const network::Load& l = network.loads[i];
    names += (names.empty() ? "" : ", ") + load_name(network, i);
    if (std::to_string(network.buses[static_cast<std::size_t>(l.bus)].number) == number &&
        (slash == text.npos || l.id == id))
      list.push_back(static_cast<int>(i));
  }
  if (list.empty())
    problems.add("no load " + text, where, network.origin + " has loads at " + names,
                 "name one of these, BUS or BUS/ID");
  return list;
}

/// Returns the indices of the loads without a model and with non-zero consumption.
std::vector<int> loads_without_model(const Grid& grid, const std::string& where, Problems& problems) {
  std::vector<int> list;
  for (std::size_t i = 0; i < grid.network.loads.size(); ++i)
    if (!std::ranges::count(grid.loads, static_cast<int>(i), &plant::Consumer::load) &&
        consumption(grid.network.loads[i], grid.flow) != Complex{})
      list.push_back(static_cast<int>(i));
  if (list.empty())
    problems.add("no load without a model", where, "* selects the loads without a model",
                 "name the loads, BUS or BUS/ID, or drop the option");
  return list;
}

/// Returns part/total, and 0 for part = 0.
double fraction(double part, double total) { return part == 0.0 ? 0.0 : part / total; }

}  // namespace

void set_load(Grid& grid, int load, plant::Block block, const std::string& where, Problems& problems) {
  const network::Load& l = grid.network.loads[static_cast<std::size_t>(load)];
  block.effect->check(block.effect->user_model.get(), block.p.data(), where, problems);
  plant::Consumer consumer;
  consumer.name = load_name(grid.network, static_cast<std::size_t>(load));
  consumer.bus = l.bus;
  consumer.load = load;
  consumer.mva = grid.network.base_mva;
  consumer.consumption = network::consumption(l, grid.flow);
  consumer.block = std::move(block);
  consumer.regulated = regulated_index(grid.network, consumer.block, where, problems);
  if (consumer.consumption == Complex{} && l.kind != network::LoadKind::shunt) {
    problems.add("load " + consumer.name + " has zero consumption", where,
                 "P = Q = 0 in " + grid.network.origin, "choose a load with consumption");
    return;
  }
  const auto same = std::ranges::find(grid.loads, load, &plant::Consumer::load);
  if (same == grid.loads.end())
    grid.loads.push_back(std::move(consumer));
  else
    *same = std::move(consumer);
}

bool is_composed(const Effect& effect) {
  if (effect.slot != Slot::load || effect.dyr_name.empty()) return false;
  return std::ranges::all_of(std::array{"Pi", "Pp", "Qi", "Qp"},
                             [&](const char* part) { return effect.parameter_index(part) >= 0; });
}

void compose(const Grid& grid, int load, plant::Block& block, const std::string& where, Problems& problems) {
  const network::Load& l = grid.network.loads[static_cast<std::size_t>(load)];
  const Complex total = network::consumption(l, grid.flow);
  const double v = std::abs(grid.flow.voltage[static_cast<std::size_t>(l.bus)]);
  const Complex current = l.current * v, admittance = l.admittance * (v * v);
  const auto set = [&](const char* parameter, double value) {
    block.p[static_cast<std::size_t>(block.effect->parameter_index(parameter))] = value;
  };
  const auto cancels = [&](double a, double b, double c, double sum, const char* name) {
    constexpr double least = 1e-9;  // least relative size of a sum with significant digits
    if (std::abs(sum) > least * (std::abs(a) + std::abs(b) + std::abs(c)) || (a == 0 && b == 0 && c == 0))
      return;
    problems.add(fmt::format("the constant-power, -current and -admittance parts of {} cancel", name), where,
                 fmt::format("{} needs fractions of their sum", block.effect->name),
                 "split the load into two with different ids");
  };
  cancels(l.power.real(), current.real(), admittance.real(), total.real(), "P");
  cancels(l.power.imag(), current.imag(), admittance.imag(), total.imag(), "Q");
  set("Pi", fraction(current.real(), total.real()));
  set("Pp", fraction(l.power.real(), total.real()));
  set("Qi", fraction(current.imag(), total.imag()));
  set("Qp", fraction(l.power.imag(), total.imag()));
}

void loads_as_composed(Grid& grid, Problems& problems) {
  const Effect* zip = library::compiled().find("ZIP");
  for (std::size_t i = 0; i < grid.network.loads.size(); ++i) {
    const network::Load& l = grid.network.loads[i];
    if (l.power == Complex{} && l.current == Complex{}) continue;
    if (std::ranges::count(grid.loads, static_cast<int>(i), &plant::Consumer::load)) continue;
    const std::string where = "load " + load_name(grid.network, i);
    plant::Block block{zip, zip->default_parameters()};
    compose(grid, static_cast<int>(i), block, where, problems);
    set_load(grid, static_cast<int>(i), std::move(block), where, problems);
  }
}

void choose_load(Grid& grid, const std::string& text, const std::string& where, Problems& problems) {
  const auto first = text.find(':'), second = first == text.npos ? text.npos : text.find(':', first + 1);
  if (first == text.npos) {
    problems.add("'" + text + "'", where, "a load model is BUS[/ID]:EFFECT[:PARAM=VALUE,...]",
                 "write it like 8:ZIP:Pp=0.4,Pi=0.3");
    return;
  }
  const std::string name = text.substr(first + 1, second == text.npos ? text.npos : second - first - 1);
  const Effect* effect = grid.library.find(name);
  if (!effect || effect->slot != Slot::load) {
    problems.add("no load model '" + name + "'", where,
                 "the load models are " + grid.library.names(Slot::load), "choose one of these");
    return;
  }
  plant::Block block{effect, effect->default_parameters()};
  if (second != text.npos) plant::set_parameters(block, text.substr(second + 1), where, problems);
  const std::vector<int> chosen = text.starts_with("*:")
                                      ? loads_without_model(grid, where, problems)
                                      : loads_named(grid.network, text.substr(0, first), where, problems);
  for (const int load : chosen) set_load(grid, load, block, where, problems);
}

std::string describe_loads(const Grid& grid) {
  if (grid.loads.empty()) return "constant impedance";
  std::string text;
  std::vector<const Effect*> kinds;
  for (const plant::Consumer& c : grid.loads)
    if (!std::ranges::count(kinds, c.block.effect)) kinds.push_back(c.block.effect);
  for (const Effect* effect : kinds) {
    text += (text.empty() ? "" : "; ") + std::string(effect->name) + " at";
    const char* separator = " ";
    for (const plant::Consumer& c : grid.loads)
      if (c.block.effect == effect) text += std::exchange(separator, ", ") + c.name;
  }
  return grid.loads.size() == grid.network.loads.size() ? text
                                                        : text + "; all other loads: constant impedance";
}

}  // namespace swingbank::sim::grid
