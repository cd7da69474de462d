#include "train/run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/run_lock.hpp"
#include "base/stop_signal.hpp"
#include "mpi/items/one_process.hpp"
#include "train/data/random.hpp"
#include "train/direct/direct.hpp"
#include "train/run/detail/guesses.hpp"
#include "train/run/detail/posterior.hpp"
#include "train/run/detail/result.hpp"
#include "train/run/detail/several.hpp"
#include "train/run/saved_network.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;

/// Returns the keys in which two identities differ, as text.
std::string differing(const json& there, const json& here) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : here.items())
    if (!there.is_object() || !there.contains(key) || there[key] != value) keys.push_back(key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

/// Returns the identity `there` with what may differ taken from `here`: the processor's kernels, and the
/// software if `here` accepts any.
json comparable(json there, const json& here) {
  if (!there.is_object()) return there;
  there["kernels"] = here["kernels"];
  if (here["software"] == "any") there["software"] = "any";
  return there;
}

/// Returns whether the result already exists. Throws InputError if it belongs to another run or other
/// software. A result from another processor is accepted.
bool already_done(const std::filesystem::path& file, const json& run) {
  if (!std::filesystem::exists(file)) return false;
  const json parsed = json::parse(read_text(file), nullptr, false);
  const json there = comparable(parsed.is_object() ? parsed.value("run", json()) : json(), run);
  if (there == run) return true;
  throw InputError({"result of another run", file.string(),
                    fmt::format("it differs from this run's in: {}", differing(there, run)),
                    "remove it, choose another --out, or give --any-maker if only the software differs"});
}

/// Computes the score. `predicted`: rows x parameters [raw units].
loop::Score judge(const std::vector<double>& predicted, const PreparedRun& run,
                  std::span<const std::uint64_t> rows) {
  const data::Labels& labels = run.stream.labels();
  const std::size_t p = labels.parameters;
  std::vector<double> truth(predicted.size());
  for (std::size_t i = 0; i < truth.size(); ++i) truth[i] = labels.values[rows[i / p] * p + i % p];
  const mpi::store::Dataset& d = run.stream.dataset();
  return loop::score({predicted, truth, run.scale.mean, d.parameter_names, d.parameter_units, d.parameter_low,
                      d.parameter_high});
}

/// Estimates of all rows that a network corrects; empty if it corrects none.
struct Guesses {
  std::vector<float> raw,
      scaled;  ///< raw units; in standard deviations about the mean of the training targets
  std::size_t width = 0;
  [[nodiscard]] bool none() const { return raw.empty(); }
};

Guesses guesses_for(const PreparedRun& run) {
  Guesses g;
  if (run.recipe.corrects.empty()) return g;
  g.raw =
      guesses(run.stream, run.recipe.corrects, run.identity["software"], run.request.out, run.request.quiet);
  g.width = run.scale.unit.size();
  for (std::size_t i = 0; i < g.raw.size(); ++i) {
    const std::size_t p = i % g.width;
    g.scaled.push_back(static_cast<float>((g.raw[i] - run.scale.mean[p]) / run.scale.unit[p]));
  }
  return g;
}

networks::NetworkShape shape_of(const data::Features& features, const PreparedRun& run,
                                const Guesses& guesses) {
  const data::TargetScale& scale = run.scale;
  networks::NetworkShape shape{static_cast<std::int64_t>(features.channels()),
                               static_cast<std::int64_t>(features.length()),
                               static_cast<std::int64_t>(scale.unit.size()),
                               {}};
  for (std::size_t p = 0; p < scale.unit.size(); ++p) {
    shape.targets.push_back(
        {run.stream.dataset().parameter_names[p], scale.mean[p], scale.unit[p], scale.origin[p]});
    shape.output_bias.push_back(guesses.none() ? static_cast<float>(scale.scaled(scale.mean[p], p)) : 0.0f);
  }
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

/// Returns the network's estimates in raw units, clamped to the sampling box, which contains every true
/// value. `computed`: as in loop::predict().
std::vector<double> estimates(const Trained& trained, const PreparedRun& run, const Guesses& known,
                              std::span<const std::uint64_t> rows,
                              const std::function<void(std::size_t)>& computed = {}) {
  const auto out =
      loop::predict(*trained.network, run.stream, trained.features, rows, known.scaled, {}, computed);
  const data::TargetScale& scale = run.scale;
  const mpi::store::Dataset& d = run.stream.dataset();
  std::vector<double> raw(out.size());
  const std::size_t p = scale.mean.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double value = known.none() ? scale.raw(out[i], i % p)
                                      : known.raw[rows[i / p] * p + i % p] + out[i] * scale.unit[i % p];
    raw[i] = std::clamp(value, d.parameter_low[i % p], d.parameter_high[i % p]);
  }
  return raw;
}

/// Returns the network of steps_from, and trains it if its result does not exist; null if this training was
/// stopped.
std::unique_ptr<Trained> network_of_start(const PreparedRun& run) {
  RunRequest r = run.request;
  r.network = run.recipe.steps_from;
  const std::size_t rows = r.experiment.judging(r.preset, r.network).test_rows;
  r.test_rows = rows > 0 ? std::optional(rows) : std::nullopt;
  if (train::run::run(run.stream, r) == RunOutcome::stopped) return nullptr;
  return SavedNetwork::load(network_file(r.out / (training_name(r) + ".json"))).release();
}

/// Runs a method without training. It writes no checkpoints, because it takes minutes at most; a stop signal
/// ends it without a result.
RunOutcome run_direct(const PreparedRun& run, const std::filesystem::path& result) {
  const RunRequest& r = run.request;
  const auto& rows = run.split.test;
  if (r.shuffle_labels)
    throw InputError({"shuffled labels for " + r.network, "--shuffle-labels", "this method is not trained",
                      "leave it out, or choose a network"});
  const bool starts = !run.recipe.steps_from.empty();
  const std::unique_ptr<Trained> network = starts ? network_of_start(run) : nullptr;
  if (starts && !network) return RunOutcome::stopped;
  loop::TrainingProgress progress(run_name(r), rows.size(), r.quiet);
  progress.line(fmt::format("{} test rows; the method is not trained", rows.size()));
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  const auto estimated = [&](std::size_t done) { progress.update(done, "rows estimated"); };
  const mpi::store::Dataset& d = run.stream.dataset();
  const data::NoiseRecipe& noise = run.stream.noise();
  const auto found =
      starts ? direct::estimate_from(d, rows, estimates(*network, run, {}, rows), noise, estimated)
             : direct::estimate(d, rows, r.network, noise, estimated);
  loop::LoopReport report;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report.processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  const loop::Score score = judge(found, run, rows);
  const bool estimates_rows = r.network != "floor";
  const json several = estimates_rows ? several_json(run.stream.labels(), rows, found) : json();
  const std::span<const double> listed =
      estimates_rows ? std::span<const double>(found) : std::span<const double>();
  write_text(result, result_json(run, {nullptr, report, score, {}, {}, several, listed}).dump(2) + "\n");
  progress.line(scored(score, report.seconds));
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

std::string training_name(const RunRequest& r) {
  RunRequest plain = r;
  if (r.experiment.training(r.preset, r.network).noise_levels) plain.noise = 0;
  return run_name(plain);
}

namespace {

/// Training of a network, and its score.
class NetworkRun {
 public:
  NetworkRun(const PreparedRun& run, const mpi::items::Ranks& ranks)
      : run_(run),
        ranks_(ranks),
        known_(guesses_for(run)),
        name_(training_name(run.request)),
        checkpoint_(run.request.out / "checkpoints" / (name_ + ".checkpoint")),
        quiet_(run.request.quiet || ranks.rank() != 0),
        progress_(name_, epochs() * run.split.train.size(), quiet_) {}

  /// Returns the trained network; none if the training was stopped and the command must be submitted again.
  /// Collective; only rank 0 may use the network.
  std::optional<Trained> train() {
    const RunRequest& r = run_.request;
    Trained trained;
    if (run_.recipe.noise_levels && ranks_.from_first(ranks_.rank() == 0 && load(trained) ? 1 : 0) != 0)
      return trained;
    trained.features = data::Features::fit(run_.stream, run_.split.train,
                                           r.experiment.input(r.preset, r.network).pca_components);
    loop::seed_torch(data::key(r.seed, data::Purpose::weights));
    trained.network = networks::make_network(run_.recipe.kind, shape_of(trained.features, run_, known_));
    print_sizes(trained);
    const std::vector<float> targets = targets_of_training(),
                             weights = run_.scale.weights(run_.recipe.loss_power);
    trained.report = loop::train_network(*trained.network,
                                         {run_.stream,
                                          trained.features,
                                          run_.split.train,
                                          run_.split.validation,
                                          targets,
                                          known_.scaled,
                                          weights,
                                          {},
                                          fresh_rows()},
                                         settings(name_), progress_);
    progress_.keep_chart();
    if (!trained.report.finished || (run_.recipe.posterior_epochs > 0 && !train_head(trained))) {
      progress_.line(
          fmt::format("saved to {}; run the same command again to continue", checkpoint_.string()));
      return std::nullopt;
    }
    // A network that corrects estimates is not saved, because it cannot be used without them.
    if (ranks_.rank() == 0 && r.save_network && !r.shuffle_labels && r.train_share == 1 && known_.none())
      save_network(file(), run_, trained);
    return trained;
  }

  void judge_to(const std::filesystem::path& result, const Trained& trained) {
    const data::RowSplit& split = run_.split;
    loop::TrainingProgress progress(name_, split.test.size() + split.validation.size(), quiet_);
    const auto found_for = [&](std::span<const std::uint64_t> rows, std::size_t before) {
      return estimates(trained, run_, known_, rows, [&progress, before](std::size_t computed) {
        progress.update(before + computed, "rows estimated");
      });
    };
    const std::vector<double> found = found_for(split.test, 0);
    const loop::Score score = judge(found, run_, split.test);
    const double seen = judge(found_for(split.validation, split.test.size()), run_, split.validation).mse;
    const bool head = trained.posterior.head != nullptr;
    const json believed = head ? judge_posterior(run_, trained) : json();
    const json several = several_json(run_.stream.labels(), split.test, found,
                                      head ? product_of_posteriors(run_, trained) : FromSeveral());
    const RunParts parts = {&trained.features, trained.report, score, seen, believed, several, found};
    write_text(result, result_json(run_, parts).dump(2) + "\n");
    for (const char* kind : {".checkpoint", ".posterior.checkpoint"})
      std::filesystem::remove(std::filesystem::path(checkpoint_).replace_extension(kind));
    progress.line(fmt::format("{}; MSE {:.4g} on validation rows; best epoch {} of {}",
                              scored(score, trained.report.seconds), seen, trained.report.best_epoch,
                              trained.report.epochs));
  }

 private:
  [[nodiscard]] std::size_t epochs() const { return run_.request.epochs.value_or(run_.recipe.epochs); }
  [[nodiscard]] std::filesystem::path file() const {
    return network_file(run_.request.out / (name_ + ".json"));
  }
  /// Loads the network that an earlier run at another noise level has trained. Returns false if there is
  /// none.
  bool load(Trained& trained) {
    if (!std::filesystem::exists(file())) return false;
    SavedNetwork saved = SavedNetwork::load(file());
    if (comparable(saved.identity(), run_.training_identity) != run_.training_identity) return false;
    trained = std::move(*saved.release());
    progress_.line(fmt::format("already trained: {}", file().string()));
    return true;
  }
  [[nodiscard]] std::vector<float> targets() const {
    const RunRequest& r = run_.request;
    return scaled_targets(run_.stream.labels(), run_.scale, run_.split, r.shuffle_labels, r.seed);
  }
  /// Returns LoopData::fresh: rows of new events, with their targets.
  [[nodiscard]] std::function<std::optional<loop::EpochRows>(std::size_t)> fresh_rows() const {
    if (!run_.request.fresh) return {};
    return [this](std::size_t epoch) -> std::optional<loop::EpochRows> {
      data::StreamOptions options = run_.stream.options();
      options.memory_limit -= run_.stream.bytes();
      auto stream = run_.request.fresh(epoch, options);
      if (!stream) return std::nullopt;
      auto targets = scaled_targets(stream->labels(), run_.scale, run_.split, false, run_.request.seed);
      auto rows = trainable(stream->labels(), run_);
      return loop::EpochRows{std::move(stream), std::move(rows), std::move(targets)};
    };
  }
  bool train_head(Trained& trained) {
    loop::TrainingProgress progress(name_ + ", posterior",
                                    run_.recipe.posterior_epochs * run_.split.train.size(), quiet_);
    return train_posterior(trained, run_, settings(name_ + "-posterior"), targets(), progress);
  }
  /// Returns the settings of a training; `curve`: name of its learning curve.
  [[nodiscard]] loop::LoopSettings settings(const std::string& curve) {
    loop::LoopSettings s;
    s.recipe = run_.recipe;
    s.recipe.epochs = epochs();
    s.seed = run_.request.seed;
    s.checkpoint = checkpoint_;
    s.run = &run_.training_identity;
    s.gflops = run_.request.runtime.gflops;
    s.stop = run_.request.stop;
    s.ranks = &ranks_;
    const bool drawn = run_.request.watch && curve == name_;
    s.epoch_done = [this, drawn,
                    files = std::make_shared<loop::LearningCurveFiles>(run_.request.out / "curves", curve)](
                       const loop::LearningCurve& so_far) {
      files->write(so_far);
      if (drawn) progress_.chart(loop::learning_curve_chart(so_far));
    };
    return s;
  }
  [[nodiscard]] std::vector<float> targets_of_training() const {
    std::vector<float> all = targets();
    for (std::size_t i = 0; i < known_.raw.size(); ++i)
      all[i] -= static_cast<float>(run_.scale.scaled(known_.raw[i], i % known_.width));
    return all;
  }
  void print_sizes(const Trained& trained) {
    const runtime::Runtime& runtime = run_.request.runtime;
    progress_.line(
        fmt::format("{} training, {} validation, {} test rows; {} x {} inputs, {:.2f} million weights; {}",
                    run_.split.train.size(), run_.split.validation.size(), run_.split.test.size(),
                    trained.features.channels(), trained.features.length(),
                    static_cast<double>(networks::parameter_count(*trained.network)) * 1e-6,
                    ranks_.size() > 1 ? fmt::format("{} ranks of {}", ranks_.size(), runtime.sentence())
                                      : runtime.sentence()));
  }
  const PreparedRun& run_;
  const mpi::items::Ranks& ranks_;
  const Guesses known_;
  const std::string name_;
  const std::filesystem::path checkpoint_;
  const bool quiet_;
  loop::TrainingProgress progress_;
};

RunOutcome train_and_judge(const PreparedRun& run, const mpi::items::Ranks& ranks,
                           const std::filesystem::path& result) {
  NetworkRun network(run, ranks);
  const std::optional<Trained> trained = network.train();
  if (!trained) return RunOutcome::stopped;
  if (ranks.rank() == 0) network.judge_to(result, *trained);
  return RunOutcome::done;
}

/// Locks the run; called on rank 0. Returns false if the result already exists.
bool begin(const PreparedRun& run, const std::filesystem::path& result, std::optional<RunLock>& lock) {
  if (already_done(result, run.identity)) return false;
  const auto locks = run.request.out / "checkpoints";
  make_folder(run.request.out);
  make_folder(locks);
  // Runs that differ only in the noise level wait for the network that they share.
  const std::chrono::milliseconds patience =
      run.recipe.noise_levels ? std::chrono::hours(12) : run.request.patience;
  lock.emplace(
      locks / (training_name(run.request) + ".lock"),
      LockWords{"result file in use", result.string(), "wait until that run ends, or choose another --out"},
      patience);
  return !already_done(result, run.identity);
}

}  // namespace

RunOutcome run(const data::ShardStream& stream, const RunRequest& r) {
  const mpi::items::OneProcess alone;
  const mpi::items::Ranks& ranks = r.ranks == nullptr ? alone : *r.ranks;
  const std::filesystem::path result = r.out / (run_name(r) + ".json");
  std::optional<PreparedRun> prepared;
  std::optional<RunLock> lock;
  bool needed = false;
  ranks.agree(run_name(r), [&] {
    prepared.emplace(prepare(stream, r));
    if (ranks.size() > 1 && !is_trained(r))
      throw InputError({fmt::format("{} ranks for {}", ranks.size(), r.network), "mpirun",
                        "this method is not trained, and runs in one process", "start it without mpirun"});
    const std::size_t batch = prepared->recipe.batch;
    if (static_cast<std::size_t>(ranks.size()) > batch)
      throw InputError({fmt::format("{} ranks", ranks.size()), "mpirun",
                        fmt::format("a batch has {} rows, and each rank needs one", batch),
                        "start fewer ranks, or raise batch in the experiment"});
    if (ranks.rank() == 0) needed = begin(*prepared, result, lock);
  });
  if (ranks.from_first(needed ? 1 : 0) == 0) return RunOutcome::already_done;
  RunOutcome outcome = RunOutcome::stopped;
  until_interrupted([&] {
    outcome = is_trained(r) ? train_and_judge(*prepared, ranks, result) : run_direct(*prepared, result);
  });
  if (lock && outcome == RunOutcome::done) lock->withdraw(true);
  return outcome;
}

}  // namespace swingbank::train::run
