#include "validate/calibrate/network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/durable.hpp"
#include "base/inputs_kept.hpp"
#include "base/json.hpp"
#include "sim/plant/usual.hpp"

namespace swingbank::validate::calibrate {
namespace {

using nlohmann::json;

constexpr double kBridged = 3.0;  ///< largest distance from the training range [prior standard deviations]

NetworkEstimate parse(const json& j, const std::filesystem::path& file) {
  NetworkEstimate e;
  e.file = file.string();
  const json& n = j.at("network");
  e.network = n.at("file");
  e.kind = n.at("kind");
  e.machine = n.at("machine_model");
  e.dataset = n.at("dataset");
  for (const json& p : j.at("parameters"))
    e.parameters.push_back({p.at("name"), p.at("effect"), p.at("unit"), p.at("estimate"), p.at("spread"),
                            p.at("scatter"), p.at("low"), p.at("high")});
  for (const json& r : j.at("records"))
    e.records.push_back({r.at("file"), r.at("sha256"), r.value("estimates", std::vector<double>())});
  return e;
}

/// Returns whether `value` is within kBridged prior standard deviations (`prior_sd`, relative) of [low,
/// high].
bool within_reach(double value, double low, double high, double prior_sd) {
  const double reach = kBridged * prior_sd * std::abs(value);
  return value == 0 || (value + reach >= low - 1e-9 && value - reach <= high + 1e-9);
}

}  // namespace

NetworkEstimate read_estimate(const std::filesystem::path& file) {
  note_input(file);
  const json j = json::parse(read_text(file), nullptr, false);
  if (j.is_object() && j.value("format", "") == "swingbank-estimate-2") {
    try {
      return parse(j, file);
    } catch (const json::exception&) {  // reported below
    }
  }
  throw InputError({"no estimate of a network", file.string(), "it is not an output file of predict",
                    "make one with 'swingbank predict --out FILE'"});
}

sim::plant::Plant estimated_plant(const NetworkEstimate& estimate, const plant::PlantModel& model,
                                  double prior_sd) {
  Problems problems;
  sim::plant::Plant plant = model.plant;
  const auto machine = std::string(plant.machine.effect->name);
  if (machine != estimate.machine) {
    problems.add("a plant with " + machine, model.origin,
                 "the network " + estimate.network + " was trained on " + estimate.machine,
                 "give a network trained on the plant's machine model");
    problems.raise();
  }
  std::string absent;
  for (const auto& p : estimate.parameters) {
    const sim::Effect* effect = model.library.find(p.effect);
    const auto block = effect ? sim::plant::find_block(plant, *effect) : std::nullopt;
    if (!block) {
      if (absent.find(p.effect) == std::string::npos) absent += (absent.empty() ? "" : ", ") + p.effect;
      continue;
    }
    const int index = effect->parameter_index(p.plain());
    if (index < 0) {
      problems.add("parameter " + p.full(), estimate.network, p.effect + " has no such parameter",
                   "train a network with this version");
      continue;
    }
    double& value = sim::plant::parameter_value(plant, {*block, index});
    if (!within_reach(value, p.low, p.high, prior_sd)) {
      const std::string learnt = p.learnt() ? fmt::format("was trained on {:g} to {:g}", p.low, p.high)
                                            : fmt::format("has the fixed value {:g}", p.low);
      problems.add(
          fmt::format("{} = {:g} {}", p.full(), value, p.unit), model.origin,
          fmt::format("the network {} {}, and the model's value is more than {:g} x --prior-sd away",
                      estimate.network, learnt, kBridged),
          "train a network about this plant (swingbank add --retrain shows how), or widen --prior-sd");
      continue;
    }
    const auto [low, high] =
        sim::plant::search_range(sim::plant::parameter_record(plant, {*block, index}), value);
    if (p.learnt()) value = std::clamp(p.value, low, high);
  }
  if (!absent.empty())
    problems.add("a plant without " + absent, model.origin,
                 "the network " + estimate.network + " was trained on plants with it",
                 "add it to the model ('swingbank add'), or give a network trained without it");
  problems.raise();
  return plant;
}

void require_unseen(const NetworkEstimate& estimate, const std::vector<record::Record>& records,
                    const std::vector<bool>& held_out) {
  Problems problems;
  for (std::size_t k = 0; k < records.size(); ++k)
    if (held_out[k] &&
        std::ranges::count(estimate.records, records[k].sha256, &NetworkEstimate::Seen::sha256) > 0)
      problems.add("an estimate from " + records[k].name, estimate.file, "that event is held out",
                   "estimate from the other events, or do not hold this one out");
  problems.raise();
}

}  // namespace swingbank::validate::calibrate
