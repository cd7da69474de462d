#include "train/run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "base/run_lock.hpp"
#include "train/data/random.hpp"
#include "train/direct/direct.hpp"
#include "train/run/detail/guesses.hpp"
#include "train/run/detail/result.hpp"
#include "train/run/saved_network.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;

/// What two identities differ in, in words.
std::string differing(const json& there, const json& here) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : here.items())
    if (!there.is_object() || !there.contains(key) || there[key] != value) keys.push_back(key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

/// True if the result stands there already; refuses one of another run. A finished result may be of another
/// processor, which it says; one of other software may not.
bool already_done(const std::filesystem::path& file, const json& run) {
  if (!std::filesystem::exists(file)) return false;
  const json parsed = json::parse(read_text(file), nullptr, false);
  json there = parsed.is_object() ? parsed.value("run", json()) : json();
  if (there.is_object()) {
    there["kernels"] = run["kernels"];
    if (run["software"] == "any") there["software"] = "any";
  }
  if (there == run) return true;
  throw InputError({"another run's result is in the way", file.string(),
                    fmt::format("it differs from this run's in: {}", differing(there, run)),
                    "remove it, choose another --out, or give --any-maker if it is only the software"});
}

/// `predicted`: `rows` x parameters, raw units.
loop::Score judge(const std::vector<double>& predicted, const data::ShardStream& stream,
                  const data::TargetScale& scale, std::span<const std::uint64_t> rows) {
  const data::Labels& labels = stream.labels();
  const std::size_t p = labels.parameters;
  std::vector<double> truth(predicted.size());
  for (std::size_t i = 0; i < truth.size(); ++i) truth[i] = labels.values[rows[i / p] * p + i % p];
  const mpi::store::Dataset& d = stream.dataset();
  return loop::score({predicted, truth, scale.mean, d.parameter_names, d.parameter_units, d.parameter_low,
                      d.parameter_high});
}

/// What a network corrects, of all rows; empty where it corrects nothing.
struct Guesses {
  std::vector<float> raw,
      scaled;  ///< raw units; in standard deviations about the mean of the training targets
  std::size_t width = 0;
  [[nodiscard]] bool none() const { return raw.empty(); }
};

Guesses guesses_for(const data::ShardStream& stream, const RunRequest& r, const data::TargetScale& scale) {
  Guesses g;
  const std::string& method = r.experiment.training(r.preset, r.network).corrects;
  if (method.empty()) return g;
  g.raw = guesses(stream, method, r.out, r.quiet);
  g.width = scale.unit.size();
  for (std::size_t i = 0; i < g.raw.size(); ++i) {
    const std::size_t p = i % g.width;
    g.scaled.push_back(static_cast<float>((g.raw[i] - scale.mean[p]) / scale.unit[p]));
  }
  return g;
}

/// Raw units, inside the sampling box: outside of it there is no truth to be near to.
std::vector<double> raw_outputs(const std::vector<float>& out, const data::TargetScale& scale,
                                const mpi::store::DatasetHeader& d, std::span<const std::uint64_t> rows,
                                const Guesses& guesses) {
  std::vector<double> raw(out.size());
  const std::size_t p = scale.mean.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double value = guesses.none() ? scale.raw(out[i], i % p)
                                        : guesses.raw[rows[i / p] * p + i % p] + out[i] * scale.unit[i % p];
    raw[i] = std::clamp(value, d.parameter_low[i % p], d.parameter_high[i % p]);
  }
  return raw;
}

networks::NetworkShape shape_of(const data::Features& features, const data::TargetScale& scale,
                                const Guesses& guesses) {
  networks::NetworkShape shape{static_cast<std::int64_t>(features.channels()),
                               static_cast<std::int64_t>(features.length()),
                               static_cast<std::int64_t>(scale.unit.size()),
                               {}};
  for (std::size_t p = 0; p < scale.unit.size(); ++p)
    shape.output_bias.push_back(guesses.none() ? static_cast<float>(scale.scaled(scale.mean[p], p)) : 0.0f);
  if (!guesses.none()) {
    shape.samples = shape.channels * shape.samples + static_cast<std::int64_t>(guesses.width);
    shape.channels = 1;
  }
  return shape;
}

