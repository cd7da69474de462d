#include "train/loop/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/config.hpp"
#include "train/direct/direct.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::loop {
namespace {

const std::vector<std::string> kSchedules = {"constant", "cosine"};
const Range kNoiseLevels = {0.0, 0.1};  // at more, a phasor is no measurement

std::vector<std::string> network_names() {
  std::vector<std::string> names;
  for (const auto& record : networks::all_networks()) names.emplace_back(record.name);
  names.insert(names.end(), direct::kMethods.begin(), direct::kMethods.end());
  return names;
}

std::size_t count(Config& c, const std::string& key, double low) {
  return static_cast<std::size_t>(c.require<std::int64_t>(key, {low, 1e12}));
}

TrainingRecipe read_training(Config& c, const std::string& at) {
  TrainingRecipe t;
  t.epochs = count(c, at + ".epochs", 1);
  t.batch = count(c, at + ".batch", 1);
  t.learning_rate = c.require<double>(at + ".learning_rate", {1e-8, 1.0});
  t.schedule = c.choice(at + ".schedule", kSchedules);
  t.patience = count(c, at + ".patience", 1);
  t.validation_share = c.require<double>(at + ".validation_share", {0.01, 0.5});
  return t;
}

/// A table named after a network changes what stands in it for that network only.
TrainingRecipe override_training(Config& c, const std::string& at, TrainingRecipe t) {
  const auto whole = [&](const char* key, std::size_t& value) {
    value = static_cast<std::size_t>(
        c.optional<std::int64_t>(at + key, static_cast<std::int64_t>(value), {1, 1e12}));
  };
  whole(".epochs", t.epochs);
  whole(".batch", t.batch);
  whole(".patience", t.patience);
  t.learning_rate = c.optional<double>(at + ".learning_rate", t.learning_rate, {1e-8, 1.0});
  t.schedule = c.choice(at + ".schedule", kSchedules, t.schedule);
  return t;
}

Preset read_preset(Config& c, const std::string& name) {
  const std::string at = "preset." + name;
  Preset p;
  p.name = name;
  p.draws = count(c, at + ".draws", 1);
  p.networks = c.require<std::vector<std::string>>(at + ".networks");
  p.noise = c.require<std::vector<double>>(at + ".noise", kNoiseLevels);
  p.input.channels = c.require<std::vector<std::string>>(at + ".channels");
  p.input.start_s = c.require<double>(at + ".start_s", {0.0, 1e6, "s"});
  p.input.end_s = c.require<double>(at + ".end_s", {0.0, 1e6, "s"});
  p.input.slice = count(c, at + ".slice", 1);
  const auto form = c.choice(at + ".form", data::kInputForms);
  p.input.form = static_cast<data::InputForm>(
      std::find(data::kInputForms.begin(), data::kInputForms.end(), form) - data::kInputForms.begin());
  p.pca_components = count(c, at + ".pca_components", 0);
  const TrainingRecipe common = read_training(c, at);
  const auto known = network_names();
  for (const auto& network : p.networks) {
    if (std::find(known.begin(), known.end(), network) == known.end())
      c.problem(at + ".networks", fmt::format("no network called '{}'", network),
                "train/networks has no such file", fmt::format("choose among {}", fmt::join(known, ", ")));
    p.training[network] = override_training(c, at + "." + network, common);
  }
  return p;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& file) {
  Config c(file);
  Experiment e;
  e.file = file;
  e.table = c.has("table") ? c.choice("table", {"IV", "V", "VI"}) : file.stem().string();
  e.title = c.require<std::string>("title");
  e.dataset = c.file("dataset");
  e.leave_one_out =
      c.choice("split", {"leave-one-generator-out", "by-databank-point"}) == "leave-one-generator-out";
  if (e.leave_one_out)
    for (const auto g : c.require<std::vector<std::int64_t>>("folds", {1, 1e9}))
      e.folds.push_back(static_cast<std::int32_t>(g));
  for (const auto& name : c.keys("preset")) e.presets[name] = read_preset(c, name);
  if (e.presets.empty())
    c.problem("preset", "no preset", "an experiment needs at least one", "add [preset.quick]");
  c.raise();
  return e;
}

const Preset& Experiment::preset(const std::string& name) const {
  const auto found = presets.find(name);
  if (found != presets.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [key, value] : presets) names.push_back(key);
  throw InputError({fmt::format("no preset called '{}'", name), "--preset",
                    fmt::format("{} has {}", file.string(), fmt::join(names, ", ")), "choose one of these"});
}

const TrainingRecipe& Experiment::training(const std::string& preset_name, const std::string& network) const {
  const Preset& p = preset(preset_name);
  const auto found = p.training.find(network);
  if (found != p.training.end()) return found->second;
  throw InputError(
      {fmt::format("network '{}' is not in this experiment", network), "--network",
       fmt::format("preset {} of {} trains {}", preset_name, file.string(), fmt::join(p.networks, ", ")),
       "choose one of these or add it to the preset's networks"});
}

std::string Experiment::print(const std::string& preset_name, const std::string& what) const {
  const Preset& p = preset(preset_name);
  if (what == "table") return table;
  if (what == "dataset") return dataset.string();
  if (what == "draws") return std::to_string(p.draws);
  if (what == "networks") return fmt::format("{}", fmt::join(p.networks, "\n"));
  if (what == "noise") return fmt::format("{}", fmt::join(p.noise, "\n"));
  if (what == "folds") return folds.empty() ? "none" : fmt::format("{}", fmt::join(folds, "\n"));
  throw InputError({fmt::format("'{}' cannot be printed", what), "--print", "an experiment has no such entry",
                    "choose among table, dataset, draws, networks, noise, folds"});
}

}  // namespace swingbank::train::loop
