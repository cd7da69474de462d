#pragma once
// Fleet files: which plants there are, with which model and which records.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fleet {

struct FleetPlant {
  std::string name;                  ///< letters, digits, - and _: also the name of its folder
  std::filesystem::path model;       ///< plant file
  std::vector<std::string> records;  ///< as written: files and globs, below `Fleet::folder` where relative
  double spread = thresholds::parameters.spread;  ///< as DiagnoseOptions::spread
  bool power_only = false;                        ///< leave recorded speed, Efd and Ifd aside
};
struct Fleet {
  std::filesystem::path file, folder;
  std::vector<FleetPlant> plants;  ///< in order of their names
};
/// Reads a fleet file (configs/fleet/README.md). Throws InputError with every fault of the file. Whether the
/// files it names exist is told when their plant's turn comes, so that one that is missing does not stop the
/// others.
Fleet load_fleet(const std::filesystem::path& file);

}  // namespace swingbank::validate::fleet
