#include "train/run/detail/posterior.hpp"

#include <ATen/ATen.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "train/data/random.hpp"
#include "train/posterior/together.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;

constexpr std::uint64_t kPosteriorDraws = 1u << 20;  // first noise realisation of the head, above any epoch
constexpr std::uint64_t kCalibrationDraw = 2;
constexpr std::size_t kCalibrationRows = 3000, kOtherRows = 1000, kLevelsAboveZero = 5;

std::vector<double> levels_of(const PreparedRun& run) {
  if (!run.recipe.noise_levels) return {run.stream.noise().level};
  const data::NoiseLevels& range = *run.recipe.noise_levels;
  std::vector<double> all;
  if (range.share_at_zero > 0) all.push_back(0.0);
  for (std::size_t i = 0; i < kLevelsAboveZero; ++i)
    all.push_back(range.low * std::pow(range.high / range.low,
                                       static_cast<double>(i) / static_cast<double>(kLevelsAboveZero - 1)));
  return all;
}

std::vector<double> places_of(const posterior::Head& head, const data::Labels& labels,
                              std::span<const std::uint64_t> rows) {
  std::vector<double> raw;
  for (const std::uint64_t row : rows)
    raw.insert(raw.end(), labels.values.begin() + static_cast<std::ptrdiff_t>(row * labels.parameters),
               labels.values.begin() + static_cast<std::ptrdiff_t>((row + 1) * labels.parameters));
  return head.places(raw, labels.parameters);
}

posterior::Posteriors posteriors_of(const Trained& trained, const PreparedRun& run,
                                    std::span<const std::uint64_t> rows, const data::Noise& noise) {
  posterior::Head& head = *trained.posterior.head;
  return head.posteriors(loop::predict(head, run.stream, trained.features, rows, {}, noise));
}

/// Returns the rows of the generators set aside; if none was set aside, the validation rows.
const std::vector<std::uint64_t>& calibration_rows(const data::RowSplit& split) {
  return split.calibration.empty() ? split.validation : split.calibration;
}

LevelMaps calibrate(const Trained& trained, const PreparedRun& run, double level,
                    std::span<const std::uint64_t> rows) {
  const data::Noise noise =
      run.stream.noise().training ? data::Noise{level, kCalibrationDraw} : run.stream.judged();
  const posterior::Posteriors posteriors = posteriors_of(trained, run, rows, noise);
  const std::vector<double> scores =
      posterior::scores(posteriors, places_of(*trained.posterior.head, run.stream.labels(), rows));
  LevelMaps all{level, {}};
  for (std::size_t p = 0; p < posteriors.parameters; ++p) {
    std::vector<double> own;
    for (std::size_t r = 0; r < posteriors.rows; ++r) own.push_back(scores[r * posteriors.parameters + p]);
    all.maps.push_back(posterior::Recalibration::fit(own));
  }
  return all;
}

json ranks_json(const posterior::Ranks& r) {
  return {{"counts", r.count},
          {"chi_square", r.chi_square()},
          {"degrees_of_freedom", posterior::kRankBins - 1},
          {"by_chance", r.by_chance()},
          {"largest_distance", r.largest_distance()}};
}

json coverage_json(const posterior::Coverage& c, const PreparedRun& run, const posterior::Head& head,
                   std::size_t rows) {
  using posterior::ParameterCoverage;
  json each = json::array();
  for (std::size_t i = 0; i < c.parameters.size(); ++i) {
    const ParameterCoverage& p = c.parameters[i];
    const posterior::HeadParameter& of = head.of()[i];
    each.push_back({{"name", run.stream.dataset().parameter_names[of.output]},
                    {"coverage_50", p.within_50},
                    {"coverage_90", p.within_90},
                    {"width_50", p.width_50 * (of.high - of.low)},
                    {"width_90", p.width_90 * (of.high - of.low)},
                    {"sbc", ranks_json(p.ranks)}});
  }
  return {{"rows", rows},
          {"coverage_50", c.mean(&ParameterCoverage::within_50)},
          {"coverage_90", c.mean(&ParameterCoverage::within_90)},
          {"width_50", c.mean(&ParameterCoverage::width_50)},
          {"width_90", c.mean(&ParameterCoverage::width_90)},
          {"per_parameter", each},
          {"tarp", ranks_json(c.tarp)}};
}

json judged_on(const Trained& trained, const PreparedRun& run, std::span<const std::uint64_t> rows,
               const std::vector<posterior::Recalibration>& maps) {
  const posterior::Posteriors posteriors = posteriors_of(trained, run, rows, run.stream.judged());
  const posterior::Head& head = *trained.posterior.head;
  const auto found =
      posterior::coverage(posteriors, maps, places_of(head, run.stream.labels(), rows), run.request.seed);
  return coverage_json(found, run, head, rows.size());
}

/// Returns the left-out generator's rows in the training dataset; none if no generator was set aside.
std::vector<std::uint64_t> other_rows(const PreparedRun& run) {
  const data::Labels& labels = run.stream.labels();
  std::vector<std::uint64_t> rows;
  const std::int32_t left_out = labels.generator[run.split.test.front()];
  for (std::uint64_t row = labels.judged; row < labels.rows; ++row)
    if (!run.split.set_aside.empty() && labels.generator[row] == left_out) rows.push_back(row);
  return rows;
}

}  // namespace

