#include "train/loop/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "train/direct/direct.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::loop {
namespace {

const std::vector<std::string> kSchedules = {"constant", "cosine"};
// Range of noise levels. A phasor with more than 10 % noise is not a useful measurement.
const Range kNoiseLevels = {0.0, 0.1, "", "levels of measurement noise, one run each"};
constexpr double kLeastShare = 1e-3;  // smallest share of the training rows

std::vector<std::string> network_names() {
  std::vector<std::string> names;
  for (const auto& record : networks::all_networks()) names.emplace_back(record.name);
  names.insert(names.end(), direct::kMethods.begin(), direct::kMethods.end());
  return names;
}

/// Treatment of a missing key: `refused` is a problem, `standard` uses a default, `inherited` uses the
/// preset's value (in a network's table).
enum class Missing { refused, standard, inherited };

/// Table of a preset. If the preset copies another preset (`like`), a key that this table lacks is read from
/// the table of the same name in the other preset.
class Table {
 public:
  Table(const Config& c, std::string at, std::optional<std::string> copied)
      : c_(c), at_(std::move(at)), copied_(std::move(copied)) {}
  [[nodiscard]] Table of(const std::string& name) const {
    return {c_, at_ + "." + name, unknown() ? copied_ : std::optional(*copied_ + "." + name)};
  }
  /// Whether a key must be read: it is present, or no other table can have it.
  [[nodiscard]] bool reads(const std::string& key) const { return !copied_ || c_.has(path(key)); }
  /// Returns the path of a key.
  [[nodiscard]] std::string path(const std::string& key) const {
    const std::string own = at_ + "." + key;
    if (unknown() || c_.has(own)) return own;
    const std::string other = *copied_ + "." + key;
    return c_.has(other) ? other : own;
  }

 private:
  /// Whether there is no other table: none is copied, or its name is empty (as while a schema is derived).
  [[nodiscard]] bool unknown() const { return !copied_ || copied_->empty(); }

  const Config& c_;
  std::string at_;
  std::optional<std::string> copied_;
};

/// Reader of the keys of one table.
class Keys {
 public:
  Keys(Config& c, Table at, Missing missing) : c_(c), at_(std::move(at)), missing_(missing) {}
  void whole(const char* key, double low, std::size_t& value, const char* meaning) {
    auto read = static_cast<std::int64_t>(value);
    one(key, {low, 1e12, "", meaning}, read);
    value = static_cast<std::size_t>(read);
  }
  void number(const char* key, const Range& range, double& value) { one(key, range, value); }
  void choice(const char* key, const std::vector<std::string>& choices, std::string& value,
              const char* meaning) {
    if (missing_ == Missing::inherited ? c_.has(name(key)) : at_.reads(key))
      value = c_.choice(name(key), choices, Range{.meaning = meaning});
  }
  void flag(const char* key, bool& value, const char* meaning) { one(key, {.meaning = meaning}, value); }
  void names(const char* key, std::vector<std::string>& value, const char* meaning) {
    one(key, {.meaning = meaning}, value);
  }
  void numbers(const char* key, const Range& range, std::vector<double>& value) { one(key, range, value); }

