#pragma once
// The model of one plant, as the commands that work on records take it: a .toml file that names the effects
// and every parameter, or one generator of a PSS/E grid.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/grid/unit.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/under_test.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::plant {

struct PlantModel {
  std::string name, origin;  ///< origin: the file it was read from
  std::string sha256;        ///< of that file's bytes
  sim::plant::Plant plant;   ///< its generation is set from each record
  sim::Conventions conventions;
  record::RecordBase record_base;                ///< what "pu" means in the records of this plant
  record::ReadOptions reading;                   ///< which columns of its records are read, and which stretch
  std::vector<std::filesystem::path> laws = {};  ///< law files that its effects come from
  int bus = 0;                                   ///< number in its case; 0: not given
  std::string id = "1";                          ///< the machine's, there
  /// What it delivers in its case; none: not known. Records are held against it, nothing starts from it.
  std::optional<sim::grid::Dispatch> dispatch = {};
  /// Parameters ("SEXS.TE") that the file leaves to their standard values (`standard = true`).
  std::vector<std::string> defaults = {};
  /// Of a calibration that did not hold: the plant as it was before, not bent to make up for what is missing.
  std::optional<sim::plant::Plant> submitted = {};
  /// Where `plant` is one component of it only: the plant.
  std::optional<sim::plant::Plant> whole = {};
  /// What looks wrong in the file and does not refuse it, with its line.
  std::vector<std::string> warnings = {};
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// Compiled effects and those of `laws`. The plant's blocks point into it, so a plant taken out of the
  /// model must not outlive the model and its copies.
  sim::library::EffectLibrary library = {};
};

/// What is tried, in a word: the machine's effect, or "exciter alone".
std::string subject(const PlantModel& model);

/// Reads a plant file (configs/plants/README.md describes it). Every parameter of every effect must be given
/// by name; what is not is taken from the effect's standard values only where its block says
/// `standard = true`. Throws InputError with every fault of the file: unknown keys, effects or
/// parameters (the known ones are listed), missing ones, wrong types, values that no equation takes. Values
/// outside what is usual for them are warnings, each with its line.
PlantModel load_plant_model(const std::filesystem::path& file);
/// The same from a text; `file` stands for it in messages, and relative paths in it refer to its folder.
PlantModel parse_plant_model(const std::string& text, const std::filesystem::path& file);
/// The model to fit or diagnose: as it was before a calibration that did not hold, else as it is.
PlantModel as_submitted(PlantModel model);
/// The model of one unit of a case, with the values of the case; `files` names them in messages. The records'
/// base is the system's. The warnings say which orderings are violated, and whether the data look like those
/// of another base.
PlantModel model_of_unit(const sim::grid::Unit& unit, sim::Conventions conventions, std::string files);

}  // namespace swingbank::validate::plant