std::vector<posterior::Recalibration> maps_at(const std::vector<LevelMaps>& levels, double level) {
  const auto above = std::ranges::find_if(levels, [&](const LevelMaps& m) { return m.level >= level; });
  if (above == levels.end()) return levels.back().maps;
  if (above == levels.begin()) return above->maps;
  const LevelMaps& below = *std::prev(above);
  const double from = data::level_input(below.level), to = data::level_input(above->level);
  const double share = (data::level_input(level) - from) / (to - from);
  std::vector<posterior::Recalibration> all;
  for (std::size_t p = 0; p < above->maps.size(); ++p)
    all.push_back(posterior::Recalibration::between(below.maps[p], above->maps[p], share));
  return all;
}

std::unique_ptr<posterior::Head> make_head(networks::Network& network, const mpi::store::Dataset& d,
                                           const data::TargetScale& scale, std::size_t inputs) {
  std::vector<posterior::HeadParameter> all;
  for (std::size_t p = 0; p < scale.unit.size(); ++p)
    if (d.parameter_high[p] > d.parameter_low[p])
      all.push_back({p, d.parameter_low[p], d.parameter_high[p], scale.unit[p], scale.origin[p]});
  return std::make_unique<posterior::Head>(network, static_cast<std::int64_t>(inputs), std::move(all));
}

bool train_posterior(Trained& trained, const PreparedRun& run, loop::LoopSettings settings,
                     std::span<const float> targets, loop::TrainingProgress& progress) {
  loop::seed_torch(data::key(run.request.seed, data::Purpose::weights, 1));
  const data::Features& features = trained.features;
  Posterior& posterior = trained.posterior;
  posterior.head =
      make_head(*trained.network, run.stream.dataset(), run.scale, features.channels() * features.length());
  settings.recipe.epochs = settings.recipe.patience = run.recipe.posterior_epochs;
  settings.checkpoint.replace_extension(".posterior.checkpoint");
  settings.first_draw = kPosteriorDraws;
  settings.gflops = 0.0;
  progress.line("losses are negative log densities per parameter");
  const auto* head = posterior.head.get();
  loop::LoopData data{run.stream, features, run.split.train, run.split.validation, targets};
  data.loss = [head](const at::Tensor& numbers, const at::Tensor& of) { return head->loss(numbers, of); };
  if (!loop::train_network(*posterior.head, data, settings, progress).finished) return false;
  const auto rows = data::some_of(calibration_rows(run.split), kCalibrationRows);
  for (const double level : levels_of(run)) posterior.levels.push_back(calibrate(trained, run, level, rows));
  return true;
}

json judge_posterior(const PreparedRun& run, const Trained& trained) {
  const auto maps = maps_at(trained.posterior.levels, run.stream.noise().level);
  const std::vector<posterior::Recalibration> none(maps.size());
  json all = {{"set_aside", run.split.set_aside},
              {"calibration_rows", std::min(calibration_rows(run.split).size(), kCalibrationRows)},
              {"test", judged_on(trained, run, run.split.test, maps)},
              {"test_not_recalibrated", judged_on(trained, run, run.split.test, none)}};
  const auto others = data::some_of(other_rows(run), kOtherRows);
  if (!others.empty()) all["other_operating_points"] = judged_on(trained, run, others, maps);
  return all;
}

std::function<std::vector<double>(std::span<const std::size_t>)> product_of_posteriors(
    const PreparedRun& run, const Trained& trained) {
  const auto posteriors = std::make_shared<posterior::Posteriors>(
      posteriors_of(trained, run, run.split.test, run.stream.judged()));
  const mpi::store::Dataset& d = run.stream.dataset();
  return [posteriors, &d, head = trained.posterior.head.get()](std::span<const std::size_t> rows) {
    std::vector<double> all;
    for (std::size_t p = 0; p < d.parameter_low.size(); ++p)
      all.push_back(0.5 * (d.parameter_low[p] + d.parameter_high[p]));
    const std::vector<double> places = posterior::together(*posteriors, rows);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const posterior::HeadParameter& of = head->of()[i];
      all[of.output] = of.low + (of.high - of.low) * places[i];
    }
    return all;
  };
}

json maps_json(const Posterior& posterior) {
  json all = json::array();
  for (const LevelMaps& l : posterior.levels) {
    json maps = json::array();
    for (const auto& m : l.maps) maps.push_back(m.node_scores());
    all.push_back({{"level", l.level}, {"maps", maps}});
  }
  return all;
}

std::vector<LevelMaps> maps_of(const json& all) {
  std::vector<LevelMaps> levels;
  for (const auto& item : all) {
    levels.push_back({item.at("level"), {}});
    for (const auto& m : item.at("maps"))
      levels.back().maps.emplace_back(m.get<std::array<double, posterior::kNodeProbabilities.size()>>());
  }
  return levels;
}

}  // namespace swingbank::train::run
