#pragma once
// Model of one plant for the commands that use records: a .toml file that names the effects and every
// parameter, or one generator of a grid case (PSS/E, PSLF or MATPOWER).
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/grid/unit.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/under_test.hpp"
#include "validate/plant/nameplate.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::plant {

/// Plant with the bases of its records, the origin of its data and the library of its effects.
struct PlantModel {
  std::string name, origin;        ///< name of the plant; file from which it was read
  std::string sha256;              ///< of that file's bytes
  sim::plant::Plant plant;         ///< the plant; each record sets its power
  sim::Conventions conventions;    ///< conventions of the simulator for which the parameters are valid
  record::RecordBase record_base;  ///< per-unit bases of the records of this plant
  record::ReadOptions reading;     ///< columns and time range of its records
  std::vector<std::filesystem::path> user_models =
      {};                ///< files of user-defined models that define some of its effects
  int bus = 0;           ///< bus number in its case; 0: not given
  std::string id = "1";  ///< machine identifier in its case
  /// Power and voltage of the unit in its case; empty: unknown. Used to check records, never as an initial
  /// condition.
  std::optional<sim::grid::Dispatch> dispatch = {};
  Nameplate nameplate = {};  ///< nameplate of the plant, for reports
  /// Parameters ("SEXS.TE") that have default values because the file does not give them (`default_values =
  /// true`).
  std::vector<std::string> defaults = {};
  /// Plant before a calibration that was rejected; its parameters do not compensate for a missing effect.
  std::optional<sim::plant::Plant> submitted = {};
  /// The whole plant, if `plant` is only one component of it.
  std::optional<sim::plant::Plant> whole = {};
  /// Warnings about suspicious entries of the file, with their lines.
  std::vector<std::string> warnings = {};
  /// Returns references to plant and conventions; the model must outlive them.
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// Compiled effects and those of `user_models`. The plant's blocks point into the library, so a copy of the
  /// plant must not outlive the model and its copies.
  sim::library::EffectLibrary library = {};
};

/// Returns the name of the tested part: the machine's effect, or "exciter alone".
std::string subject(const PlantModel& model);

/// Reads a plant file (configs/plants/README.md). Every parameter of every effect must be given by name;
/// missing ones take default values only if their block has `default_values = true`. Throws InputError with
/// every fault of the file: unknown keys, effects or parameters (the known ones are listed), missing ones,
/// wrong types, values that the equations do not allow. Unusual values become warnings, each with its line.
/// The library also contains the effects of the files `user_models`, which the plant file need not name.
PlantModel load_plant_model(const std::filesystem::path& file,
                            const std::vector<std::filesystem::path>& user_models = {});
/// Reads a plant file from its text. `file` names it in messages; relative paths refer to its folder.
PlantModel parse_plant_model(const std::string& text, const std::filesystem::path& file,
                             const std::vector<std::filesystem::path>& user_models = {});
/// Returns the JSON Schema of plant files.
std::string plant_schema();
/// Returns the model to fit or diagnose: with the values from before a rejected calibration, or else
/// unchanged.
PlantModel as_submitted(PlantModel model);
/// Returns the model of one unit of a case, with the values of the case; `files` names its files in messages.
/// The base of the records is the system's. Warnings report violated orderings of parameters, and data that
/// appear to be on another base.
PlantModel model_of_unit(const sim::grid::Unit& unit, sim::Conventions conventions, std::string files);

}  // namespace swingbank::validate::plant
