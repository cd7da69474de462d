// swingbank cross-validate: leave one generator out (Tables V and VI). Several processes started by mpirun or srun
// share the folds; a Slurm array task takes one with --fold.
#include "jobs/training_options.hpp"
#include "train/cross_validate.hpp"

namespace {
using namespace swingbank;

std::vector<std::int32_t> folds_of(const std::string& text, const Experiment& experiment) {
  if (text == "all") return share_of(experiment.folds, launcher_place());
  for (const std::int32_t fold : experiment.folds)
    if (std::to_string(fold) == text) return {fold};
  throw InputError({fmt::format("no fold '{}'", text), "--fold",
                    fmt::format("{} leaves out {}", experiment.file.string(), fmt::join(experiment.folds, ", ")),
                    "give one of these bus numbers, or all"});
}
}  // namespace

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY, "swingbank cross-validate"};
  TrainingOptions options;
  std::string fold = "all";
  app.add_option("--fold", fold, "bus number of the generator to leave out, or all")->capture_default_str();
  return training_main(argc, argv, "swingbank cross-validate", app, options, [&](const RunRequest& request) {
    if (!request.experiment.leave_one_out)
      throw InputError({"this experiment leaves no generator out", options.experiment, "its split says so",
                        "use swingbank train"});
    const auto folds = folds_of(fold, request.experiment);
    if (folds.empty()) return RunOutcome::already_done;  // more processes than folds
    const ShardStream stream = options.open(request);
    const RunOutcome outcome = cross_validate(stream, request, folds);
    if (outcome == RunOutcome::already_done) fmt::print(stderr, "folds {}: done already\n", fmt::join(folds, ", "));
    return outcome;
  });
}
