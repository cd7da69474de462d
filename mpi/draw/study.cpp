// Resolution of a dataset's config on its grid: varied plants, faulted buses and config hash.
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "base/durable.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/draw/detail/plant_blocks.hpp"
#include "sim/grid/attach.hpp"
#include "sim/grid/limits.hpp"

namespace swingbank::mpi::draw {

namespace fs = std::filesystem;

Study load_study(const DatasetConfig& config) {
  Study s{config, {}, {}, {}};
  s.grid = sim::grid::load_grid(config.raw, config.dyr,
                                config.psse ? sim::Conventions::psse() : sim::Conventions::andes(),
                                config.grid_case);
  const auto& network = s.grid.network;
  s.grid.conventions.frequency = network.frequency;
  s.grid.library = config.library;
  Problems problems;
  for (const auto& a : config.attachments) sim::grid::attach(s.grid, a, config.file.string(), problems);
  if (config.widen_limits) sim::grid::settle_limits(s.grid, true);
  for (std::size_t g = 0; g < config.generators.size(); ++g) {
    const int number = config.generators[g], bus = network.bus_index(number);
    const std::string id = g < config.ids.size() ? config.ids[g] : "";
    const auto here = [&](const sim::plant::Plant& p) {
      return bus >= 0 && p.bus == bus &&
             (id.empty() || network.generators[static_cast<std::size_t>(p.generator)].id == id);
    };
    const auto count = std::ranges::count_if(s.grid.plants, here);
    const auto plant = std::ranges::find_if(s.grid.plants, here);
    if (count != 1)
      problems.add(fmt::format("generator {} of vary.generators", number), config.file.string(),
                   fmt::format("{} has {} generators {}in service at this bus", config.raw.string(), count,
                               id.empty() ? "" : "'" + id + "' "),
                   id.empty() ? "name buses with one generator, or the unit in vary.ids"
                              : "correct '" + id + "' in vary.ids");
    else if (plant->machine.effect != &config.effect())
      problems.add(fmt::format("generator {} of vary.generators", number), config.file.string(),
                   fmt::format("its machine in {} is {}, not {}", config.dyr.string(),
                               plant->machine.effect->name, config.model),
                   "change vary.model or the .dyr");
    else
      s.plants.push_back(static_cast<int>(plant - s.grid.plants.begin()));
    if (count != 1) continue;
    for (const sim::Effect* effect : config.other_effects())
      if (const int n = times_in(*plant, *effect); n != 1)
        problems.add(fmt::format("generator {} of vary.generators", number), config.file.string(),
                     fmt::format("it has {} {} with parameters in [vary.effects.{}]",
                                 n == 0 ? "no" : std::to_string(n), effect->name, effect->name),
                     n == 0 ? fmt::format("add \"{}:{}\" to attach", plant->name, effect->name)
                            : "keep only one of them in the .dyr");
  }
  const auto index_of = [&](int number, const char* key) {
    const int bus = network.bus_index(number);
    if (bus < 0)
      problems.add(fmt::format("bus {} of {}", number, key), config.file.string(),
                   "there is no such bus in " + config.raw.string(), "name buses of the network");
    return bus;
  };
  std::vector<int> except;
  for (int number : config.fault.except) except.push_back(index_of(number, "fault.except"));
  const auto allow = [&](int bus) {
    if (bus >= 0 && std::ranges::find(except, bus) == except.end()) s.fault_buses.push_back(bus);
  };
  for (int number : config.fault.buses) allow(index_of(number, "fault.buses"));
  if (config.fault.buses.empty())
    for (std::size_t i = 0; i < network.buses.size(); ++i)
      if (network.buses[i].type != sim::network::BusType::isolated && !network.buses[i].is_star())
        allow(static_cast<int>(i));
  if (s.fault_buses.empty())
    problems.add("no bus to fault", config.file.string(), "fault.except excludes all of fault.buses",
                 "name more buses");
  problems.raise();
  return s;
}

std::string config_hash(const DatasetConfig& config, const std::string& kernel) {
  std::string text = config.canonical() + kernel + "\n";
  std::vector<fs::path> files = {config.raw, config.dyr};
  files.insert(files.end(), config.user_models.begin(), config.user_models.end());
  for (const auto& file : files) {
    const std::string content = read_text(file);
    text += hex(XXH3_64bits(content.data(), content.size())) + "\n";
  }
  return hex(XXH3_64bits(text.data(), text.size()));
}

}  // namespace swingbank::mpi::draw
