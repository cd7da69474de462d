#include "train/run/detail/result.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/json.hpp"
#include "train/run/detail/maker.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;
json or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }
json or_null(const std::optional<std::int32_t>& value) { return value ? json(*value) : json(); }

json input_json(const data::ShardStream& stream, const RunRequest& request, const data::Features& features) {
  const loop::NetworkInput& p = request.experiment.input(request.preset, request.network);
  return {{"channels", p.recipe.channels},
          {"start_s", p.recipe.start_s},
          {"end_s", p.recipe.end_s},
          {"rate_per_s", stream.selection().rate},
          {"form", data::kInputForms.at(static_cast<std::size_t>(p.recipe.form))},
          {"samples", features.length()},
          {"pca_components", p.pca_components},
          {"pca_error", features.pca() ? json(features.pca()->error()) : json()}};
}
std::string kernels(const RunRequest& r) {
  return fmt::format("{}, LibTorch {}", r.runtime.blas, r.runtime.loops);
}
constexpr std::size_t kExamples = 200;  ///< largest number of test rows whose estimates a result lists

/// Returns truth and estimate of a parameter for evenly spaced test rows, with four digits.
json examples(const PreparedRun& run, std::span<const double> estimates, std::size_t parameter) {
  const data::Labels& labels = run.stream.labels();
  const std::vector<std::uint64_t>& rows = run.split.test;
  const std::size_t every = (rows.size() + kExamples - 1) / kExamples;
  const auto rounded = [](double value) { return std::stod(fmt::format("{:.4g}", value)); };
  json truth = json::array(), estimate = json::array();
  for (std::size_t i = 0; i < rows.size(); i += every) {
    truth.push_back(rounded(labels.values[rows[i] * labels.parameters + parameter]));
    estimate.push_back(rounded(estimates[i * labels.parameters + parameter]));
  }
  return {{"truth", truth}, {"estimate", estimate}};
}
}  // namespace

std::string dataset_name(const mpi::store::Dataset& d) {
  return d.name.empty() ? std::filesystem::weakly_canonical(d.path).filename().string() : d.name;
}

json identity(const data::ShardStream& stream, const RunRequest& r) {
  const loop::NetworkInput& p = r.experiment.input(r.preset, r.network);
  const loop::TrainingRecipe& t = r.experiment.training(r.preset, r.network);
  const bool any = r.any_maker;
  json all = {{"software", any ? "any" : software()},
              {"kernels", any ? "any" : kernels(r)},
              {"dataset", stream.dataset().hash},
              {"training_dataset", stream.more() ? stream.more()->hash : ""},
              {"network", r.network},
              {"generator", or_null(r.generator)},
              {"judged", or_null(r.judged)},
              {"seed", r.seed},
              {"noise", r.noise},
              {"judged_rows", r.test_rows ? json(*r.test_rows) : json()},
              {"train_share", r.train_share},
              {"shuffled_labels", r.shuffle_labels},
              {"channels", p.recipe.channels},
              {"window", {p.recipe.start_s, p.recipe.end_s}},
              {"slice", p.recipe.slice},
              {"form", data::kInputForms.at(static_cast<std::size_t>(p.recipe.form))},
              {"pca_components", p.pca_components},
              {"epochs", r.epochs.value_or(t.epochs)},
              {"batch", t.batch},
              {"learning_rate", t.learning_rate},
              {"schedule", t.schedule},
              {"patience", t.patience},
              {"validation_share", t.validation_share},
              {"kind", t.kind},
              {"corrects", t.corrects},
              {"loss_power", t.loss_power},
              {"weight_decay", t.weight_decay},
              {"clip", t.clip},
              {"average", t.average}};
  if (p.recipe.seconds_as_steps) all["seconds_as_steps"] = true;
  if (p.recipe.regressions) all["regressions"] = true;
  if (!t.steps_from.empty()) all["steps_from"] = t.steps_from;
  if (r.fresh) all["fresh_rows"] = true;
  if (r.experiment.split == loop::Split::by_row || r.experiment.split == loop::Split::across)
    all["split"] = loop::kSplits.at(static_cast<std::size_t>(r.experiment.split));
  if (t.noise_levels)
    all["training_noise"] = {t.noise_levels->low, t.noise_levels->high, t.noise_levels->share_at_zero};
  if (t.posterior_epochs > 0) all["posterior_epochs"] = t.posterior_epochs;
  if (t.posterior_epochs > 0 || t.set_aside > 0) all["set_aside"] = t.set_aside;
  return all;
}

json result_json(const PreparedRun& run, const RunParts& parts) {
  const RunRequest& r = run.request;
  const mpi::store::Dataset& d = run.stream.dataset();
  json parameters = json::array();
  for (const auto& p : parts.score.parameters) {
    const std::size_t index = parameters.size();
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"mse", p.mse},
                          {"baseline_mse", p.baseline_mse},
                          {"variance", p.variance},
                          {"box_variance", p.box_variance},
                          {"relative", or_null(p.relative())}});
    if (!parts.estimates.empty() && p.relative())
      parameters.back()["examples"] = examples(run, parts.estimates, index);
  }
  json result = {
      {"table", r.experiment.table},
      {"title", r.experiment.title},
      {"network", r.network},
      {"preset", r.preset},
      {"seed", r.seed},
      {"noise", r.noise},
      {"generator", or_null(r.generator)},
      {"judged", or_null(r.judged)},
      {"dataset",
       {{"name", dataset_name(d)}, {"hash", d.hash}, {"config_hash", d.config_hash}, {"rows", d.rows}}},
      {"machine_model", d.machine_model},
      {"parameters", d.parameter_names},
      {"train_share", r.train_share},
      {"train_rows", run.split.train.size()},
      {"validation_rows", run.split.validation.size()},
      {"test_rows", run.split.test.size()},
      {"epochs", parts.report.epochs},
      {"best_epoch", parts.report.best_epoch},
      {"seconds", parts.report.seconds},
      {"processor_seconds", parts.report.processor_seconds},
      {"seconds_per_epoch",
       parts.report.seconds / static_cast<double>(std::max<std::size_t>(parts.report.epochs, 1))},
      {"mse", parts.score.mse},
      {"mse_varied_only", parts.score.mse_varied_only},
      {"seen_mse", or_null(parts.seen_mse)},
      {"baseline_mse", parts.score.baseline_mse},
      {"baseline_mse_varied_only", parts.score.baseline_mse_varied_only},
      {"ratio", parts.score.ratio},
      {"H_ratio", or_null(parts.score.H_ratio)},
      {"rows_mse",
       {{"median", parts.score.median_row},
        {"worst", parts.score.worst_row},
        {"failed", parts.score.failed_rows}}},
      {"per_parameter", parameters},
      {"shuffled_labels", r.shuffle_labels},
      {"threads", r.runtime.threads},
      {"ranks", r.ranks == nullptr ? 1 : r.ranks->size()},
      {"blas", r.runtime.blas},
      {"kernels", kernels(r)},
      {"software", software()},
      {"input", parts.features ? input_json(run.stream, r, *parts.features) : json()},
      {"batch", run.recipe.batch},
      {"learning_rate", run.recipe.learning_rate},
      {"validation_mse", parts.report.validation},
      {"curve", loop::learning_curve_json(parts.report.curve)},
      {"run", run.identity}};
  if (!parts.posterior.is_null()) result["posterior"] = parts.posterior;
  if (!parts.several.is_null()) result["several"] = parts.several;
  return result;
}

}  // namespace swingbank::train::run
