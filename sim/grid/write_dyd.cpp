// Writer of a unit as lines of a PSLF .dyd, converted from its .dyr records.
#include <fmt/format.h>

#include "sim/formats/psse_text.hpp"
#include "sim/grid/unit.hpp"

namespace swingbank::sim::grid {

std::string unit_dyd(const plant::Plant& plant, int bus, const std::string& id,
                     const formats::DydPlace& place, const std::string& where, Problems& problems) {
  Problems found;
  const std::string dyr = unit_dyr(plant, bus, id, where, found);
  problems.add(found);
  if (!found.empty()) return {};
  const Effect& effect = *plant.machine.effect;
  const auto of_raw = [&](int index) {
    return index < 0 ? 0.0 : plant.machine.p[static_cast<std::size_t>(index)];
  };
  const formats::DydMachine machine{.mva = plant.mva,
                                    .resistance = of_raw(effect.raw_resistance),
                                    .reactance = of_raw(effect.raw_reactance)};
  std::string text;
  if (plant.transformer.effect) {
    text += "# The case contains the step-up transformer, on the machine's base:";
    for (std::size_t i = 0; i < plant.transformer.p.size(); ++i)
      text += fmt::format(" {} = {}", plant.transformer.effect->parameters[i].name,
                          formats::psse::shortest(plant.transformer.p[i]));
    text += "\n";
  }
  for (const formats::DyrRecord& record : formats::parse_dyr(dyr, where))
    text += formats::dyd_line(record, machine, place, where, problems);
  return text;
}

}  // namespace swingbank::sim::grid
