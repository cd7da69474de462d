#include "validate/plant/detail/staged.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validate/plant/unknown_keys.hpp"

namespace swingbank::validate::plant {
namespace {

using Kind = record::StagedEvent::Kind;

constexpr double kLatest = 1e5;      ///< largest magnitude of a time [s]
constexpr double kLargestStep = 10;  ///< largest step of a reference or of Efd [pu]

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (int k = 0; k < record::kStagedKinds; ++k)
    names.emplace_back(record::staged_name(static_cast<Kind>(k)));
  return names;
}

record::StagedEvent read_one(Config& config, const std::string& section) {
  record::StagedEvent e;
  const auto names = kind_names();
  const std::string kind =
      config.choice(section + ".kind", names, Range{.meaning = "kind of the staged test"});
  const auto at = std::ranges::find(names, kind);
  if (at == names.end()) return e;
  e.kind = static_cast<Kind>(at - names.begin());
  e.record = config.optional<std::string>(
      section + ".record", "", {.meaning = "file of the record of this test, if there are several records"});
  std::vector<std::string> known = {"kind", "record"};
  if (e.kind != Kind::open_circuit) {
    e.time = config.require<double>(section + ".time", {-kLatest, kLatest, "s", "time of the test"});
    known.emplace_back("time");
  }
  if (!e.opens_breaker()) {
    e.size =
        config.require<double>(section + ".size", {-kLargestStep, kLargestStep, "pu", "size of the step"});
    known.insert(known.end(), {"size", "until"});
    if (config.has(section + ".until"))
      e.until = config.require<double>(
          section + ".until", {-kLatest, kLatest, "s", "end of the step; if missing, the step is permanent"});
    if (config.sound() && !(e.until > e.time))
      config.problem(section + ".until", fmt::format("until = {:g} s with time = {:g} s", e.until, e.time),
                     "a step must end after it begins", "give until > time, or omit it for a permanent step");
  }
  refuse_unknown_keys(config, section, "a " + kind, known);
  return e;
}

}  // namespace

std::vector<record::StagedEvent> read_staged_events(Config& config) {
  std::vector<record::StagedEvent> events;
  if (!config.has("event")) return events;
  config.ignore("event");  // its keys are checked above
  if (!config.is_array("event")) {
    config.problem("event", "[event] is a single table", "staged events are a list of tables",
                   "write [[event]]");
    return events;
  }
  for (int k = 0; config.has(fmt::format("event[{}]", k)); ++k)
    events.push_back(read_one(config, fmt::format("event[{}]", k)));
  return events;
}

std::string staged_text(const std::vector<record::StagedEvent>& events,
                        std::string (*quoted)(std::string_view), std::string (*number)(double)) {
  std::string text;
  for (const auto& e : events) {
    text += fmt::format("\n[[event]]\nkind = \"{}\"\n", record::staged_name(e.kind));
    if (!e.record.empty()) text += fmt::format("record = {}\n", quoted(e.record));
    if (e.kind != Kind::open_circuit) text += fmt::format("time = {}  # [s]\n", number(e.time));
    if (!e.opens_breaker()) text += fmt::format("size = {}  # [pu]\n", number(e.size));
    if (std::isfinite(e.until)) text += fmt::format("until = {}  # [s]\n", number(e.until));
  }
  return text;
}

}  // namespace swingbank::validate::plant
