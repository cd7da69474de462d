#pragma once
// Switching times given by the user (--switch), by record.
#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "validate/record/record.hpp"

namespace swingbank::jobs {

/// Returns the switching times [s] of each record, in ascending order. `words`: values of --switch, "2.0" for
/// the only record or "event.csv=2.0" for a named one; `files`: values of --records. Throws InputError with
/// every invalid word.
inline std::map<std::string, std::vector<double>> given_switching_times(
    const std::vector<std::string>& words, const std::vector<std::string>& files) {
  std::vector<std::string> records;
  for (const auto& file : files) records.push_back(validate::record::record_name(file));
  std::map<std::string, std::vector<double>> switching_times;
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
                   "name one: --switch FILE=" + number);
    else if (std::ranges::find(records, record) == records.end())
      problems.add("record '" + record + "'", "--switch", "no --record has that file name",
                   "use the name without its folder");
    else
      switching_times[record].push_back(t);
  }
  problems.raise();
  for (auto& [record, all] : switching_times) std::ranges::sort(all);
  return switching_times;
}

}  // namespace swingbank::jobs
