#include "validate/switching/given.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/problem.hpp"

namespace swingbank::validate::switching {

std::map<std::string, std::vector<double>> given_switching_times(const std::vector<std::string>& words,
                                                                 const std::vector<std::string>& files) {
  std::vector<std::string> records;
  for (const auto& file : files) records.push_back(record::Source(file).name);
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
      problems.add("'" + word + "'", "--switch", "it is not a time in seconds",
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

std::vector<Switching> given_times(const record::Record& record) {
  std::vector<Switching> switchings;
  for (const double t : record.switched) switchings.push_back({.time = t});
  return switchings;
}

std::vector<Switching> breaker_times(const record::Record& record, const std::vector<Switching>& found) {
  const record::StagedEvent& breaker = *record.breaker();
  if (record.open_circuit()) return {};
  for (const Switching& s : found)
    if (std::abs(s.time - breaker.time) < kNearBreaker) return {s};
  // The power falls below half its initial value.
  constexpr double kLoaded = 0.01;  // [pu]: a smaller power is not conclusive
  for (std::size_t k = 0; k + 1 < record.t.size() && k + 1 < record.P.size(); ++k)
    if (std::abs(record.t[k] - breaker.time) < kNearBreaker && std::abs(record.P[0]) > kLoaded &&
        std::abs(record.P[k + 1]) < std::abs(record.P[0]) / 2)
      return {{.time = (record.t[k] + record.t[k + 1]) / 2, .uncertainty = record.step() / 2}};
  return {{.time = breaker.time, .uncertainty = record.step()}};
}

}  // namespace swingbank::validate::switching
