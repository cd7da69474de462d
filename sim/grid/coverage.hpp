#pragma once
// Coverage of .dyr files by the compiled effects, model by model. It needs no .raw.
#include <filesystem>
#include <string>
#include <vector>

namespace swingbank::sim::grid {

/// Counts of one model over all records of all files.
struct ModelCoverage {
  std::string name;             ///< name in the files; for a user-written model, its own name
  std::string effect;           ///< effect that represents it, "" if the model is unknown
  std::string slot;             ///< slot of this effect
  int records = 0, files = 0;   ///< number of records, and of files that contain them
  int refused = 0;              ///< records of a known model with inadmissible values
  std::string fault;            ///< error of the first refused record
  std::string first_place;      ///< "FILE:LINE" of its first record
  std::string missing_because;  ///< reason for the missing effect, where known
  /// Returns the number of records that a known model accepts.
  [[nodiscard]] int covered() const { return effect.empty() ? 0 : records - refused; }
};

/// Coverage of several .dyr files.
struct Coverage {
  std::vector<ModelCoverage> models;        ///< most records first
  int files = 0, records = 0, covered = 0;  ///< totals
  std::vector<std::string> faults = {};     ///< messages about text that is not a record
  /// Returns the percentage of covered records; 100 without records.
  [[nodiscard]] double percent() const { return records == 0 ? 100.0 : 100.0 * covered / records; }
};

/// Counts the covered records of the files. Throws InputError that names every file that cannot be read.
Coverage take_coverage(const std::vector<std::filesystem::path>& dyr_files);

}  // namespace swingbank::sim::grid
