#pragma once
// Options shared by `swingbank train` and `swingbank cross-validate`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>
#include <string>

#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "jobs/kept_experiment.hpp"
#include "mpi/draw/simulated_shards.hpp"
#include "train/run/run.hpp"
#include "train/runtime/blas_kernels.hpp"

namespace swingbank {

/// Values of the shared options.
struct TrainingOptions {
  std::string dataset, training_rows, experiment, preset = "quick", network, out, print, keep;
  std::uint64_t seed = 1;
  std::size_t epochs = 0;
  int threads = 0;
  unsigned readers = 1;
  double memory_limit = 8.0;  // [GiB]
  double noise = 0, train_share = 1;
  std::size_t test_rows = 0;
  std::string simulate;
  mpi::draw::Overrides simulated, simulated_more;
  bool fresh_rows = false, shuffle_labels = false, save_network = true, trust = false, any_maker = false,
       watch = false;

  void add_to(jobs::CommandLine& line) {
    line.add("DATASET", dataset, "folder that `swingbank generate` wrote");
    line.add(
        "--simulate", simulate,
        "simulate the events of this dataset config in memory instead of reading DATASET; nothing is written; "
        "results equal those of the stored dataset");
    line.add("--draws", simulated.draws, "with --simulate: number of events; overrides the config")
        .positive();
    line.add("--draw-seed", simulated.seed, "with --simulate: seed of the draws; overrides the config")
        .not_negative();
    line.add(
        "--training-rows", training_rows,
        "additional training rows: folder of the dataset generated from the experiment's training_dataset; with "
        "--simulate: the config of that dataset");
    line.add("--training-draws", simulated_more.draws,
             "with --simulate: number of events of --training-rows; overrides the config")
        .positive();
    line.add_flag(
        "--fresh-rows", fresh_rows,
        "with --simulate: simulate new events for every epoch after the first; test and validation rows "
        "stay the same");
    line.add("--experiment", experiment, "file of configs/experiments: table, dataset, presets").required();
    line.add("--preset", preset, "preset of the experiment, for example quick, nightly or thesis")
        .shows_default();
    line.add("--network", network, "network of the preset (default: its first)");
    line.add("--out", out, "folder for the result files");
    line.add("--seed", seed, "seed of the weights, the dropout, the order of the rows and the split")
        .shows_default();
    line.add(
            "--noise", noise,
            "relative noise level L (0.001: 0.1 %): P, Q and V in pu of machine base, theta in rad; L/20 for speed; "
            "L times the value for Efd and Ifd")
        .shows_default();
    line.add("--test-rows", test_rows,
             "evaluate on N of the test rows, drawn at random (default: the preset's)");
    line.add("--train-share", train_share, "fraction of the training rows to train on").shows_default();
    line.add("--epochs", epochs, "number of epochs; overrides the preset");
    line.add(
        "--threads", threads,
        "number of threads, divided among the processes; default: the Slurm allocation, OMP_NUM_THREADS or the "
        "number of cores");
    line.add("--readers", readers,
             "number of threads that read the shards if the dataset does not fit in memory")
        .shows_default();
    line.add("--memory-limit", memory_limit, "maximum size of the time series that are kept in memory [GiB]")
        .shows_default();
    line.add_flag(
        "--trust", trust,
        "do not compare the shards with the hashes in the dataset's journal (comparing takes 0.1 s for 268 MB)");
    line.add_flag("--any-maker", any_maker,
                  "accept results and checkpoints written by another software version or CPU type");
    line.add_flag("--shuffle-labels", shuffle_labels,
                  "control run: shuffle the labels; the MSE must then equal that of predicting the mean");
    line.add_flag_off("--no-network", save_network,
                      "do not write the trained network beside its result (4 bytes a weight)");
    line.add("--print", print,
             fmt::format("print one entry of the experiment and exit: {}",
                         fmt::join(train::loop::kPrintable, ", ")));
    line.add(
        "--keep", keep,
        "copy the experiment, the configs of its datasets and all files that these name into this folder, "
        "print the path of the copy and exit");
  }

