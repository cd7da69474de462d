#pragma once
// Model of one component (exciter, governor or machine) of a plant file, which is tested alone.
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::event {

/// Returns the model of the component alone. Its member `whole` keeps the whole plant, `reading` requires the
/// columns that the component needs, and `warnings` list the omitted blocks. Component::plant returns the
/// model unchanged.
plant::PlantModel component_model(plant::PlantModel model, record::Component component);

/// Returns the model of the whole plant, with the component's blocks taken from `model`.
plant::PlantModel whole_model(plant::PlantModel model);

}  // namespace swingbank::validate::event
