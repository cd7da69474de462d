#pragma once
// Reader of a plant file with user-defined models that it may use without naming their files.
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// Returns the model as load_plant_model(file) does, with the effects of the files `user_models` in its
/// library too. Throws InputError.
PlantModel load_plant_model(const std::filesystem::path& file,
                            const std::vector<std::filesystem::path>& user_models);

}  // namespace swingbank::validate::plant
