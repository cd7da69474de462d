#include "research/nightly_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>

#include "base/config.hpp"
#include "base/durable.hpp"
#include "base/problem.hpp"
#include "base/write_file.hpp"

namespace swingbank::research {
namespace {

/// Keys that grow with the square root of the work, and their lower limits. 120 draws give a dozen rows for
/// each of ten generators; with fewer draws, a fold might have no test rows.
const std::map<std::string, std::uint64_t> kLeast = {
    {"draws", 120}, {"training_draws", 120}, {"epochs", 1}, {"patience", 1}, {"test_rows", 10}};
constexpr double kOnlyJudged = 0.25;  ///< fixed time of a run without training, relative to a training run
constexpr double kNoiseDrawn = 1.5;   ///< time of a training sample with new noise, relative to fixed noise
constexpr double kSplitTrain = 0.6, kSplitTest = 0.2;

std::uint64_t times(std::uint64_t value, double work, std::uint64_t least) {
  const double wanted = std::round(static_cast<double>(value) * std::sqrt(work));
  return std::max(static_cast<std::uint64_t>(wanted), std::min(value, least));
}

/// Properties of a dataset's config that determine the cost.
struct Events {
  double rate = 0.0;            // sampling rate [1/s]
  double rows_per_event = 1.0;  // stable rows per event
  double seconds = 0.0;         // core time per event [s]
};
Events events_of(const std::filesystem::path& file, const Rates& rates) {
  Config c(file);
  Events e;
  e.rate = c.require<double>("record.rate");
  const auto generators = static_cast<double>(c.require<std::vector<std::int64_t>>("vary.generators").size());
  const bool all = c.choice("vary.who", {"one", "all"}) == "all";
  e.seconds = all ? generators * rates.row_of_all : rates.event;
  const auto stable = rates.stable.find(file.stem().string());
  e.rows_per_event = (all ? generators : 1.0) * (stable == rates.stable.end() ? 1.0 : stable->second);
  return e;
}

double series_length(const train::loop::NetworkInput& input, double rate) {
  const double seconds = input.recipe.end_s - input.recipe.start_s;
  if (input.recipe.seconds_as_steps) return std::ceil(seconds);
  if (input.pca_components > 0) return static_cast<double>(input.pca_components) * std::ceil(seconds);
  return seconds * rate / static_cast<double>(input.recipe.slice);
}

struct Rows {
  double own = 0, more = 0, folds = 1;
  bool leave_one_out = false, across = false;
  [[nodiscard]] double train(const train::loop::TrainingRecipe& t) const {
    if (across) return (1.0 - t.validation_share) * more;
    const double seen = leave_one_out ? 1.0 - 1.0 / folds : 1.0;
    const double of_own = leave_one_out ? seen * (1.0 - t.validation_share) : kSplitTrain;
    return of_own * own + (t.training_rows ? seen * more : 0.0);
  }
  [[nodiscard]] double all(const train::loop::TrainingRecipe& t) const {
    return own + (t.training_rows ? more : 0.0);
  }
  [[nodiscard]] double test(std::size_t wanted) const {
    const double all = own * (leave_one_out ? 1.0 / folds : across ? 1.0 : kSplitTest);
    return wanted > 0 ? std::min(all, static_cast<double>(wanted)) : all;
  }
};

const NetworkRate& rate_of(const Rates& rates, const std::string& kind) {
  if (const auto found = rates.networks.find(kind); found != rates.networks.end()) return found->second;
  throw InputError({fmt::format("no rate of '{}'", kind), "--rates", "the plan needs the cost of a sample",
                    fmt::format("measure one and add [network.{}]", kind)});
}

Part network_part(const train::loop::Preset& p, const std::string& network, const Rows& rows, double rate,
                  const Rates& rates) {
  const train::loop::TrainingRecipe& t = p.training.at(network);
  const train::loop::Judging& judged = p.judging.at(network);
  const NetworkRate& cost = rate_of(rates, t.steps_from.empty() ? t.kind : "refined");
  const auto row = [](const NetworkRate& of, double noise) { return noise > 0 ? of.noisy_row : of.row; };
  Part part;
  part.what = network;
  double of_rows = 0.0;  // training time of one run [core-s]
  for (const double noise : judged.noise) {
    if (network == "floor" && noise == 0.0) continue;
    const bool trains = !t.noise_levels || noise == judged.noise.front();  // one network serves all levels
    double seconds = cost.run * (trains ? 1.0 : kOnlyJudged);
    if (cost.sample > 0) {
      const double longer = cost.length > 0 ? series_length(p.input.at(network), rate) / cost.length : 1.0;
      part.rows = rows.train(t);
      part.epochs = t.epochs;
      of_rows = part.rows * static_cast<double>(t.epochs + t.posterior_epochs) * cost.sample * longer;
      if (trains) seconds += of_rows * (t.noise_levels ? kNoiseDrawn : 1.0);
    } else {
      part.rows = rows.test(judged.test_rows);
      seconds += part.rows * row(cost, noise);
    }
    part.runs += static_cast<std::size_t>(rows.folds);
    part.core_seconds += rows.folds * seconds;
    if (!t.corrects.empty())  // adds the corrected method: all rows, once for all folds
      part.core_seconds += rows.all(t) * row(rate_of(rates, t.corrects), noise);
  }
  if (part.epochs > 0)
    for (const double share : judged.shares) {
      ++part.runs;
      part.core_seconds += cost.run + share * of_rows;
    }
  return part;
}

}  // namespace

Rates read_rates(const std::filesystem::path& file) {
  Config c(file);
  const Range seconds{0.0, 1e6, "s"};
  Rates r;
  r.event = c.require<double>("generate.event", seconds);
  r.row_of_all = c.require<double>("generate.row_of_all", seconds);
  for (const auto& name : c.keys("stable")) r.stable[name] = c.require<double>("stable." + name, {0.0, 1.0});
  for (const auto& name : c.keys("network")) {
    const std::string at = "network." + name + ".";
    NetworkRate& n = r.networks[name];
    n.sample = c.optional<double>(at + "sample", 0.0, seconds);
    n.length = c.optional<double>(at + "length", 0.0, {0.0, 1e6});
    n.row = c.optional<double>(at + "row", 0.0, seconds);
    n.noisy_row = c.optional<double>(at + "noisy_row", n.row, seconds);
    n.run = c.optional<double>(at + "run", 0.0, seconds);
  }
  c.raise();
  return r;
}

train::loop::Preset scaled(const train::loop::Preset& preset, const Scale& to) {
  const auto grow = [&](const char* key, auto& value) { value = times(value, to.work, kLeast.at(key)); };
  train::loop::Preset p = preset;
  p.name = to.name;
  grow("draws", p.draws);
  if (p.training_draws > 0) grow("training_draws", p.training_draws);
  for (auto& [name, t] : p.training) {
    grow("epochs", t.epochs);
    grow("patience", t.patience);
  }
  for (auto& [name, j] : p.judging)
    if (j.test_rows > 0) grow("test_rows", j.test_rows);
  return p;
}

std::vector<Part> work_of(const train::loop::Experiment& experiment, const train::loop::Preset& p,
                          const Rates& rates) {
  const Events own = events_of(experiment.dataset, rates);
  const auto draws = static_cast<double>(p.draws), more_draws = static_cast<double>(p.training_draws);
  Rows rows;
  rows.own = draws * own.rows_per_event;
  rows.leave_one_out = experiment.leave_one_out;
  rows.across = experiment.across;
  rows.folds = experiment.leave_one_out ? static_cast<double>(experiment.folds.size()) : 1.0;
  std::vector<Part> parts = {{"events", 1, rows.own, 0, draws * own.seconds, true}};
  const bool more_wanted =
      std::ranges::any_of(p.networks, [&](const auto& n) { return p.training.at(n).training_rows; });
  if (more_wanted) {
    const Events more = events_of(experiment.training_dataset, rates);
    rows.more = more_draws * more.rows_per_event;
    parts.push_back({"events that only train", 1, rows.more, 0, more_draws * more.seconds, true});
  }
  for (const auto& network : p.networks) parts.push_back(network_part(p, network, rows, own.rate, rates));
  return parts;
}

void write_scaled(const train::loop::Experiment& experiment, const std::string& from, const Scale& to,
                  const std::filesystem::path& file) {
  static const std::regex header(R"(^\s*\[([^\]]+)\].*$)"), number(R"(^\s*(\w+)\s*=\s*([0-9]+)\s*(#.*)?$)"),
      path(R"(^\s*(dataset|training_dataset)\s*=.*$)");
  std::istringstream text(read_text(experiment.file));
  const std::string name = experiment.file.filename().string(), table = "preset." + from;
  std::string out = fmt::format("# Made by `swingbank night-plan` from the preset {} of {}.\n", from, name);
  bool top = true, ours = true;
  std::smatch m;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_match(line, m, header)) {
      const std::string of = m[1];
      top = false;
      ours = of == table || of.starts_with(table + ".");
      if (ours) line = fmt::format("[preset.{}{}]", to.name, of.substr(table.size()));
    } else if (top && std::regex_match(line, m, path)) {
      const auto& config = m[1] == "dataset" ? experiment.dataset : experiment.training_dataset;
      line = fmt::format("{} = \"{}\"", m[1].str(), std::filesystem::absolute(config).string());
    } else if (ours && !top && std::regex_match(line, m, number)) {
      if (const auto least = kLeast.find(m[1]); least != kLeast.end())
        line = fmt::format("{} = {}", least->first, times(std::stoull(m[2]), to.work, least->second));
    }
    if (ours) out += line + "\n";
  }
  write_file(file, out);
  const train::loop::Preset wanted = scaled(experiment.preset(from), to);
  const train::loop::Experiment written = train::loop::read_experiment(file);
  const train::loop::Preset& there = written.preset(to.name);
  bool same = there.draws == wanted.draws && there.training_draws == wanted.training_draws;
  for (const auto& [network, recipe] : wanted.training)
    same = same && there.training.at(network).epochs == recipe.epochs &&
           there.judging.at(network).test_rows == wanted.judging.at(network).test_rows;
  if (!same)
    throw InputError(
        {"preset cannot be scaled", experiment.file.string(),
         fmt::format("the sizes of preset {} cannot be scaled line by line", from),
         "write draws, epochs, patience and test_rows on lines of their own, in [preset.NAME] or "
         "[preset.NAME.NETWORK]"});
}

}  // namespace swingbank::research
