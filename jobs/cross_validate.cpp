// swingbank cross-validate: leave-one-generator-out cross-validation (the thesis's Tables V and VI).
// Processes started by mpirun or srun divide the folds among them. A task of a Slurm job array trains one
// fold (--fold).
#include "train/run/cross_validate.hpp"

#include "jobs/training_options.hpp"
#include "train/run/processes.hpp"

namespace swingbank::jobs::cross_validate_command {
namespace {

std::vector<std::int32_t> folds_of(const std::string& text, const train::loop::Experiment& experiment,
                                   const char* option = "--fold") {
  if (text == "all") return experiment.folds;
  for (const std::int32_t fold : experiment.folds)
    if (std::to_string(fold) == text) return {fold};
  throw InputError(
      {fmt::format("no fold '{}'", text), option,
       fmt::format("{} leaves out {}", experiment.file.string(), fmt::join(experiment.folds, ", ")),
       "give one of these bus numbers, or all"});
}

/// Trains the folds of one process. Prints errors and returns the exit code.
int train_folds(const train::data::ShardStream& stream, train::run::RunRequest request,
                const std::vector<std::int32_t>& folds, int threads) {
  try {
    request.runtime = train::runtime::set_up_runtime(threads);
    const train::run::RunOutcome outcome = train::run::cross_validate(stream, std::move(request), folds);
    if (outcome == train::run::RunOutcome::already_done)
      fmt::print(stderr, "folds {}: done already\n", fmt::join(folds, ", "));
    return exit_code(outcome);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
/// Trains each fold once for every generator of --judge-on except the fold's own. That generator is also
/// excluded from the training, and the network is scored on it.
int train_nested(const train::data::ShardStream& stream, train::run::RunRequest request,
                 const std::vector<std::int32_t>& folds, const std::string& judged, int threads) {
  for (const std::int32_t fold : folds)
    for (const std::int32_t other : folds_of(judged, request.experiment, "--judge-on")) {
      if (other == fold) continue;
      request.judged = other;
      if (const int code = train_folds(stream, request, {fold}, threads); code != 0) return code;
    }
  return 0;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  TrainingOptions options;
  std::string fold = "all", judged;
  int processes = 0;
  line.add("--fold", fold, "bus number of the generator to leave out, or all").shows_default();
  line.add("--judge-on", judged,
           "bus number of a second generator to exclude from the training and to score on, "
           "instead of the fold's own (for the selection of settings); all: every other generator in turn");
  line.add("--processes", processes,
           "number of processes for the folds; the threads are divided among them (default: one "
           "per core; 1 if mpirun or srun started several)");
  const auto check = [&](const train::run::RunRequest& request) {
    if (request.experiment.split != train::loop::Split::leave_one_out)
      throw InputError({"this experiment has no folds", options.experiment,
                        "its split does not leave out single generators", "use swingbank train"});
    if (processes < 0)
      throw InputError({fmt::format("{} processes", processes), "--processes",
                        "at least one process is needed", "use 1 or more"});
    static_cast<void>(folds_of(fold, request.experiment));
    if (!judged.empty()) static_cast<void>(folds_of(judged, request.experiment, "--judge-on"));
  };
  return training_main(argc, argv, line, options, check, [&](const train::run::RunRequest& request) {
    const train::runtime::Place place = train::runtime::launcher_place();
    const auto folds = train::run::share_of(folds_of(fold, request.experiment),
                                            fold == "all" ? place : train::runtime::Place{});
    if (folds.empty()) return 0;  // more processes than folds
    const int threads = options.threads > 0 ? options.threads : train::runtime::default_threads();
    const int wanted = processes > 0 ? processes : place.size > 1 ? 1 : threads;
    const int count = std::min(wanted, static_cast<int>(folds.size()));
    const train::data::ShardStream stream = options.open(request);  // read once; the processes share it
    return train::run::run_processes(count, [&](train::runtime::Place mine) {
      const auto own = train::run::share_of(folds, mine);
      const int each = std::max(1, threads / count);
      return judged.empty() ? train_folds(stream, request, own, each)
                            : train_nested(stream, request, own, judged, each);
    });
  });
}

}  // namespace swingbank::jobs::cross_validate_command
