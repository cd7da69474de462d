#pragma once
// Output of `swingbank effects --coverage`: the share of .dyr records that the effects cover.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/json.hpp"
#include "sim/grid/coverage.hpp"

namespace swingbank::jobs {

inline void print_coverage_text(const sim::grid::Coverage& coverage) {
  fmt::print("{} records of {} models in {} file{}: {} covered ({:.1f} %)\n\n{:<12} {:>8} {:>8} {:>6}  {}\n",
             coverage.records, coverage.models.size(), coverage.files, coverage.files == 1 ? "" : "s",
             coverage.covered, coverage.percent(), "model", "records", "covered", "files", "read as");
  for (const auto& m : coverage.models)
    fmt::print("{:<12} {:>8} {:>8} {:>6}  {}\n", m.name, m.records, m.covered(), m.files,
               m.effect.empty() ? (m.missing_because.empty() ? "-" : "- (" + m.missing_because + ")")
                                : m.slot + " " + m.effect);
  for (const auto& m : coverage.models)
    if (m.refused > 0) fmt::print("\n{} x {} refused, for example: {}\n", m.refused, m.name, m.fault);
  if (!coverage.faults.empty()) fmt::print("\nno records\n");
  for (const auto& fault : coverage.faults) fmt::print("  {}\n", fault);
}

inline void print_coverage_json(const sim::grid::Coverage& coverage) {
  nlohmann::ordered_json j = {{"files", coverage.files},
                              {"records", coverage.records},
                              {"covered", coverage.covered},
                              {"percent", coverage.percent()},
                              {"models", nlohmann::ordered_json::array()},
                              {"faults", coverage.faults}};
  for (const auto& m : coverage.models)
    j["models"].push_back({{"name", m.name},
                           {"effect", m.effect},
                           {"slot", m.slot},
                           {"records", m.records},
                           {"covered", m.covered()},
                           {"refused", m.refused},
                           {"files", m.files},
                           {"fault", m.fault},
                           {"missing_because", m.missing_because},
                           {"first_place", m.first_place}});
  fmt::print("{}\n", j.dump(1));
}

/// Prints the coverage of the files as text or JSON. Returns the exit code.
inline int print_coverage(const std::vector<std::string>& dyr_files, bool json) {
  const auto coverage = sim::grid::take_coverage({dyr_files.begin(), dyr_files.end()});
  json ? print_coverage_json(coverage) : print_coverage_text(coverage);
  return 0;
}

}  // namespace swingbank::jobs
