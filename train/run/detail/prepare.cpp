#include "train/run/detail/prepare.hpp"

#include <algorithm>

#include "base/problem.hpp"
#include "train/direct/direct.hpp"
#include "train/run/detail/result.hpp"

namespace swingbank::train::run {
namespace {

/// Throws InputError if a method needs complete records but the dataset is not on disk.
void require_records(const data::ShardStream& stream, const RunRequest& r) {
  const loop::TrainingRecipe& recipe = r.experiment.training(r.preset, r.network);
  const bool reads = !is_trained(r) || !recipe.corrects.empty();
  if (reads && stream.from_memory())
    throw InputError(
        {"network " + r.network, "--simulate",
         "it needs complete records; --simulate keeps only the network's input",
         "write the dataset to disk with `swingbank generate`, or choose a network that reads series alone"});
}

data::RowSplit split_of(const data::Labels& labels, const RunRequest& r) {
  const loop::TrainingRecipe& recipe = r.experiment.training(r.preset, r.network);
  data::RowSplit split = r.generator ? data::leave_one_out(labels, {*r.generator, recipe.validation_share,
                                                                    r.seed, r.judged, recipe.set_aside})
                         : r.experiment.split == loop::Split::across
                             ? data::split_across(labels, recipe.validation_share, r.seed)
                         : r.experiment.split == loop::Split::by_row ? data::split_by_row(labels, r.seed)
                                                                     : data::split_by_point(labels, r.seed);
  if (r.test_rows) split.test = data::some_of(split.test, *r.test_rows);
  if (r.train_share < 1) data::keep_share(split, labels, r.train_share);
  return split;
}

}  // namespace

bool is_trained(const RunRequest& r) {
  return !direct::is_method(r.network) && r.experiment.training(r.preset, r.network).steps_from.empty();
}

PreparedRun prepare(const data::ShardStream& stream, const RunRequest& r) {
  require_records(stream, r);
  const data::Labels& labels = stream.labels();
  const loop::TrainingRecipe& recipe = r.experiment.training(r.preset, r.network);
  nlohmann::json whole = identity(stream, r), training = whole;
  if (recipe.noise_levels)
    for (const char* judging : {"noise", "judged_rows"}) training.erase(judging);
  data::RowSplit split = split_of(labels, r);
  data::TargetScale scale =
      data::TargetScale::fit(labels.values, labels.parameters, split.train, stream.dataset().parameter_low);
  return {stream, r, recipe, std::move(whole), std::move(training), std::move(split), std::move(scale)};
}

std::vector<std::uint64_t> trainable(const data::Labels& labels, const PreparedRun& run) {
  const RunRequest& r = run.request;
  std::vector<std::uint64_t> rows;
  for (std::uint64_t row = r.experiment.split == loop::Split::across ? labels.judged : 0; row < labels.rows;
       ++row) {
    const std::int32_t of = labels.generator[row];
    if (of != r.generator && of != r.judged &&
        std::ranges::find(run.split.set_aside, of) == run.split.set_aside.end())
      rows.push_back(row);
  }
  data::leave_out(rows, labels, data::held_out(run.stream.labels(), run.split));
  if (rows.empty())
    throw InputError({"no training rows in an epoch", "--fresh-rows",
                      "every new event was rejected, or belongs to a left-out generator or parameter set",
                      "raise --draws"});
  return rows;
}

}  // namespace swingbank::train::run