std::string scored(const loop::Score& s, double seconds) {
  return fmt::format("MSE {:.4g} against {:.4g} for the mean (x {:.3g}{}), {}", s.mse, s.baseline_mse,
                     s.ratio, s.H_ratio ? fmt::format(", H alone x {:.3g}", *s.H_ratio) : "",
                     loop::duration(seconds));
}

/// Keeps about `wanted` rows, evenly spread.
void thin(std::vector<std::uint64_t>& rows, std::size_t wanted) {
  const std::size_t every = std::max<std::size_t>(1, rows.size() / wanted);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); i += every) rows[kept++] = rows[i];
  rows.resize(kept);
}

struct DirectRun {
  const std::filesystem::path& file;
  const std::string& name;
  const json& identity;
  const data::RowSplit& split;
  const data::TargetScale& scale;
};
/// Nothing is trained and nothing is saved half done: a run takes minutes at most.
RunOutcome run_direct(const data::ShardStream& stream, const RunRequest& r, const DirectRun& d) {
  if (r.shuffle_labels)
    throw InputError({"a control run of " + r.network, "--shuffle-labels", "it is not trained on labels",
                      "leave it out, or choose a network"});
  loop::TrainingProgress progress(d.name, d.split.test.size(), r.quiet);
  progress.line(fmt::format("{} test rows, nothing to train", d.split.test.size()));
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  const auto found = direct::estimate(stream.dataset(), d.split.test, r.network, stream.noise(),
                                      [&](std::size_t done) { progress.update(done, "rows estimated"); });
  loop::LoopReport report;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report.processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  const loop::Score result = judge(found, stream, d.scale, d.split.test);
  write_text(d.file, result_json(stream, r, {d.split, nullptr, report, result}).dump(2) + "\n");
  progress.line(scored(result, report.seconds));
  return RunOutcome::done;
}

}  // namespace

std::string run_name(const RunRequest& r) {
  return fmt::format("{}-{}-{}{}{}-seed{}{}{}{}", r.experiment.table, r.network, r.preset,
                     r.noise > 0 ? fmt::format("-noise{}", r.noise) : "",
                     r.train_share < 1 ? fmt::format("-share{}", r.train_share) : "", r.seed,
                     r.generator ? fmt::format("-gen{}", *r.generator) : "",
                     r.judged ? fmt::format("-judged{}", *r.judged) : "",
                     r.shuffle_labels ? "-shuffled" : "");
}

std::vector<float> scaled_targets(const data::Labels& labels, const data::TargetScale& scale,
                                  const data::RowSplit& split, bool shuffled, std::uint64_t seed) {
  std::vector<std::uint64_t> source(labels.rows);
  for (std::size_t i = 0; i < source.size(); ++i) source[i] = i;
  if (shuffled) {
    std::vector<std::uint64_t> seen = split.train;
    seen.insert(seen.end(), split.validation.begin(), split.validation.end());
    std::vector<std::uint64_t> mixed = seen;
    data::shuffle(mixed, data::key(seed, data::Purpose::labels));
    for (std::size_t i = 0; i < seen.size(); ++i) source[seen[i]] = mixed[i];
  }
  const std::size_t p = labels.parameters;
  std::vector<float> targets(labels.rows * p);
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = static_cast<float>(scale.scaled(labels.values[source[i / p] * p + i % p], i % p));
  return targets;
}

