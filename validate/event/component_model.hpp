#pragma once
// The model of a component: what of a plant file stays where an exciter, a governor or a machine is tried
// alone.
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::event {

/// The model with the component as its plant, reading the columns that the component needs; the whole plant
/// stands in `whole`. What is left out is said in the warnings.
plant::PlantModel component_model(plant::PlantModel model, record::Component component);

/// The whole plant again, with the component as the model has it.
plant::PlantModel whole_model(plant::PlantModel model);

}  // namespace swingbank::validate::event
