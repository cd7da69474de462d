#include "validate/plant/plant_model.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "base/config.hpp"
#include "base/input_file.hpp"
#include "sim/laws/law.hpp"

namespace swingbank::validate::plant {
namespace {

namespace fs = std::filesystem;
using sim::Slot;

constexpr double kSmallest = 1e-9;  ///< bases and frequencies are above zero

using sim::library::EffectLibrary;

/// Names of the effects of one slot, as a config may write them.
std::vector<std::string> effects_of(const EffectLibrary& library, Slot slot) {
  std::vector<std::string> names;
  for (const auto* e : library.all())
    if (e->slot == slot) names.emplace_back(e->name);
  return names;
}

/// One section: the effect's name and every one of its parameters; checked for consistency if all could be
/// read. `section` is a slot's name, or "limiter[1]".
sim::plant::Block read_block(Config& config, const EffectLibrary& library, Slot slot,
                             const std::string& section) {
  sim::plant::Block block{library.find(config.choice(section + ".effect", effects_of(library, slot))), {}};
  if (!block.effect || block.effect->slot != slot) return {};
  const bool sound = config.sound();
  for (const auto& p : block.effect->parameters)
    block.p.push_back(
        config.require<double>(fmt::format("{}.{}", section, p.name), {p.low, p.high, std::string(p.unit)}));
  if (!sound || !config.sound()) return block;
  Problems problems;
  block.effect->check(block.effect->law.get(), block.p.data(), config.where(section), problems);
  for (const auto& p : problems.list()) config.problem(section, p.what, p.why, p.remedy);
  return block;
}

/// Every [[section]] of a slot that takes several effects.
std::vector<sim::plant::Block> read_several(Config& config, const EffectLibrary& library, Slot slot) {
  const std::string name(sim::slot_name(slot));
  config.ignore(name);  // its keys are compared below
  std::vector<sim::plant::Block> blocks;
  for (int k = 0; config.has(fmt::format("{}[{}]", name, k)); ++k) {
    const std::string section = fmt::format("{}[{}]", name, k);
    const sim::plant::Block block = read_block(config, library, slot, section);
    if (!block.effect) continue;
    std::vector<std::string> known = {"effect"};
    for (const auto& p : block.effect->parameters) known.emplace_back(p.name);
    for (const auto& key : config.keys(section))
      if (!std::ranges::count(known, key))
        config.problem(section + "." + key, "unknown key " + key, "nothing reads it in [[" + name + "]]",
                       fmt::format("remove it or use one of: {}", fmt::join(known, ", ")));
    blocks.push_back(block);
  }
  return blocks;
}

/// The effects of one slot: one [section], or several [[section]] where they add up.
void read_slot(Config& config, const EffectLibrary& library, Slot slot,
               std::vector<sim::plant::Block>& into) {
  const std::string section(sim::slot_name(slot));
  if (!config.is_array(section)) return into.push_back(read_block(config, library, slot, section));
  if (!sim::is_shared(slot)) {
    config.ignore(section);
    return config.problem(section, "several [[" + section + "]]", "a plant has room for one",
                          "write one [" + section + "]");
  }
  std::ranges::move(read_several(config, library, slot), std::back_inserter(into));
}

void read_blocks(Config& config, const EffectLibrary& library, sim::plant::Plant& plant) {
  plant.machine = read_block(config, library, Slot::machine, "machine");
  for (const Slot slot : sim::kSlots) {
    const std::string section(sim::slot_name(slot));
    if (slot == Slot::machine || slot == Slot::load || !config.has(section)) continue;
    if (effects_of(library, slot).empty())
      config.problem(section, "section [" + section + "]", "this build has no effect of that kind",
                     "remove it; the slot holds its input at the operating point");
    else if (slot == Slot::transformer)
      plant.transformer = read_block(config, library, slot, section);
    else
      read_slot(config, library, slot, slot == Slot::measurement ? plant.measurements : plant.controls);
  }
}

/// Law files of the plant: the library knows their effects from here on.
std::vector<fs::path> read_laws(Config& config, EffectLibrary& library) {
  std::vector<fs::path> files;
  for (const auto& name : config.optional<std::vector<std::string>>("laws", {})) {
    const fs::path file = (config.name().parent_path() / name).lexically_normal();
    try {
      sim::laws::load_law(file, library);
      files.push_back(file);
    } catch (const InputError& error) {
      for (const auto& p : error.problems())
        config.problem("laws", p.what + " in " + p.where, p.why, p.remedy);
    }
  }
  return files;
}

sim::Conventions read_conventions(Config& config, double hz) {
  auto read = config.choice("plant.conventions", {"psse", "andes"}) == "andes" ? sim::Conventions::andes(hz)
                                                                               : sim::Conventions::psse(hz);
  read.speed_voltage = config.optional<bool>("plant.speed_voltage", read.speed_voltage);
  return read;
}

/// The plant of one generator of a grid; its name there is the bus number, with "/id" where the bus has
/// several.
sim::plant::Plant find_plant(Config& config, const sim::grid::Grid& grid, std::int64_t bus,
                             const std::string& id) {
  const std::string number = std::to_string(bus);
  std::string all;
  for (std::size_t k = 0; k < grid.plants.size(); ++k) {
    const auto& plant = grid.plants[k];
    all += (all.empty() ? "" : ", ") + plant.name;
    const bool same = plant.name == number || plant.name.starts_with(number + "/");
    const bool alone = plant.name == number;
    if (same && (id.empty() ? alone : plant.name == number + "/" + id)) return plant;
    if (alone && std::ranges::any_of(grid.network.generators, [&](const sim::network::Generator& g) {
          return g.bus == plant.bus && g.id == id && g.in_service;
        }))
      return plant;
  }
  config.problem("grid.bus", "no plant at bus " + number + (id.empty() ? "" : " with id " + id),
                 "the grid has no such generator in service", "use one of " + all);
  return {};
}

void read_from_grid(Config& config, PlantModel& model) {
  for (const char* twice : {"plant.base_mva", "machine", "exciter", "governor", "stabiliser", "limiter"})
    if (config.has(twice))
      config.problem(twice, std::string(twice) + " beside [grid]", "the grid's files give it already",
                     "remove one of them");
  const fs::path raw = config.file("grid.raw"), dyr = config.file("grid.dyr");
  const auto bus = config.require<std::int64_t>("grid.bus", {1.0});
  const auto id = config.optional<std::string>("grid.id", "");
  const sim::formats::DyrOptions models = sim::formats::read_dyr_options(config, "grid.");
  if (!config.sound()) return;
  std::optional<double> hz;  // a .raw has its own, which is compared below
  if (raw.extension() == ".m") hz = model.conventions.frequency;
  const sim::grid::Grid grid = sim::grid::load_grid(raw, dyr, model.conventions, models, hz);
  if (grid.network.frequency != model.conventions.frequency)
    config.problem("plant.frequency_hz",
                   fmt::format("plant.frequency_hz = {:g} Hz", model.conventions.frequency),
                   fmt::format("the grid's .raw says {:g} Hz", grid.network.frequency), "make them agree");
  model.plant = find_plant(config, grid, bus, id);
}

}  // namespace

PlantModel load_plant_model(const fs::path& file) {
  return parse_plant_model(read_input(file, "no readable plant file", "give the path of a plant .toml"),
                           file);
}

PlantModel parse_plant_model(const std::string& text, const fs::path& file) {
  Config config(text, file);
  PlantModel model;
  model.origin = file.string();
  model.hash = XXH64(text.data(), text.size(), 0);
  model.laws = read_laws(config, model.library);
  model.name = config.require<std::string>("plant.name");
  config.optional<std::string>("plant.origin", "");
  const auto hz = config.require<double>("plant.frequency_hz", {kSmallest, 1000.0, "Hz"});
  model.conventions = read_conventions(config, hz);
  model.record_base.frequency = hz;
  model.record_base.mva = config.require<double>("record.base_mva", {kSmallest, 1e9, "MVA"});
  model.record_base.kv = config.optional<double>("record.base_kv", 0.0, {kSmallest, 1e9, "kV"});
  for (const auto& word : config.keys("record.columns"))
    model.reading.columns[word] = config.require<std::string>("record.columns." + word);
  if (config.has("grid")) {
    read_from_grid(config, model);
  } else {
    model.plant.mva = config.require<double>("plant.base_mva", {kSmallest, 1e9, "MVA"});
    model.plant.name = model.name;
    read_blocks(config, model.library, model.plant);
  }
  config.raise();
  return model;
}

}  // namespace swingbank::validate::plant
