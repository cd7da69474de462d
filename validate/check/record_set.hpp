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
      warnings;  ///< for each record: notes of the reader and warnings of the checks
};

/// Returns the warnings among the findings as sentences. Throws InputError with the refusals, if there are
/// any.
std::vector<std::string> warnings_of(const std::vector<Finding>& findings);

/// Reads and checks every file as a record of the plant; names must be unique. Throws InputError with the
/// problems of all files.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model);
/// Transformation of a record before its check, for example the subtraction of the other units at a common
/// measuring point.
using Preparing = std::function<record::Record(record::Record)>;
/// Reads and checks every file. Adds the problems to those of the caller, who raises them. Records are not
/// checked if the model has no machine because its file could not be read.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model,
                       Problems& problems, const Preparing& prepare = {});

}  // namespace swingbank::validate::check
