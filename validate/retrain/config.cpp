// Dataset and experiment configs of the two networks, derived from the user's dataset config.
#include "base/config.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/durable.hpp"
#include "base/write_file.hpp"
#include "validate/retrain/retrain.hpp"

namespace swingbank::validate::retrain {
namespace {

namespace fs = std::filesystem;

constexpr double kDecided = 0.5;  ///< minimum reduction of a varied parameter's variance by the records
constexpr int kLongestWindow = 8, kShortestWindow = 2;  ///< time window of the networks [s]
constexpr int kComponents = 4;                          ///< principal components per second

/// Rounds to `digits` significant digits, so that a fit repeated on another machine gives the same config.
double rounded(double value, int digits) { return std::stod(fmt::format("{:.{}g}", value, digits)); }

toml::table read_base(const fs::path& file) {
  static_cast<void>(Config(file));  // throws if the file is not TOML
  return toml::parse(read_text(file), file.string());
}

class Base {
 public:
  Base(const fs::path& config, const add::Addition& added) : file_(config), table_(read_base(file_)) {
    Problems problems;
    const auto say = [&](const std::string& what, const std::string& why, const std::string& remedy) {
      problems.add(what, file_.string(), why, remedy);
    };
    for (const char* key : {"raw", "dyr"}) {
      const auto path = table_[key].value<std::string>();
      if (!path)
        say(std::string("no ") + key, "a dataset needs a grid", "see configs/datasets/README.md");
      else
        table_.insert_or_assign(key, fs::absolute(file_.parent_path() / *path).lexically_normal().string());
    }
    if (auto* user_models = table_["user_models"].as_array())
      for (auto& user_model : *user_models)
        if (const auto path = user_model.value<std::string>())
          user_model.ref<std::string>() =
              fs::absolute(file_.parent_path() / *path).lexically_normal().string();
    const auto machine = std::string(added.model.plant.machine.effect->name);
    const auto model = table_.at_path("vary.model").value_or(std::string());
    if (model != machine)
      say("vary.model = '" + model + "'", "the plant is a " + machine, "give a dataset about this plant");
    if (const auto* buses = table_.at_path("vary.generators").as_array())
      for (const auto& bus : *buses) plants_.push_back(std::to_string(bus.value_or(0)));
    if (plants_.empty())
      say("no vary.generators", "the effect is attached to the generators that vary", "name the plant's bus");
    if (table_.at_path("vary.box").as_table() == nullptr)
      say("no [vary.box]", "networks learn only parameters that vary",
          "give intervals of the machine's parameters");
    problems.raise();
  }
  [[nodiscard]] const toml::table& table() const { return table_; }
  [[nodiscard]] const std::vector<std::string>& plants() const { return plants_; }
  [[nodiscard]] double fault_start() const { return table_.at_path("fault.start").value_or(2.0); }