 private:
  [[nodiscard]] std::string name(const char* key) const { return at_.path(key); }
  template <class T>
  void one(const char* key, const Range& range, T& value) {
    if (missing_ == Missing::standard)
      value = c_.optional<T>(name(key), value, range);
    else if (missing_ == Missing::refused ? at_.reads(key) : c_.has(name(key)))
      value = c_.require<T>(name(key), range);
  }
  Config& c_;
  Table at_;
  Missing missing_;
};

/// Return the treatment of missing keys with and without a default, in a preset (`complete`) or in a
/// network's table.
Missing default_of(bool complete) { return complete ? Missing::standard : Missing::inherited; }
Missing required_of(bool complete) { return complete ? Missing::refused : Missing::inherited; }

void read_training(Config& c, const Table& at, bool complete, TrainingRecipe& t) {
  Keys k(c, at, required_of(complete));
  k.whole("epochs", 1, t.epochs, "epochs of training");
  k.whole("batch", 1, t.batch, "rows per training step");
  k.number("learning_rate", {1e-8, 1.0, "", "learning rate of Adam"}, t.learning_rate);
  k.choice("schedule", kSchedules, t.schedule, "schedule of the learning rate");
  k.whole("patience", 1, t.patience, "epochs without a better validation error before stopping");
  if (complete)
    k.number("validation_share", {0.01, 0.5, "", "fraction of the databank samples used for validation"},
             t.validation_share);
  Keys extra(c, at, default_of(complete));
  extra.number("loss_power",
               {0.0, 1.0, "", "weight of a parameter's squared scaled error: its variance to this power"},
               t.loss_power);
  extra.number("weight_decay", {0.0, 1.0, "", "decoupled weight decay of matrices"}, t.weight_decay);
  extra.number("clip", {0.0, 1e6, "", "largest norm of the gradient; 0: no limit"}, t.clip);
  extra.number("average", {0.0, 0.99999, "", "decay factor of the averaged weights per step"}, t.average);
  extra.flag("training_rows", t.training_rows, "train on the rows of training_dataset too");
  extra.whole("posterior_epochs", 0, t.posterior_epochs, "epochs of the posterior head; 0: none");
  extra.whole("set_aside", 0, t.set_aside, "number of generators whose rows calibrate the posterior only");
}

/// Reads the noise levels of the training. A network trained at many levels needs the level as an input; only
/// the forms "physics" and "swing" provide it.
void read_noise_levels(Config& c, const Table& at, TrainingRecipe& t, NetworkInput& input) {
  if (const std::string name = at.path("training_noise"); c.has(name)) {
    const auto range = c.require<std::vector<double>>(
        name, {1e-6, kNoiseLevels.high, "",
               "[lowest, highest] level of noise, drawn for every row in every epoch"});
    const auto zero =
        c.require<double>(at.path("training_noise_zero"), {0.0, 1.0, "", "share of rows without noise"});
    if (range.size() != 2 || range[0] >= range[1])
      c.problem(name, "invalid range of noise levels",
                "it must be [lowest, highest] with 0 < lowest < highest", "give for example [0.0001, 0.005]");
    else
      t.noise_levels = {range[0], range[1], zero};
  }
  input.recipe.shows_level = t.noise_levels.has_value();
  if (t.noise_levels && input.recipe.form != data::InputForm::physics &&
      input.recipe.form != data::InputForm::swing)
    c.problem(at.path("form"), "training_noise with this form",
              "the noise level is an input, which only the forms physics and swing have",
              "choose one of these, or leave training_noise out");
  if ((t.kind == "swing") != (input.recipe.form == data::InputForm::swing))
    c.problem(at.path("form"), fmt::format("network {} with the wrong form", t.kind),
              "the network swing requires the form swing, and no other network accepts that form",
              "set form = \"swing\" for the network swing only");
}

void read_input(Config& c, const Table& at, bool complete, NetworkInput& i) {
  Keys k(c, at, required_of(complete));
  k.names("channels", i.recipe.channels, "channels of the dataset that the network reads");
  k.number("start_s", {0.0, 1e6, "s", "start of the window"}, i.recipe.start_s);
  k.number("end_s", {0.0, 1e6, "s", "end of the window, excluded"}, i.recipe.end_s);
  k.whole("slice", 1, i.recipe.slice, "every slice-th sample is kept");
  std::string form = data::kInputForms.at(static_cast<std::size_t>(i.recipe.form));
  k.choice("form", data::kInputForms, form, "form of the input");
  if (const auto at_form = std::ranges::find(data::kInputForms, form); at_form != data::kInputForms.end())
    i.recipe.form = static_cast<data::InputForm>(at_form - data::kInputForms.begin());
  k.whole("pca_components", 0, i.pca_components, "principal components of each second of a channel; 0: none");
  Keys extra(c, at, default_of(complete));
  extra.flag("seconds_as_steps", i.recipe.seconds_as_steps,
             "the components of one second form one time step of the input");
  if (i.recipe.seconds_as_steps && i.pca_components == 0)
    c.problem(at.path("seconds_as_steps"), "seconds_as_steps without pca_components",
              "each step consists of the principal components of one second",
              "give pca_components, or leave it out");
  extra.flag("regressions", i.recipe.regressions,
             "also read the regressions of each signal on pairs of others");
  if (i.recipe.regressions && i.recipe.form != data::InputForm::physics)
    c.problem(at.path("regressions"), "regressions with the wrong form",
              "they are computed from the signals of the form physics",
              "choose form = \"physics\", or leave regressions out");
}

/// Removes settings that are impossible for a network that corrects estimates. The estimates are computed
/// once, from records with one noise level, and have no posterior.
void train_as_judged(TrainingRecipe& t) {
  t.noise_levels.reset();
  t.posterior_epochs = t.set_aside = 0;
}

void refuse_unknown_posteriors(Config& c, const Table& at, const TrainingRecipe& t) {
  if (t.corrects.empty() || (!t.noise_levels && t.posterior_epochs == 0)) return;
  c.problem(at.path("corrects"), "training_noise or posterior_epochs for a network that corrects estimates",
            "the estimates are computed once, from records with one noise level",
            "leave training_noise and posterior_epochs out");
}

/// Records a problem if a likelihood search (steps_from) has a run without noise, or if the network from
/// whose estimates it starts has no file.
void refuse_steps_without_noise(Config& c, const Table& at, const Preset& p, const std::string& network) {
  const std::string& from = p.training.at(network).steps_from;
  if (from.empty()) return;
  const auto& levels = p.judging.at(network).noise;
  if (std::ranges::find(levels, 0.0) != levels.end())
    c.problem(at.path("noise"), "steps_from without noise", "the likelihood needs the level of the noise",
              "give levels above 0");
  if (p.training.contains(from) &&
      (!p.training.at(from).corrects.empty() || !p.training.at(from).steps_from.empty()))
    c.problem(at.path("steps_from"), fmt::format("{} has no network file", from),
              "it corrects estimates or is not trained", "choose a network that reads series alone");
}

void read_judging(Config& c, const Table& at, bool complete, Judging& j) {
  Keys(c, at, required_of(complete)).numbers("noise", kNoiseLevels, j.noise);
  Keys extra(c, at, default_of(complete));
  extra.whole("test_rows", 1, j.test_rows, "approximate number of test rows to judge; missing: all");
  extra.numbers("shares",
                {kLeastShare, 1.0 - kLeastShare, "", "shares of the training rows, one more run each"},
                j.shares);
}

/// Returns the table of the preset that a preset copies, "preset.quick"; none if it copies none.
std::optional<std::string> copied_preset(Config& c, const std::string& name) {
  const std::string key = "preset." + name + ".like";
  if (!c.has(key)) return std::nullopt;
  const auto other = c.require<std::string>(
      key, {.meaning = "preset from which this one takes the keys and tables that it does not give itself"});
  if (other.empty() || !c.is_table("preset." + other) || c.has("preset." + other + ".like"))
    c.problem(key, fmt::format("preset '{}' cannot be copied", other),
              "it does not exist, or copies another preset", "name a preset without like, or leave like out");
  return other.empty() ? "" : "preset." + other;
}

/// Reads a preset. A table in it with the name of a network overrides settings for that network only.
Preset read_preset(Config& c, const std::string& name) {
  const Table at(c, "preset." + name, copied_preset(c, name));
  Preset p;
  p.name = name;
  const auto events = [&](const char* key, double low, const char* meaning, std::uint64_t& value) {
    if (at.reads(key))
      value = static_cast<std::uint64_t>(c.require<std::int64_t>(at.path(key), {low, 1e12, "", meaning}));
  };
  events("draws", 1, "events to simulate", p.draws);
  const char* const more = "events of training_dataset to simulate; required if there is one";
  if (c.name().empty())  // a schema is derived: the key must be optional
    c.optional<std::int64_t>(at.path("training_draws"), 0, {0, 1e12, "", more});
  else if (c.has("training_dataset"))
    events("training_draws", 0, more, p.training_draws);
  const auto known = network_names();
  if (at.reads("networks"))
    p.networks = c.table_names(
        at.path("networks"),
        {.meaning = fmt::format("networks, copies of networks, or methods: {}", fmt::join(known, ", "))});
  else if (c.name().empty())  // a schema is derived: tables of networks do not depend on the list
    p.networks = {kAnyName};
  NetworkInput input;
  TrainingRecipe training;
  read_input(c, at, true, input);
  read_training(c, at, true, training);
  Judging judging;
  read_judging(c, at, true, judging);
  for (const auto& network : p.networks) {
    const Table own = at.of(network);
    const std::string steps_from = c.optional<std::string>(
        own.path("steps_from"), "",
        {.meaning =
             "earlier network of the preset from whose estimates the likelihood search starts; not with "
             "like"});
    const std::string copy = steps_from.empty() ? "like" : "steps_from";
    const std::string like =
        steps_from.empty()
            ? c.optional<std::string>(own.path("like"), "",
                                      {.meaning = "earlier network of the preset that this one copies"})
            : steps_from;
    if (!like.empty() && !p.training.contains(like))
      c.problem(own.path(copy), fmt::format("no network called '{}' before '{}'", like, network),
                fmt::format("`{}` refers to an earlier entry of the preset's networks", copy),
                "list that network first");
    const bool copied = p.training.contains(like);
    p.input[network] = copied ? p.input[like] : input;
    p.judging[network] = copied ? p.judging[like] : judging;
    p.training[network] = copied ? p.training[like] : training;
    if (!copied) p.training[network].kind = network;
    p.training[network].steps_from = steps_from;
    const std::string& kind = p.training[network].kind;
    if (std::find(known.begin(), known.end(), kind) == known.end())
      c.problem(at.path("networks"), fmt::format("no network called '{}'", kind), "there is no such network",
                fmt::format("choose among {}", fmt::join(known, ", ")));
    p.training[network].corrects = c.choice(own.path("corrects"), {"", "closed-form", "refined"}, "",
                                            {.meaning = "method whose estimates the network corrects"});
    if (!p.training[network].corrects.empty()) train_as_judged(p.training[network]);
    read_input(c, own, false, p.input[network]);
    read_training(c, own, false, p.training[network]);
    read_judging(c, own, false, p.judging[network]);
    read_noise_levels(c, own, p.training[network], p.input[network]);
    refuse_unknown_posteriors(c, own, p.training[network]);
    refuse_steps_without_noise(c, own, p, network);
    if (p.training[network].training_rows && p.training_draws == 0)
      c.problem(own.path("training_rows"), "training_rows without training_dataset",
                "the experiment has no training_dataset, or the preset no training_draws", "give both");
  }
  return p;
}

Experiment read_experiment(Config& c) {
  const std::filesystem::path& file = c.name();
  Experiment e;
  e.file = file;
  e.table = c.has("table") ? c.choice("table", {"IV", "V", "VI"}, Range{.meaning = "table of the thesis"})
                           : file.stem().string();
  e.title = c.require<std::string>("title", {.meaning = "title in reports"});
  e.dataset = c.file("dataset", {.meaning = "config of the dataset, relative to the folder of this file"});
  if (c.has("training_dataset"))
    e.training_dataset =
        c.file("training_dataset",
               {.meaning = "config of additional training rows, relative to the folder of this file"});
  const std::string split = c.choice("split", {kSplits.begin(), kSplits.end()},
                                     Range{.meaning = "split into training and test rows"});
  e.split = static_cast<Split>(std::ranges::find(kSplits, split) - kSplits.begin());
  if (e.split == Split::leave_one_out)
    for (const auto g : c.require<std::vector<std::int64_t>>(
             "folds", {1, 1e9, "", "bus numbers of generators to leave out, one fold each"}))
      e.folds.push_back(static_cast<std::int32_t>(g));
  for (const auto& name : c.keys("preset")) {
    e.presets[name] = read_preset(c, name);
    for (const auto& [network, training] : e.presets[name].training)
      if (e.split == Split::across && !training.training_rows)
        c.problem("preset." + name, fmt::format("no training rows for {}", network),
                  "the split across-datasets trains on training_dataset only",
                  "add training_rows = true to the preset");
  }
  if (e.presets.empty())
    c.problem("preset", "no preset", "an experiment needs at least one", "add [preset.quick]");
  c.raise();
  return e;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& file) {
  Config c(file);
  return read_experiment(c);
}

std::string experiment_schema() {
  return describe_keys("Experiment of Swingbank", [](Config& c) { read_experiment(c); });
}

const Preset& Experiment::preset(const std::string& name) const {
  const auto found = presets.find(name);
  if (found != presets.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [key, value] : presets) names.push_back(key);
  throw InputError({fmt::format("no preset called '{}'", name), "--preset",
                    fmt::format("{} has {}", file.string(), fmt::join(names, ", ")), "choose one of these"});
}

namespace {
template <class Value>
const Value& of_network(const Experiment& e, const Preset& p, const std::map<std::string, Value>& values,
                        const std::string& network) {
  const auto found = values.find(network);
  if (found != values.end()) return found->second;
  throw InputError(
      {fmt::format("network '{}' is not in this experiment", network), "--network",
       fmt::format("preset {} of {} trains {}", p.name, e.file.string(), fmt::join(p.networks, ", ")),
       "choose one of these or add it to the preset's networks"});
}

std::string lines_of(const std::vector<Task>& tasks) {
  std::string lines;
  for (const auto& t : tasks)
    lines += fmt::format("{}{} {} {}{}", lines.empty() ? "" : "\n", t.network, t.noise, t.fold,
                         t.share < 1 ? fmt::format(" {}", t.share) : "");
  return lines;
}

std::string training_networks(const Preset& p) {
  std::vector<std::string> names;
  for (const auto& network : p.networks)
    if (p.training.at(network).training_rows) names.push_back(network);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, "\n"));
}
}  // namespace

