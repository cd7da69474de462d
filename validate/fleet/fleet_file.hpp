#pragma once
// Fleet file: list of plants with model and records.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fleet {

/// One plant of a fleet, with its records and options.
struct FleetPlant {
  std::string name;                  ///< letters, digits, - and _; also the name of its folder
  std::filesystem::path model;       ///< plant file
  std::vector<std::string> records;  ///< files and globs as written; relative ones are below `Fleet::folder`
  double prior_sd = thresholds::parameters.prior_sd;  ///< see DiagnoseOptions::prior_sd
  bool power_only = false;                            ///< whether to ignore recorded speed, Efd and Ifd
};
/// Contents of a fleet file.
struct Fleet {
  std::filesystem::path file, folder;  ///< the file, and its folder
  std::vector<FleetPlant> plants;      ///< in order of their names
};
/// Reads a fleet file (configs/fleet/README.md). Throws InputError with every error of the file. A missing
/// model or record is no error here: the diagnosis of its plant reports it, and the other plants continue.
Fleet load_fleet(const std::filesystem::path& file);
/// Returns the JSON Schema of fleet files.
std::string fleet_schema();

}  // namespace swingbank::validate::fleet
