#pragma once
// Model of one component (exciter, governor or machine) of a plant file, which is tested alone.
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::event {

/// Returns the model whose plant is the component and whose records supply the columns that the component
/// needs; `whole` holds the whole plant. Warnings list the blocks left out.
plant::PlantModel component_model(plant::PlantModel model, record::Component component);

/// Returns the whole plant, with the component's blocks as in the model.
plant::PlantModel whole_model(plant::PlantModel model);

}  // namespace swingbank::validate::event