const TrainingRecipe& Experiment::training(const std::string& preset_name, const std::string& network) const {
  const Preset& p = preset(preset_name);
  return of_network(*this, p, p.training, network);
}

const NetworkInput& Experiment::input(const std::string& preset_name, const std::string& network) const {
  const Preset& p = preset(preset_name);
  return of_network(*this, p, p.input, network);
}

const Judging& Experiment::judging(const std::string& preset_name, const std::string& network) const {
  const Preset& p = preset(preset_name);
  return of_network(*this, p, p.judging, network);
}

std::vector<Task> Experiment::tasks(const std::string& preset_name) const {
  std::vector<std::string> left_out;
  for (const auto fold : folds) left_out.push_back(std::to_string(fold));
  if (left_out.empty()) left_out = {"none"};
  std::vector<Task> all;
  for (const auto& network : preset(preset_name).networks) {
    const Judging& judged = judging(preset_name, network);
    for (const double noise : judged.noise) {
      if (network == "floor" && noise == 0.0) continue;  // the floor is not defined without noise
      for (const auto& fold : left_out) all.push_back({network, noise, fold});
    }
    for (const double share : judged.shares)
      all.push_back({network, judged.noise.front(), left_out.front(), share});
  }
  return all;
}

std::string Experiment::print(const std::string& preset_name, const std::string& what) const {
  const Preset& p = preset(preset_name);
  if (what == "table") return table;
  if (what == "dataset") return dataset.string();
  if (what == "draws") return std::to_string(p.draws);
  if (what == "training_dataset") return training_dataset.empty() ? "none" : training_dataset.string();
  if (what == "training_draws") return std::to_string(p.training_draws);
  if (what == "training_rows") return training_networks(p);
  if (what == "networks") return fmt::format("{}", fmt::join(p.networks, "\n"));
  if (what == "tasks") return lines_of(tasks(preset_name));
  throw InputError({fmt::format("'{}' cannot be printed", what), "--print", "an experiment has no such entry",
                    fmt::format("choose among {}", fmt::join(kPrintable, ", "))});
}

}  // namespace swingbank::train::loop