  /// Returns the training run that the options describe. Throws InputError if an option is missing or
  /// invalid.
  [[nodiscard]] train::run::RunRequest request() const {
    Problems problems;
    if (dataset.empty() && simulate.empty())
      problems.add("no dataset", "DATASET", "a run needs one",
                   "give the folder that `swingbank generate` wrote, or --simulate with a dataset's config");
    if (!simulate.empty() && !dataset.empty())
      problems.add("two datasets", "--simulate", "DATASET and --simulate exclude each other",
                   "give one of the two");
    if (simulate.empty() && (simulated.draws || simulated.seed || simulated_more.draws || fresh_rows))
      problems.add("no config to simulate", "--draws, --draw-seed, --training-draws, --fresh-rows",
                   "they change values of a config or simulate it", "give --simulate, or leave them out");
    if (training_rows.empty() && simulated_more.draws)
      problems.add("no second config to simulate", "--training-draws", "it changes a value of that config",
                   "give --training-rows, or leave it out");
    if (fresh_rows && shuffle_labels)
      problems.add("new rows with shuffled labels", "--fresh-rows, --shuffle-labels",
                   "the labels of stored rows are shuffled", "give one of the two");
    if (out.empty()) problems.add("no output folder", "--out", "results need a folder", "give a folder");
    if (!(noise >= 0 && noise <= 0.1))
      problems.add(fmt::format("a noise level of {}", noise), "--noise", "a level lies between 0 and 0.1",
                   "give 0.001 for 0.1 %");
    if (!(train_share > 0 && train_share <= 1))
      problems.add(fmt::format("a share of {}", train_share), "--train-share", "it lies between 0 and 1",
                   "give 0.5 for half of the training rows");
    problems.raise();
    train::run::RunRequest r;
    r.experiment = train::loop::read_experiment(experiment);
    r.preset = preset;
    r.network = network.empty() ? r.experiment.preset(preset).networks.at(0) : network;
    r.seed = seed;
    if (epochs > 0) r.epochs = epochs;
    r.shuffle_labels = shuffle_labels;
    r.any_maker = any_maker;
    r.save_network = save_network;
    r.watch = watch;
    r.noise = noise;
    r.train_share = train_share;
    const std::size_t judged = test_rows > 0 ? test_rows : r.experiment.judging(preset, r.network).test_rows;
    if (judged > 0) r.test_rows = judged;
    r.out = out;
    if (fresh_rows)
      r.fresh = [this, recipe = r.experiment.input(preset, r.network).recipe](
                    std::size_t epoch, const train::data::StreamOptions& stream) {
        return fresh(recipe, stream, epoch);
      };
    check_training_rows(r.experiment.training(preset, r.network).training_rows, r.network);
    return r;
  }
  /// Throws InputError if --training-rows is given although the experiment does not use such rows, or is
  /// missing although it does. Otherwise runs on different rows would have the same name.
  void check_training_rows(bool wanted, const std::string& of) const {
    if (wanted == !training_rows.empty()) return;
    throw InputError(
        {wanted ? "no additional training rows" : "additional training rows", "--training-rows",
         fmt::format("network {} of preset {} in {} {} them", of, preset, experiment,
                     wanted ? "trains on" : "does not train on"),
         wanted ? "give the folder of the experiment's training_dataset, or with --simulate its config"
                : "leave it out"});
  }
  /// Returns the stream of the dataset's rows, read from disk or simulated in memory.
  [[nodiscard]] train::data::ShardStream open(const train::run::RunRequest& r) const {
    const auto bytes = static_cast<std::uint64_t>(memory_limit * static_cast<double>(std::uint64_t{1} << 30));
    const train::data::StreamOptions stream{
        bytes, readers, trust, {r.noise, r.seed, r.experiment.training(preset, r.network).noise_levels}};
    const train::data::InputRecipe& recipe = r.experiment.input(preset, r.network).recipe;
    if (!simulate.empty()) return simulated_stream(recipe, stream, 0);
    std::optional<mpi::store::Dataset> more;
    if (!training_rows.empty()) more = mpi::store::open_dataset(training_rows);
    return {mpi::store::open_dataset(dataset), recipe, stream, more};
  }

 private:
  /// Simulates the rows in memory. `later`: number that is added to the seeds of the configs.
  [[nodiscard]] train::data::ShardStream simulated_stream(const train::data::InputRecipe& recipe,
                                                          const train::data::StreamOptions& stream,
                                                          std::uint64_t later) const {
    using mpi::draw::SimulatedShards;
    using train::data::ShardSource;
    const auto shards_of = [&](const std::string& file, const mpi::draw::Overrides& overrides) {
      mpi::draw::DatasetConfig config = mpi::draw::read_dataset_config(file, overrides);
      config.seed += later;
      return std::make_unique<SimulatedShards>(config,
                                               threads > 0 ? threads : train::runtime::default_threads());
    };
    const auto source_of = [](SimulatedShards& shards) {
      return ShardSource{shards.header(), [&shards] { return shards.next(); }};
    };
    const auto shards = shards_of(simulate, simulated);
    if (training_rows.empty()) return {source_of(*shards), recipe, stream};
    const auto more = shards_of(training_rows, simulated_more);
    const ShardSource further = source_of(*more);
    return {source_of(*shards), recipe, stream, &further};
  }
  /// Returns the stream of new events for an epoch; null after a stop signal.
  [[nodiscard]] std::shared_ptr<const train::data::ShardStream> fresh(
      const train::data::InputRecipe& recipe, const train::data::StreamOptions& stream,
      std::size_t epoch) const {
    try {
      return std::make_shared<const train::data::ShardStream>(simulated_stream(recipe, stream, epoch));
    } catch (const InputError&) {
      if (stop_asked()) return nullptr;
      throw;
    }
  }
};

inline int exit_code(train::run::RunOutcome outcome) {
  return outcome == train::run::RunOutcome::stopped ? kSubmitAgain : 0;
}

/// Main function of both commands: options, --print, --keep, stop signals. `check` throws InputError if the
/// request cannot be fulfilled; it is called before the BLAS kernels are measured.
template <class Check, class Work>
int training_main(int argc, char** argv, jobs::CommandLine& line, TrainingOptions& options,
                  const Check& check, const Work& work) {
  options.add_to(line);
  if (!line.parse(argc, argv)) return line.end();
  if (!options.print.empty()) {
    fmt::print("{}\n", train::loop::read_experiment(options.experiment).print(options.preset, options.print));
    return 0;
  }
  if (!options.keep.empty()) {
    train::loop::read_experiment(options.experiment);
    fmt::print("{}\n", jobs::keep_experiment(options.experiment, options.keep).string());
    return 0;
  }
  train::run::RunRequest request = options.request();
  check(request);
  train::runtime::use_best_blas_kernels(argv);
  catch_stop_signals();
  return work(std::move(request));
}

}  // namespace swingbank
