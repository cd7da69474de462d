#include "validate/check/record_set.hpp"

#include <algorithm>

#include "validate/check/readings.hpp"
#include "validate/playin/component.hpp"

namespace swingbank::validate::check {
namespace {

void add_all(const std::vector<Problem>& found, Problems& problems) {
  for (const Problem& p : found) problems.add(p.what, p.where, p.why, p.remedy);
}

void read_into(RecordSet& set, const std::string& file, const plant::PlantModel& model, Problems& problems,
               const Preparing& prepare) {
  record::Record record = record::read_staged(file, model.record_base, model.reading);
  if (prepare && model.plant.machine.effect != nullptr) record = prepare(std::move(record));
  if (std::ranges::find(set.records, record.name, &record::Record::name) != set.records.end())
    problems.add("two records named " + record.name, file, "their results would overwrite each other",
                 "rename one of them");
  std::vector<std::string> warnings = record.notes;
  if (model.plant.machine.effect != nullptr && !playin::is_recorded(model.plant) && !record.breaker()) {
    std::vector<Finding> findings = check_record(record, plant_facts(model));
    const auto says = [&](std::string_view kind) {
      return std::ranges::any_of(findings, [&](const Finding& f) { return f.kind == kind; });
    };
    if (std::ranges::none_of(findings, [](const Finding& f) { return f.severity == Severity::refuse; }))
      if (auto better = better_reading(record, model); better && !says(better->kind))
        findings.push_back(std::move(*better));
    for (const auto& [kind, severity, problem] : findings) {
      if (severity == Severity::refuse)
        add_all({problem}, problems);
      else
        warnings.push_back(problem.sentence());
    }
  }
  set.records.push_back(std::move(record));
  set.warnings.push_back(std::move(warnings));
}

}  // namespace

std::vector<std::string> warnings_of(const std::vector<Finding>& findings) {
  raise_refusals(findings);
  std::vector<std::string> warnings;
  for (const Finding& f : findings) warnings.push_back(f.problem.sentence());
  return warnings;
}

RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model) {
  Problems problems;
  RecordSet set = read_records(files, model, problems);
  problems.raise();
  return set;
}

RecordSet read_records(const std::vector<std::string>& files, const plant::PlantModel& model,
                       Problems& problems, const Preparing& prepare) {
  RecordSet set;
  for (const std::string& file : files) {
    try {
      read_into(set, file, model, problems, prepare);
    } catch (const InputError& error) {
      add_all(error.problems(), problems);
    }
  }
  return set;
}

}  // namespace swingbank::validate::check
