#include "validate/check/record_set.hpp"

#include <algorithm>

#include "validate/check/readings.hpp"
#include "validate/playin/component.hpp"

namespace swingbank::validate::check {
namespace {

void add_all(const std::vector<Problem>& found, Problems& problems) {
  for (const Problem& p : found) problems.add(p.what, p.where, p.why, p.remedy);
}

/// Reads and checks one file. Returns its findings.
std::vector<Finding> read_into(RecordSet& set, const std::string& file, const plant::PlantModel& model,
                               Problems& problems, const Preparing& prepare) {
  record::Record record = record::read_staged(file, model.record_base, model.reading);
  if (prepare && model.plant.machine.effect != nullptr) record = prepare(std::move(record));
  if (std::ranges::find(set.records, record.name, &record::Record::name) != set.records.end())
    problems.add("two records named " + record.name, file, "their results would overwrite each other",
                 "rename one of them");
  std::vector<Finding> findings;
  if (model.plant.machine.effect != nullptr && !playin::is_recorded(model.plant) && !record.breaker()) {
    findings = check_record(record, plant_facts(model));
    const auto says = [&](std::string_view kind) {
      return std::ranges::any_of(findings, [&](const Finding& f) { return f.kind == kind; });
    };
    if (std::ranges::none_of(findings, [](const Finding& f) { return f.severity == Severity::refuse; }))
      if (auto better = better_reading(record, model); better && !says(better->kind))
        findings.push_back(std::move(*better));
  }
  set.warnings.push_back(record.notes);
  set.records.push_back(std::move(record));
  return findings;
}

/// Records of one source have the same mistake in their columns. If a mistake explains the steps of all
/// records whose steps are inconsistent, it replaces the likeliest mistake of each record.
void agree(std::vector<std::vector<Finding>>& findings) {
  std::vector<Finding*> inconsistent;
  for (auto& of_record : findings)
    for (Finding& f : of_record)
      if (!f.explanations.empty()) inconsistent.push_back(&f);
  if (inconsistent.empty()) return;
  const auto in = [](const Finding& f, const Finding& explanation) {
    return std::ranges::find(f.explanations, explanation.problem.remedy,
                             [](const Finding& e) { return e.problem.remedy; });
  };
  for (const Finding& explanation : std::vector(inconsistent.front()->explanations))
    if (std::ranges::all_of(inconsistent,
                            [&](Finding* f) { return in(*f, explanation) != f->explanations.end(); })) {
      for (Finding* f : inconsistent) *f = Finding(*in(*f, explanation));
      return;
    }
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
  std::vector<std::vector<Finding>> findings;  // for each record of the set
  for (const std::string& file : files) {
    try {
      findings.push_back(read_into(set, file, model, problems, prepare));
    } catch (const InputError& error) {
      add_all(error.problems(), problems);
    }
  }
  agree(findings);
  for (std::size_t k = 0; k < findings.size(); ++k)
    for (const Finding& f : findings[k]) {
      if (f.severity == Severity::refuse)
        add_all({f.problem}, problems);
      else
        set.warnings[k].push_back(f.problem.sentence());
    }
  return set;
}

}  // namespace swingbank::validate::check
