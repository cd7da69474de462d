#pragma once
// Instants of switchings that a person knows (--switch), by the record to which they belong.
#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "validate/record/record.hpp"

namespace swingbank::jobs {

/// "2.0" holds for the only record, "event.csv=2.0" for the record of that name. Each record's instants come
/// in order [s]. `files`: the words of --records. Throws InputError with every word that is wrong.
inline std::map<std::string, std::vector<double>> told_instants(const std::vector<std::string>& words,
                                                                const std::vector<std::string>& files) {
  std::vector<std::string> records;
  for (const auto& file : files) records.push_back(validate::record::record_name(file));
  std::map<std::string, std::vector<double>> instants;
  Problems problems;
  for (const auto& word : words) {
    const auto equals = word.rfind('=');
    const std::string number = equals == std::string::npos ? word : word.substr(equals + 1);
    std::string record = equals == std::string::npos ? "" : word.substr(0, equals);
    if (equals == std::string::npos && records.size() == 1) record = records.front();
    double t = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), t);
    if (error != std::errc{} || end != number.data() + number.size())
      problems.add("'" + word + "'", "--switch", "it is no time in seconds",
                   "give --switch 2.0 or --switch FILE=2.0");
    else if (record.empty())
      problems.add("'" + word + "'", "--switch", "several records are given",
                   "say which one: --switch FILE=" + number);
    else if (std::ranges::find(records, record) == records.end())
      problems.add("record '" + record + "'", "--switch", "no --record has that file name",
                   "use the name without its folder");
    else
      instants[record].push_back(t);
  }
  problems.raise();
  for (auto& [record, all] : instants) std::ranges::sort(all);
  return instants;
}

}  // namespace swingbank::jobs
