#pragma once
// A plant file read together with user-defined models (law files) that it may use without naming their files.
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// As load_plant_model(file). The effects of `laws` are in the model's library. Throws InputError.
PlantModel load_plant_model(const std::filesystem::path& file,
                            const std::vector<std::filesystem::path>& laws);

}  // namespace swingbank::validate::plant
