#include "validate/thresholds/list.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>

#include "base/json.hpp"
#include "validate/thresholds/acceptance.hpp"

namespace swingbank::validate::thresholds {
namespace {

/// Appends the thresholds of one struct. The struct contains only thresholds, so it has the layout of an
/// array.
template <class Stage>
void add(const Stage& stage, std::vector<Threshold>& all) {
  static_assert(sizeof(Stage) % sizeof(Threshold) == 0);
  const auto records = std::bit_cast<std::array<Threshold, sizeof(Stage) / sizeof(Threshold)>>(stage);
  all.insert(all.end(), records.begin(), records.end());
}

}  // namespace

std::vector<Threshold> all_thresholds() {
  std::vector<Threshold> all;
  add(evidence, all);
  add(posterior, all);
  add(held_out, all);
  add(adequacy, all);
  add(noise, all);
  add(search, all);
  add(user_models, all);
  add(addition, all);
  add(parameters, all);
  add(movement, all);
  std::ranges::copy(preset_thresholds(), std::back_inserter(all));
  return all;
}

nlohmann::json thresholds_json() {
  auto all = nlohmann::json::array();
  for (const Threshold& t : all_thresholds())
    all.push_back({{"name", t.name}, {"value", t.value}, {"unit", t.unit}, {"why", t.why}});
  return all;
}

nlohmann::json ruling_json(const Ruling& ruling) {
  const CriterionRecord& r = criterion_record(ruling.by);
  nlohmann::json j = {{"criterion", r.name},   {"quantity", r.asks}, {"adequate", ruling.adequate},
                      {"limit", ruling.limit}, {"unit", r.unit},     {"where", ruling.where}};
  j["value"] = ruling.value;
  return j;
}

}  // namespace swingbank::validate::thresholds
