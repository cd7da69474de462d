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

/// Returns true if the result already exists. Throws if it is that of another run. A finished result may come
/// from another processor, which is reported, but not from other software.
bool already_done(const std::filesystem::path& file, const json& run) {
  if (!std::filesystem::exists(file)) return false;
  const json parsed = json::parse(read_text(file), nullptr, false);
  json there = parsed.is_object() ? parsed.value("run", json()) : json();
  if (there.is_object()) {
    there["kernels"] = run["kernels"];
    if (run["software"] == "any") there["software"] = "any";
  }
  if (there == run) return true;
  throw InputError({"result of another run", file.string(),
                    fmt::format("it differs from this run's in: {}", differing(there, run)),
                    "remove it, choose another --out, or give --any-maker if only the software differs"});
}

/// Computes the score. `predicted`: `rows` x parameters [raw units].
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

/// Estimates that a network corrects, for all rows; empty if it corrects none.
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

/// Returns raw values clamped to the sampling box, which contains every truth.
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
                                const Guesses& guesses, const mpi::store::DatasetHeader& d) {
  networks::NetworkShape shape{static_cast<std::int64_t>(features.channels()),
                               static_cast<std::int64_t>(features.length()),
                               static_cast<std::int64_t>(scale.unit.size()),
                               {}};
  for (std::size_t p = 0; p < scale.unit.size(); ++p)
    shape.targets.push_back({d.parameter_names[p], scale.mean[p], scale.unit[p], scale.origin[p]});
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

/// Keeps about `wanted` rows, evenly spaced.
void thin(std::vector<std::uint64_t>& rows, std::size_t wanted) {
  const std::size_t every = std::max<std::size_t>(1, rows.size() / wanted);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); i += every) rows[kept++] = rows[i];
  rows.resize(kept);
}

/// Throws if a method needs complete records but the dataset is not on disk.
void require_records(const data::ShardStream& stream, const RunRequest& r) {
  const bool reads =
      direct::is_method(r.network) || !r.experiment.training(r.preset, r.network).corrects.empty();
  if (reads && stream.from_memory())
    throw InputError({"network " + r.network, "--simulate",
                      "it reads whole records, which training from memory does not keep",
                      "generate the dataset on a disk, or choose a network that reads series alone"});
}

/// What a request determines before any work: name and identity of the result, rows, scale of the targets.
struct PreparedRun {
  std::string name;
  std::filesystem::path file;  ///< result
  json identity;               ///< two runs with equal identities give the same result
  data::RowSplit split;
  data::TargetScale scale;
};

data::RowSplit split_of(const data::Labels& labels, const RunRequest& r) {
  const loop::TrainingRecipe& recipe = r.experiment.training(r.preset, r.network);
  data::RowSplit split = r.generator ? data::leave_one_out(labels, {*r.generator, recipe.validation_share,
                                                                    r.seed, r.judged, recipe.set_aside})
                         : r.experiment.across ? data::split_across(labels, recipe.validation_share, r.seed)
                                               : data::split_by_point(labels, r.seed);
  if (r.test_rows) thin(split.test, *r.test_rows);
  if (r.train_share < 1) data::keep_share(split, labels, r.train_share);
  return split;
}

PreparedRun prepare(const data::ShardStream& stream, const RunRequest& r) {
  require_records(stream, r);
  const data::Labels& labels = stream.labels();
  data::RowSplit split = split_of(labels, r);
  data::TargetScale scale =
      data::TargetScale::fit(labels.values, labels.parameters, split.train, stream.dataset().parameter_low);
  const std::string name = run_name(r);
  return {name, r.out / (name + ".json"), identity(stream, r), std::move(split), std::move(scale)};
}

