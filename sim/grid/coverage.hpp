#pragma once
// How much of .dyr files the compiled effects cover, model by model, without their .raw.
#include <filesystem>
#include <string>
#include <vector>

namespace swingbank::sim::grid {

/// One model over all records of all files.
struct ModelCoverage {
  std::string name;    ///< as the files have it; of a user-written model its own name
  std::string effect;  ///< the effect that it is read as, "" if it is not known
  std::string slot;    ///< that effect's slot
  int records = 0, files = 0;
  int refused = 0;              ///< records of a known model with values that it does not take
  std::string fault;            ///< what is wrong with the first of these
  std::string first_place;      ///< "FILE:LINE" of its first record
  std::string missing_because;  ///< why there is no effect, where that is known
  [[nodiscard]] int covered() const { return effect.empty() ? 0 : records - refused; }
};

struct Coverage {
  std::vector<ModelCoverage> models;  ///< most records first
  int files = 0, records = 0, covered = 0;
  std::vector<std::string> faults = {};  ///< sentences: what in the files is no record
  [[nodiscard]] double percent() const { return records == 0 ? 100.0 : 100.0 * covered / records; }
};

/// Throws InputError with every file that cannot be read at all.
Coverage take_coverage(const std::vector<std::filesystem::path>& dyr_files);

}  // namespace swingbank::sim::grid