RunOutcome run(const data::ShardStream& stream, const RunRequest& r) {
  const std::string name = run_name(r);
  const auto file = r.out / (name + ".json"), checkpoint = r.out / "checkpoints" / (name + ".checkpoint");
  const json run_identity = identity(stream, r);
  if (already_done(file, run_identity)) return RunOutcome::already_done;
  make_folder(r.out);
  make_folder(checkpoint.parent_path());
  RunLock lock(checkpoint.parent_path() / (name + ".lock"),
               {"a second run", file.string(), "wait for it to end, or choose another --out"});
  if (already_done(file, run_identity)) return RunOutcome::already_done;

  loop::LoopSettings settings;
  settings.recipe = r.experiment.training(r.preset, r.network);
  settings.seed = r.seed;
  settings.checkpoint = checkpoint;
  settings.run = &run_identity;
  settings.gflops = r.runtime.gflops;
  if (r.epochs) settings.recipe.epochs = *r.epochs;
  const data::Labels& labels = stream.labels();
  data::RowSplit split = r.generator ? data::leave_one_out(labels, *r.generator,
                                                           settings.recipe.validation_share, r.seed, r.judged)
                                     : data::split_by_point(labels, r.seed);
  if (r.test_rows) thin(split.test, *r.test_rows);
  if (r.train_share < 1) data::keep_share(split, labels, r.train_share);
  const data::TargetScale scale =
      data::TargetScale::fit(labels.values, labels.parameters, split.train, stream.dataset().parameter_low);
  if (direct::is_method(r.network)) return run_direct(stream, r, {file, name, run_identity, split, scale});
  std::vector<float> targets = scaled_targets(labels, scale, split, r.shuffle_labels, r.seed);
  const Guesses known = guesses_for(stream, r, scale);
  for (std::size_t i = 0; i < known.raw.size(); ++i)
    targets[i] -= static_cast<float>(scale.scaled(known.raw[i], i % known.width));
  const data::Features features =
      data::Features::fit(stream, split.train, r.experiment.input(r.preset, r.network).pca_components);

  loop::seed_torch(data::key(r.seed, data::Purpose::weights));
  const auto network = networks::make_network(settings.recipe.kind, shape_of(features, scale, known));
  loop::TrainingProgress progress(name, settings.recipe.epochs * split.train.size(), r.quiet);
  progress.line(fmt::format(
      "{} training, {} validation, {} test rows; {} x {} inputs, {:.2f} million weights; {}",
      split.train.size(), split.validation.size(), split.test.size(), features.channels(), features.length(),
      static_cast<double>(networks::parameter_count(*network)) * 1e-6, r.runtime.sentence()));
  const std::vector<float> weights = scale.weights(settings.recipe.loss_power);
  const loop::LoopReport report = loop::train_network(
      *network, {stream, features, split.train, split.validation, targets, known.scaled, weights}, settings,
      progress);
  if (!report.finished) {
    progress.line(fmt::format("saved to {}; submit the same command again to go on", checkpoint.string()));
    return RunOutcome::stopped;
  }
  const auto judged = [&](std::span<const std::uint64_t> rows) {
    const auto out = loop::predict(*network, stream, features, rows, known.scaled);
    return judge(raw_outputs(out, scale, stream.dataset(), rows, known), stream, scale, rows);
  };
  const loop::Score result = judged(split.test);
  const double seen = judged(split.validation).mse;
  // a network that corrects estimates is of no use without whoever makes them
  if (r.save_network && !r.shuffle_labels && r.train_share == 1 && known.none())
    save_network(network_file(file), {stream, r, features, scale, split, run_identity}, *network);
  write_text(file, result_json(stream, r, {split, &features, report, result, seen}).dump(2) + "\n");
  std::filesystem::remove(checkpoint);
  lock.withdraw(true);
  progress.line(fmt::format("{}; MSE {:.4g} on rows of generators that trained; best epoch {} of {}",
                            scored(result, report.seconds), seen, report.best_epoch, report.epochs));
  return RunOutcome::done;
}

}  // namespace swingbank::train::run