/// Runs a method without training. No checkpoints: such a run takes minutes at most.
RunOutcome run_direct(const data::ShardStream& stream, const RunRequest& r, const PreparedRun& d) {
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
  const json several = r.network == "floor" ? json() : several_json(stream.labels(), d.split.test, found);
  write_text(d.file,
             result_json(stream, r, {d.split, nullptr, report, result, {}, {}, several}).dump(2) + "\n");
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

std::string training_name(const RunRequest& r) {
  RunRequest plain = r;
  if (r.experiment.training(r.preset, r.network).noise_levels) plain.noise = 0;
  return run_name(plain);
}

namespace {

/// A run of a network, from the split to the result.
class NetworkRun {
 public:
  NetworkRun(const data::ShardStream& stream, const RunRequest& request, const mpi::items::Ranks& ranks,
             const PreparedRun& prepared)
      : stream_(stream),
        request_(request),
        ranks_(ranks),
        recipe_(request.experiment.training(request.preset, request.network)),
        split_(prepared.split),
        scale_(prepared.scale),
        known_(guesses_for(stream, request, prepared.scale)),
        name_(training_name(request)),
        identity_(training_identity(stream, request)),
        checkpoint_(request.out / "checkpoints" / (name_ + ".checkpoint")),
        progress_(name_, epochs() * split_.train.size(), request.quiet || ranks.rank() != 0) {}

  /// Trains the network. Returns false if it was stopped and must be submitted again. Collective; only rank 0
  /// may use the network afterwards.
  bool train() {
    if (recipe_.noise_levels && ranks_.from_first(ranks_.rank() == 0 && load() ? 1 : 0) != 0) return true;
    features_ = data::Features::fit(
        stream_, split_.train, request_.experiment.input(request_.preset, request_.network).pca_components);
    loop::seed_torch(data::key(request_.seed, data::Purpose::weights));
    network_ = networks::make_network(recipe_.kind, shape_of(features_, scale_, known_, stream_.dataset()));
    print_sizes();
    const std::vector<float> targets = targets_of_training(), weights = scale_.weights(recipe_.loss_power);
    report_ = loop::train_network(
        *network_, {stream_, features_, split_.train, split_.validation, targets, known_.scaled, weights},
        settings(name_), progress_);
    progress_.keep_chart();
    const bool whole = report_.finished && (recipe_.posterior_epochs == 0 || train_head());
    if (!whole) {
      progress_.line(
          fmt::format("saved to {}; submit the same command again to continue", checkpoint_.string()));
      return false;
    }
    // A network that corrects estimates is not saved: it cannot be used without them.
    if (ranks_.rank() == 0 && request_.save_network && !request_.shuffle_labels &&
        request_.train_share == 1 && known_.none())
      save_network(file(), {stream_, request_, features_, scale_, split_, identity_, report_, *posterior_},
                   *network_);
    return true;
  }

  void judge_to(const std::filesystem::path& result) {
    const std::vector<double> found = estimates(split_.test);
    const loop::Score score = judge(found, stream_, scale_, split_.test);
    const double seen = judge(estimates(split_.validation), stream_, scale_, split_.validation).mse;
    const json believed = posterior_->head ? judge_posterior(*posterior_, context()) : json();
    const json several =
        several_json(stream_.labels(), split_.test, found,
                     posterior_->head ? product_of_posteriors(*posterior_, context()) : FromSeveral());
    const RunParts parts = {split_, &features_, report_, score, seen, believed, several};
    write_text(result, result_json(stream_, request_, parts).dump(2) + "\n");
    for (const char* kind : {".checkpoint", ".posterior.checkpoint"})
      std::filesystem::remove(std::filesystem::path(checkpoint_).replace_extension(kind));
    progress_.line(fmt::format("{}; MSE {:.4g} on rows of generators that trained; best epoch {} of {}",
                               scored(score, report_.seconds), seen, report_.best_epoch, report_.epochs));
  }

 private:
  [[nodiscard]] std::size_t epochs() const { return request_.epochs.value_or(recipe_.epochs); }
  [[nodiscard]] std::filesystem::path file() const { return network_file(request_.out / (name_ + ".json")); }
  /// Loads the network that an earlier run of another noise level trained.
  bool load() {
    if (!std::filesystem::exists(file())) return false;
    SavedNetwork saved = SavedNetwork::load(file());
    if (saved.identity() != identity_) return false;
    features_ = saved.features();
    report_ = saved.report();
    network_ = saved.release();
    posterior_ = saved.release_posterior();
    progress_.line(fmt::format("trained already: {}", file().string()));
    return true;
  }
  [[nodiscard]] PosteriorContext context() const {
    return {stream_, features_, scale_, split_, recipe_, request_.seed};
  }
  bool train_head() {
    const std::vector<float> targets =
        scaled_targets(stream_.labels(), scale_, split_, request_.shuffle_labels, request_.seed);
    loop::TrainingProgress progress(name_ + ", posterior", recipe_.posterior_epochs * split_.train.size(),
                                    request_.quiet || ranks_.rank() != 0);
    return train_posterior(*posterior_, *network_, context(), settings(name_ + "-posterior"), targets,
                           progress);
  }
  /// Returns the settings of a training; `curve`: name of its learning curve.
  [[nodiscard]] loop::LoopSettings settings(const std::string& curve) {
    loop::LoopSettings s;
    s.recipe = recipe_;
    s.recipe.epochs = epochs();
    s.seed = request_.seed;
    s.checkpoint = checkpoint_;
    s.run = &identity_;
    s.gflops = request_.runtime.gflops;
    s.stop = request_.stop;
    s.ranks = &ranks_;
    const bool drawn = request_.watch && curve == name_;
    s.epoch_done = [this, drawn,
                    files = std::make_shared<loop::LearningCurveFiles>(request_.out / "curves", curve)](
                       const loop::LearningCurve& so_far) {
      files->write(so_far);
      if (drawn) progress_.chart(loop::learning_curve_chart(so_far));
    };
    return s;
  }
  [[nodiscard]] std::vector<float> targets_of_training() const {
    std::vector<float> targets =
        scaled_targets(stream_.labels(), scale_, split_, request_.shuffle_labels, request_.seed);
    for (std::size_t i = 0; i < known_.raw.size(); ++i)
      targets[i] -= static_cast<float>(scale_.scaled(known_.raw[i], i % known_.width));
    return targets;
  }
  void print_sizes() {
    progress_.line(fmt::format(
        "{} training, {} validation, {} test rows; {} x {} inputs, {:.2f} million weights; {}",
        split_.train.size(), split_.validation.size(), split_.test.size(), features_.channels(),
        features_.length(), static_cast<double>(networks::parameter_count(*network_)) * 1e-6,
        ranks_.size() > 1 ? fmt::format("{} ranks of {}", ranks_.size(), request_.runtime.sentence())
                          : request_.runtime.sentence()));
  }
  [[nodiscard]] std::vector<double> estimates(std::span<const std::uint64_t> rows) {
    const auto out = loop::predict(*network_, stream_, features_, rows, known_.scaled);
    return raw_outputs(out, scale_, stream_.dataset(), rows, known_);
  }

  const data::ShardStream& stream_;
  const RunRequest& request_;
  const mpi::items::Ranks& ranks_;
  const loop::TrainingRecipe& recipe_;
  const data::RowSplit& split_;
  const data::TargetScale& scale_;
  const Guesses known_;
  const std::string name_;
  const json identity_;
  const std::filesystem::path checkpoint_;
  loop::TrainingProgress progress_;
  data::Features features_;
  std::unique_ptr<networks::Network> network_;
  std::unique_ptr<Posterior> posterior_ = std::make_unique<Posterior>();
  loop::LoopReport report_;
};

}  // namespace

namespace {

/// Locks the run on rank 0. Returns false if its result exists already.
bool begin(const RunRequest& r, const PreparedRun& prepared, std::optional<RunLock>& lock) {
  if (already_done(prepared.file, prepared.identity)) return false;
  const auto locks = r.out / "checkpoints";
  make_folder(r.out);
  make_folder(locks);
  // Runs of other noise levels wait for their common network.
  const std::chrono::seconds patience = r.experiment.training(r.preset, r.network).noise_levels
                                            ? std::chrono::hours(12)
                                            : std::chrono::seconds(5);
  lock.emplace(
      locks / (training_name(r) + ".lock"),
      LockWords{"a second run", prepared.file.string(), "wait for it to end, or choose another --out"},
      patience);
  return !already_done(prepared.file, prepared.identity);
}

}  // namespace

RunOutcome run(const data::ShardStream& stream, const RunRequest& r) {
  const mpi::items::OneProcess alone;
  const mpi::items::Ranks& ranks = r.ranks == nullptr ? alone : *r.ranks;
  std::optional<PreparedRun> prepared;
  std::optional<RunLock> lock;
  bool needed = false;
  ranks.agree(run_name(r), [&] {
    prepared.emplace(prepare(stream, r));
    if (ranks.size() > 1 && direct::is_method(r.network))
      throw InputError({fmt::format("{} ranks for {}", ranks.size(), r.network), "mpirun",
                        "this method has no training that ranks could share", "start it without mpirun"});
    const std::size_t batch = r.experiment.training(r.preset, r.network).batch;
    if (static_cast<std::size_t>(ranks.size()) > batch)
      throw InputError({fmt::format("{} ranks", ranks.size()), "mpirun",
                        fmt::format("a batch has {} rows, and each rank needs one", batch),
                        "start fewer ranks, or raise batch in the experiment"});
    if (ranks.rank() == 0) needed = begin(r, *prepared, lock);
  });
  if (ranks.from_first(needed ? 1 : 0) == 0) return RunOutcome::already_done;
  if (direct::is_method(r.network)) return run_direct(stream, r, *prepared);
  NetworkRun network(stream, r, ranks, *prepared);
  if (!network.train()) return RunOutcome::stopped;
  if (ranks.rank() != 0) return RunOutcome::done;
  network.judge_to(prepared->file);
  lock->withdraw(true);
  return RunOutcome::done;
}

}  // namespace swingbank::train::run
