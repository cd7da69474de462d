#pragma once
// Set of records of one plant, read and checked together, so that all problems are reported at once.
#include <functional>
#include <string>
#include <vector>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// Records of one command with their warnings.
struct RecordSet {
  std::vector<record::Record> records;  ///< in the order given
  std::vector<std::vector<std::string>>
      warnings;  ///< for each record: notes of its reader, and findings that do not refuse it
};

/// Returns the warnings among the findings as sentences. Throws InputError with the refusals.
std::vector<std::string> warnings_of(const std::vector<Finding>& findings);

/// Reads and checks every file as a record of the plant; names must be unique. Throws InputError with the
/// problems of all files.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model);
/// Transformation of a record before its check, such as the separation of one of several units behind a
/// point.
using Preparing = std::function<record::Record(record::Record)>;
/// Reads and checks every file, but adds problems to those of the caller, who raises them. Records are not
/// checked if the model could not be read and thus has no machine.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model,
                       Problems& problems, const Preparing& prepare = {});

}  // namespace swingbank::validate::check
