// Writer of .dyr records for the plants of a grid or for one unit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/durable.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/grid/detail/dyr_models.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/grid/unit.hpp"

namespace swingbank::sim::grid {
namespace {

/// Returns one record of a .dyr. `owner`: "generator 30" or "load 8"; `id`: id of the owner in the .raw;
/// `raw`: block with the values of the .raw.
std::string dyr_record(const plant::Block& block, const std::string& owner, int bus, const std::string& id,
                       const std::string& file, Problems& problems, const plant::Block* raw = nullptr) {
  const Effect& effect = *block.effect;
  const std::string where = file + ", " + owner;
  if (effect.dyr_name.empty()) {
    problems.add("model " + std::string(effect.name), where, "it has no .dyr form",
                 "remove it before writing");
    return {};
  }
  const auto standard = effect.default_parameters();
  for (int i = 0; i < static_cast<int>(block.p.size()); ++i) {
    if (i == effect.raw_resistance || i == effect.raw_reactance || std::ranges::count(effect.dyr_columns, i))
      continue;
    const auto at = static_cast<std::size_t>(i);
    const Parameter& parameter = effect.parameters[at];
    if (raw && raw->p[at] == block.p[at]) continue;
    const double dropped = raw                                ? raw->p[at]
                           : std::isnan(parameter.null_value) ? standard[at]
                                                              : parameter.null_value;
    if (block.p[at] != dropped)
      problems.add(std::string(parameter.symbol) + " = " + formats::psse::shortest(block.p[at]) + " " +
                       std::string(parameter.unit) + " of " + std::string(effect.name),
                   where, raw ? "PSS/E takes it from the .raw" : "a .dyr has no column for it",
                   "set it to " + formats::psse::shortest(dropped) + " " + std::string(parameter.unit));
  }
  std::string text = std::to_string(bus) + " " + formats::psse::quote(std::string(effect.dyr_name)) + " " +
                     formats::psse::quote(id);
  for (const int column : effect.dyr_columns)
    text += " " + formats::psse::shortest(block.p[static_cast<std::size_t>(column)]);
  return text + " /\n";
}

std::string plant_record(const Grid& grid, const plant::Plant& plant, const plant::Block& block,
                         const std::string& file, Problems& problems) {
  const Effect& effect = *block.effect;
  const network::Generator& g = grid.network.generators[static_cast<std::size_t>(plant.generator)];
  const auto in_raw = [&](int index, double value, const char* field) {
    if (index >= 0 && block.p[static_cast<std::size_t>(index)] != value)
      problems.add(std::string(effect.parameters[static_cast<std::size_t>(index)].symbol) + " = " +
                       formats::psse::shortest(block.p[static_cast<std::size_t>(index)]) + " pu",
                   file + ", generator " + plant.name,
                   "the network has " + std::string(field) + " = " + formats::psse::shortest(value) +
                       " pu, and PSS/E keeps it in the .raw",
                   "set the same value in the network");
  };
  in_raw(effect.raw_resistance, g.zr, "ZR");
  in_raw(effect.raw_reactance, g.zx, "ZX");
  return dyr_record(block, "generator " + plant.name,
                    grid.network.buses[static_cast<std::size_t>(plant.bus)].number, g.id, file, problems);
}

/// Returns the record of a switched shunt's model, without mechanically switched shunts.
std::string shunt_record(const plant::Block& block, int bus, const std::string& shunt) {
  using formats::psse::quote;
  using formats::psse::shortest;
  const Effect& effect = *block.effect;
  const ShuntRecord& layout = *effect.at_shunt;
  const std::string id = shunt.substr(2), regulated = std::to_string(regulated_bus(block));
  std::string text =
      std::to_string(bus) + " " + quote(std::string(id.empty() ? layout.of_first : layout.by_id)) +
      (id.empty() ? "" : " " + quote(id)) + " " + (regulated == "0" ? std::to_string(bus) : regulated);
  for (std::size_t i = 1; i < effect.dyr_columns.size(); ++i) {
    if (i == layout.columns)
      for (std::size_t k = 1; k <= layout.beside; ++k) text += " 0 " + quote(std::to_string(k));
    text += " " + shortest(block.p[static_cast<std::size_t>(effect.dyr_columns[i])]);
  }
  return text + " /\n";
}

/// Adds a problem if a step-up transformer differs from the .raw, because a .dyr cannot contain it.
void write_transformer(const Grid& grid, const plant::Plant& plant, const std::string& file,
                       Problems& problems) {
  const network::Generator& g = grid.network.generators[static_cast<std::size_t>(plant.generator)];
  const plant::Block raw = transformer_of(g);
  if (plant.transformer.effect == raw.effect && plant.transformer.p == raw.p) return;
  problems.add("a step-up transformer that differs from the network's", file + ", generator " + plant.name,
               "PSS/E keeps it in the .raw (RT, XT), a .dyr cannot contain it",
               "set the generator's RT and XT in the network, or remove it before writing");
}

/// Returns true for instruments and changes of set-points, which belong to an event and not to a plant's
/// model. A setpoint effect with a .dyr form, such as a load controller, belongs to the model.
bool belongs_to_event(const Effect& effect) {
  return effect.slot == Slot::measurement || (effect.slot == Slot::setpoint && effect.dyr_name.empty());
}

}  // namespace

void write_dyr(const Grid& grid, const std::filesystem::path& file) {
  Problems problems;
  std::string text;
  for (const plant::Plant& plant : grid.plants) {
    text += plant_record(grid, plant, plant.machine, file.string(), problems);
    write_transformer(grid, plant, file.string(), problems);
    for (const plant::Block& control : plant.controls)
      text += plant_record(grid, plant, control, file.string(), problems);
  }
  for (const plant::Consumer& load : grid.loads) {
    const network::Load& l = grid.network.loads[static_cast<std::size_t>(load.load)];
    if (l.kind == network::LoadKind::shunt) {
      const network::Bus& bus = grid.network.buses[static_cast<std::size_t>(load.bus)];
      text += shunt_record(load.block, bus.number, l.id);
      continue;
    }
    plant::Block raw{load.block.effect, load.block.effect->default_parameters()};
    if (is_composed(*raw.effect)) compose(grid, load.load, raw, file.string(), problems);
    text += dyr_record(load.block, "load " + load.name,
                       grid.network.buses[static_cast<std::size_t>(load.bus)].number, l.id, file.string(),
                       problems, is_composed(*raw.effect) ? &raw : nullptr);
  }
  problems.raise();
  write_text(file, text);
}

std::string unit_dyr(const plant::Plant& plant, int bus, const std::string& id, const std::string& where,
                     Problems& problems) {
  using formats::psse::shortest;
  const auto raw = [&](int index) {
    return index < 0 ? std::string() : shortest(plant.machine.p[static_cast<std::size_t>(index)]);
  };
  const Effect& machine = *plant.machine.effect;
  std::string text =
      fmt::format("// Values of this generator in the .raw: MBASE = {} MVA", shortest(plant.mva));
  if (machine.raw_resistance >= 0) text += ", ZR = " + raw(machine.raw_resistance);
  if (machine.raw_reactance >= 0) text += ", ZX = " + raw(machine.raw_reactance);
  text += "\n";
  if (plant.transformer.effect) {
    text += "// Step-up transformer in the .raw, on MBASE:";
    for (std::size_t i = 0; i < plant.transformer.p.size(); ++i)
      text += fmt::format(" {} = {}", plant.transformer.effect->parameters[i].name,
                          shortest(plant.transformer.p[i]));
    text += "\n";
  }
  text += dyr_record(plant.machine, "machine", bus, id, where, problems);
  for (const plant::Block& control : plant.controls)
    if (!belongs_to_event(*control.effect))
      text += dyr_record(control, std::string(slot_name(control.effect->slot)), bus, id, where, problems);
  return text;
}

}  // namespace swingbank::sim::grid
