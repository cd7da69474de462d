#pragma once
// Writer of plant files: the input of load_plant_model, exact to the last bit. Comments in the file give unit
// and meaning of each parameter, and the origin of the values.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// Returns the text of a plant file; `provenance` becomes its head comment, line by line. Files of
/// user-defined models are named without folders. Throws InputError if the text would not be read back as the
/// same model, for example because a .dyr contained a parameter outside its bounds.
std::string plant_text(const PlantModel& model, const std::vector<std::string>& provenance);

/// Writes a plant file and copies of the files of user-defined models beside it. Throws InputError as
/// plant_text and write_file.
void write_plant_file(const std::filesystem::path& file, const PlantModel& model,
                      const std::vector<std::string>& provenance);

/// Returns the first difference of two models; empty if there is none. Compares name, bus, bases, dispatch,
/// nameplate, columns, staged events, conventions, effects, and every parameter exactly.
std::string difference(const PlantModel& a, const PlantModel& b);

}  // namespace swingbank::validate::plant
