#include "validate/compare/played.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/in_parallel.hpp"
#include "base/json.hpp"

namespace swingbank::validate::compare {

const ChannelComparison* find_channel(const Played* played, std::size_t event, const std::string& name) {
  if (!played || event >= played->events.size()) return nullptr;
  const auto& channels = played->events[event].channels;
  const auto c = std::ranges::find(channels, name, &ChannelComparison::name);
  return c == channels.end() ? nullptr : &*c;
}

Played play_and_judge(std::string name, const plant::PlantModel& model,
                      const std::vector<Measurement>& records, CompareOptions options,
                      const thresholds::Acceptance& by) {
  Played played{std::move(name), {}, {}};
  const double mva = model.plant.mva;
  try {
    const event::Progress progress = std::exchange(options.progress, {});
    const int total = static_cast<int>(records.size());
    std::vector<EventComparison> events(records.size());
    in_parallel(
        records.size(), [&](std::size_t k) { events[k] = compare_event(model, records[k], options); },
        [&](int done, std::size_t k) {
          if (progress) progress(event::Phase::playing, records[k].record().name, done, total);
        });
    played.events = std::move(events);
    judge(played.events);  // sets the bounds of the maps
    played.fitness = judge_fitness(played.events, mva, by);
  } catch (const InputError& error) {
    played.events.clear();
    played.fitness = not_judged(by, mva, error.problems().front().sentence());
  }
  return played;
}

const std::vector<EventComparison>& followed_events(const std::vector<Played>& played) {
  static const std::vector<EventComparison> none;
  const auto first = std::ranges::find_if(played, [](const Played& p) { return !p.events.empty(); });
  return first == played.end() ? none : first->events;
}

std::vector<record::Record> power_only(std::vector<record::Record> records) {
  for (auto& r : records)
    if (r.component == record::Component::plant) r.speed = r.Efd = r.Ifd = {};
  return records;
}

std::string fitness_text(const std::vector<Played>& played) {
  std::string text;
  for (auto p = played.rbegin(); p != played.rend(); ++p)
    text += fmt::format("{}: {}\n", p->name, p->fitness.sentence);
  return text;
}

nlohmann::json fitness_json(const std::vector<Played>& played) {
  nlohmann::json all = nlohmann::json::object();
  for (const Played& p : played) all[p.name] = fitness_json(p.fitness);
  return all;
}

}  // namespace swingbank::validate::compare