 private:
  fs::path file_;
  toml::table table_;
  std::vector<std::string> plants_;
};

/// Returns the table at a path of names below `root`; missing tables are created.
toml::table& below(toml::table& root, const std::vector<std::string>& names) {
  toml::table* at = &root;
  for (const auto& name : names) {
    if (!(*at)[name].is_table()) at->insert_or_assign(name, toml::table{});
    at = (*at)[name].as_table();
  }
  return *at;
}

/// Returns the entry of `attach` "2:SEXS:TAoverTB=0.1,…" with the fitted values.
std::string attachment(const std::string& plant, const sim::plant::Block& block) {
  std::string text = plant + ":" + std::string(block.effect->name);
  for (std::size_t i = 0; i < block.p.size(); ++i)
    text +=
        fmt::format("{}{}={}", i == 0 ? ":" : ",", block.effect->parameters[i].name, rounded(block.p[i], 6));
  return text;
}

/// Returns the block that the hypothesis added; nullptr if the hypothesis only set parameters.
const sim::plant::Block* added_block(const add::Addition& added) {
  if (added.hypothesis.slot < 0) return nullptr;
  const auto slot = static_cast<sim::Slot>(added.hypothesis.slot);
  const sim::plant::Plant& plant = added.model.plant;
  if (plant.transformer.effect != nullptr && slot == sim::Slot::transformer) return &plant.transformer;
  const sim::plant::Block* found = nullptr;
  for (const auto& block : plant.controls)
    if (block.effect->slot == slot) found = &block;  // the added block is the last one of its slot
  return found;
}

void add_effect_to(toml::table& dataset, const Base& base, const add::Addition& added,
                   const RetrainOptions& options) {
  if (added.hypothesis.replaces)
    throw InputError(
        {"effect " + added.hypothesis.name, "--retrain",
         "retraining compares a network with and one without an added effect; this one replaces another",
         "give a plant file that already contains it"});
  const sim::plant::Block* block = added_block(added);
  if (block != nullptr) {
    if (!dataset["attach"].is_array()) dataset.insert_or_assign("attach", toml::array{});
    for (const auto& plant : base.plants())
      dataset["attach"].as_array()->push_back(attachment(plant, *block));
    if (!dataset["user_models"].is_array()) dataset.insert_or_assign("user_models", toml::array{});
    for (const auto& user_model : added.model.user_models)
      dataset["user_models"].as_array()->push_back(fs::absolute(user_model).lexically_normal().string());
    if (dataset["user_models"].as_array()->empty()) dataset.erase("user_models");
  }
  const auto machine = std::string(added.model.plant.machine.effect->name);
  for (int i = 0; i < added.own; ++i) {
    const auto& p = added.parameters[static_cast<std::size_t>(i)];
    const auto& record = sim::plant::parameter_record(added.model.plant, p.where.id);
    auto& box =
        p.block == machine ? below(dataset, {"vary", "box"}) : below(dataset, {"vary", "effects", p.block});
    const double value = rounded(p.value, 6);
    if (p.decided < kDecided || p.at_bound || value == 0) {
      if (p.block == machine) box.insert_or_assign(p.name, value);
      continue;
    }
    const double one = value / options.range, other = value * options.range;
    const double low = std::max(record.low, std::min(one, other)),
                 high = std::min(record.high, std::max(one, other));
    box.insert_or_assign(p.name, toml::array{rounded(low, 4), rounded(high, 4)});
  }
  if (block == nullptr && added.own == 0)
    throw InputError({"effect " + added.hypothesis.name, "--retrain", "a dataset cannot contain this effect",
                      "add it without --retrain"});
}

/// Returns the channels that both networks read.
std::vector<std::string> channels_of(const add::Addition& added, const std::vector<record::Record>& records) {
  std::vector<std::string> channels = {"P", "Q", "V", "frequency"};
  const auto all = [&](auto member) {
    return std::ranges::all_of(records, [&](const record::Record& r) { return !(r.*member).empty(); });
  };
  const auto compared = [&](playin::Output o) {
    return !added.prepared.empty() && std::ranges::count(added.prepared.front().channels, o) > 0;
  };
  if (compared(playin::Output::speed) && all(&record::Record::speed)) channels.emplace_back("speed");
  if (compared(playin::Output::Ifd) && all(&record::Record::Ifd)) channels.emplace_back("Ifd");
  return channels;
}

/// Returns the number of whole seconds that every record contains after its event, at most kLongestWindow.
/// Throws InputError if it is below kShortestWindow.
int seconds_of(const add::Addition& added) {
  double least = kLongestWindow;
  Problems problems;
  for (const auto& e : added.prepared) {
    const double event = e.switchings.empty() ? e.record.t[static_cast<std::size_t>(e.start.samples - 1)]
                                              : e.switchings.front().time;
    const double left = e.record.t.back() - event - e.record.step();
    if (left < kShortestWindow)
      problems.add(fmt::format("the record ends {:.3g} s after its event", left), e.record.name,
                   fmt::format("networks read {} s or more", kShortestWindow), "give a longer record");
    least = std::min(least, left);
  }
  problems.raise();
  return static_cast<int>(least);
}

std::string experiment_text(const std::string& title, const std::vector<std::string>& channels, double start,
                            int seconds, const RetrainOptions& o) {
  std::string list;
  for (const auto& c : channels) list += (list.empty() ? "\"" : ", \"") + c + "\"";
  return fmt::format(
      "# Written by swingbank add --retrain.\n"
      "title = \"{}\"\n"
      "dataset = \"dataset.toml\"\n"
      "split = \"by-databank-point\"\n"
      "\n"
      "[preset.retrain]\n"
      "draws = {}\n"
      "networks = [\"{}\"]\n"
      "noise = [0.0]\n"
      "channels = [{}]\n"
      "start_s = {}\n"
      "end_s = {}\n"
      "slice = 1\n"
      "form = \"both\"\n"
      "pca_components = {}\n"
      "epochs = {}\n"
      "batch = 64\n"
      "learning_rate = 1e-3\n"
      "schedule = \"cosine\"\n"
      "patience = {}\n"
      "validation_share = 0.1\n",
      title, o.draws, o.network, list, start, start + seconds, kComponents, o.epochs, o.epochs);
}

}  // namespace

std::array<RetrainSide, 2> write_retrain_configs(const fs::path& folder, const plant::PlantModel& before,
                                                 const add::Addition& added,
                                                 const std::vector<record::Record>& records,
                                                 const RetrainOptions& options) {
  const fs::path config = options.dataset.empty() ? write_plant_grid(folder / "grid", before,
                                                                     added.prepared.front(), options.range)
                                                  : options.dataset;
  const Base base(config, added);
  const auto channels = channels_of(added, records);
  const int seconds = seconds_of(added);
  const double start = base.fault_start();
  double rate = 60;
  for (const auto& r : records) rate = std::min(rate, std::floor(r.rate() + 1e-6));
  std::array<RetrainSide, 2> sides;
  for (std::size_t k = 0; k < 2; ++k) {
    RetrainSide& side = sides[k];
    side.name = k == 0 ? "without" : "with";
    side.folder = folder / side.name;
    side.dataset = side.folder / "dataset.toml";
    side.experiment = side.folder / (side.name + ".toml");  // results are named after this file
    side.data = side.folder / "data";
    side.results = side.folder / "results";
    toml::table dataset = base.table();
    dataset.insert_or_assign("draws", static_cast<std::int64_t>(options.draws));
    dataset.insert_or_assign("draws_per_shard", 500);
    dataset.insert_or_assign("seed", static_cast<std::int64_t>(options.seed));
    toml::table record{{"t_end", start + seconds + 1},
                       {"rate", rate},
                       {"frequency_washout", 0.1},
                       {"frequency_filter", 0.02}};
    toml::array list;
    for (const auto& c : channels) list.push_back(c);
    record.insert("channels", list);
    dataset.insert_or_assign("record", record);
    below(dataset, {"fault"}).insert_or_assign("start", start);
    if (k == 1) add_effect_to(dataset, base, added, options);
    std::ostringstream text;
    text << "# Written by swingbank add --retrain from " << config.filename().string() << ".\n"
         << dataset << "\n";
    write_file(side.dataset, text.str());
    write_file(side.experiment,
               experiment_text(added.model.name + ", " + side.name + " " + added.hypothesis.name, channels,
                               rounded(start, 9), seconds, options));
  }
  return sides;
}

}  // namespace swingbank::validate::retrain
