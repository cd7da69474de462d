#pragma once
// Several records of one plant, read, named and checked together, so that all that is wrong with any of them
// is told at once.
#include <functional>
#include <string>
#include <vector>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

struct RecordSet {
  std::vector<record::Record> records;  ///< in the order given
  std::vector<std::vector<std::string>>
      warnings;  ///< of each record: what reading it did, and findings that do not refuse it
};

/// The findings that warn, as sentences. Throws InputError with those that refuse.
std::vector<std::string> warnings_of(const std::vector<Finding>& findings);

/// Reads every file as a record of the plant, checks it, and sees to it that no two have the same name.
/// Throws InputError with the problems of all files.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model);
/// What is done to a record before it is checked: taken apart where several units stand behind its point.
using Preparing = std::function<record::Record(record::Record)>;
/// The same, but the problems join those that the caller has found already, who raises them. Where the model
/// could not be read and so has no machine, records are not checked.
RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model,
                       Problems& problems, const Preparing& prepare = {});

}  // namespace swingbank::validate::check
