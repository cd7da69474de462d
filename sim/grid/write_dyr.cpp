// Writer of the .dyr records of one unit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/formats/psse_text.hpp"
#include "sim/grid/unit.hpp"

namespace swingbank::sim::grid {
namespace {

/// Returns one record of a .dyr. `owner`: "machine" or the slot of a control, for messages.
std::string dyr_record(const plant::Block& block, const std::string& owner, int bus, const std::string& id,
                       const std::string& file, Problems& problems) {
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
    const double dropped = std::isnan(parameter.null_value) ? standard[at] : parameter.null_value;
    if (block.p[at] != dropped)
      problems.add(std::string(parameter.symbol) + " = " + formats::psse::shortest(block.p[at]) + " " +
                       std::string(parameter.unit) + " of " + std::string(effect.name),
                   where, "a .dyr has no column for it",
                   "set it to " + formats::psse::shortest(dropped) + " " + std::string(parameter.unit));
  }
  std::string text = std::to_string(bus) + " " + formats::psse::quote(std::string(effect.dyr_name)) + " " +
                     formats::psse::quote(id);
  for (const int column : effect.dyr_columns)
    text += " " + formats::psse::shortest(block.p[static_cast<std::size_t>(column)]);
  return text + " /\n";
}

/// Returns true for instruments and changes of set-points, which belong to an event and not to a plant's
/// model. A setpoint effect with a .dyr form, such as a load controller, belongs to the model.
bool belongs_to_event(const Effect& effect) {
  return effect.slot == Slot::measurement || (effect.slot == Slot::setpoint && effect.dyr_name.empty());
}

}  // namespace

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
