#include "validate/event/component_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "validate/playin/component.hpp"

namespace swingbank::validate::event {
namespace {

using record::Component;

/// Returns the names of the plant's blocks outside the component.
std::string left_out_of(const sim::plant::Plant& plant, Component component) {
  std::string names;
  const auto add = [&](const sim::plant::Block& b) {
    if (b.effect && !playin::belongs_to(component, b.effect->slot))
      names += (names.empty() ? "" : ", ") + std::string(b.effect->name);
  };
  add(plant.machine);
  add(plant.transformer);
  for (const auto& b : plant.controls) add(b);
  for (const auto& b : plant.measurements) add(b);
  return names;
}

}  // namespace

plant::PlantModel component_model(plant::PlantModel model, Component component) {
  if (component == Component::plant) return model;
  if (const auto names = left_out_of(model.plant, component); !names.empty())
    model.warnings.push_back(fmt::format(
        "{} is tested alone: {} of the plant file {} ignored, because the record replaces {}",
        record::component_name(component), names, names.find(',') == std::string::npos ? "is" : "are",
        names.find(',') == std::string::npos ? "it" : "them"));
  const sim::Slot slot = component == Component::exciter ? sim::Slot::exciter : sim::Slot::governor;
  if (component != Component::machine &&
      std::ranges::none_of(model.plant.controls, [&](const auto& b) { return b.effect->slot == slot; }))
    model.warnings.push_back(
        fmt::format("the plant file has no {0}: the output of the {0} is constant", sim::slot_name(slot)));
  model.whole = std::move(model.plant);
  model.plant = playin::component_of(*model.whole, component);
  model.reading.component = component;
  model.reading.needed = playin::needed_columns(model.under_test(), component);
  return model;
}

plant::PlantModel whole_model(plant::PlantModel model) {
  if (!model.whole) return model;
  model.plant = playin::put_back(*model.whole, model.plant, model.reading.component);
  model.whole.reset();
  model.reading.component = Component::plant;
  model.reading.needed.clear();
  return model;
}

}  // namespace swingbank::validate::event
