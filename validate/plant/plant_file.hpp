#pragma once
// Plant files written: what load_plant_model reads, to the last bit, with unit and meaning beside each
// parameter and, above, where the values come from.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// Text of a plant file; `provenance` becomes its head comment, line by line. Law files are named without
/// their folders. Throws InputError if the text would not read back to the same values (a parameter outside
/// the bounds of its record, which a .dyr may have).
std::string plant_text(const PlantModel& model, const std::vector<std::string>& provenance);

/// Writes it, and copies of the law files beside it. Throws InputError, as plant_text and write_file.
void write_plant_file(const std::filesystem::path& file, const PlantModel& model,
                      const std::vector<std::string>& provenance);

/// Why two models differ, empty if they do not: name, bus, bases, conventions, effects, every bit of every
/// parameter.
std::string difference(const PlantModel& a, const PlantModel& b);

}  // namespace swingbank::validate::plant
