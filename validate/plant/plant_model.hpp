#pragma once
// The model of one plant, as the commands that work on records take it: a .toml file that names the effects
// and every parameter, or one generator of a PSS/E grid.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/grid/grid.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/under_test.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::plant {

struct PlantModel {
  std::string name, origin;  ///< origin: the file it was read from
  std::uint64_t hash = 0;    ///< XXH64 of that file's bytes
  sim::plant::Plant plant;   ///< its generation is set from each record
  sim::Conventions conventions;
  record::RecordBase record_base;                ///< what "pu" means in the records of this plant
  record::ReadOptions reading;                   ///< which columns of its records are read, and which stretch
  std::vector<std::filesystem::path> laws = {};  ///< law files that its effects come from
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// Compiled effects and those of `laws`. The plant's blocks point into it, so a plant taken out of the
  /// model must not outlive the model and its copies.
  sim::library::EffectLibrary library = {};
};

/// Reads a plant file (configs/plants/README.md describes it). Every parameter of every effect must be given
/// by name; nothing is defaulted. Throws InputError with every fault of the file: unknown keys, effects or
/// parameters (the known ones are listed), missing ones, wrong types, values outside what is physically
/// possible, inconsistent values.
PlantModel load_plant_model(const std::filesystem::path& file);
/// The same from a text; `file` stands for it in messages, and relative paths in it refer to its folder.
PlantModel parse_plant_model(const std::string& text, const std::filesystem::path& file);

}  // namespace swingbank::validate::plant
