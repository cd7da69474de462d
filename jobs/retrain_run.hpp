#pragma once
// Programs that `swingbank add --retrain` starts: generation, training and evaluation of its two networks.
// Generation and training resume an interrupted run.
#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "base/own_command.hpp"
#include "validate/retrain/retrain.hpp"

namespace swingbank::jobs {

constexpr int kStopped = 2;  ///< exit code of generate and train after a signal: run again to continue

/// Paths of the programs.
struct RetrainPrograms {
  std::filesystem::path generate, train, predict;
};

/// Returns the paths of the programs. Throws InputError if this build cannot train.
inline RetrainPrograms retrain_programs() {
  const std::string remedy = "install swingbank-train, or add without --retrain";
  return {own_command("generate", remedy), own_command("train", remedy), own_command("predict", remedy)};
}

/// Generates the dataset of one side (with or without the effect) and trains the side's network. Returns
/// false if a signal stopped one of these steps. Throws InputError if a step fails.
inline bool make_network(const RetrainPrograms& programs, const validate::retrain::RetrainSide& side) {
  const auto step = [&](const std::filesystem::path& program, const std::vector<std::string>& words) {
    const int code = run_own(program, words);
    if (code != 0 && code != kStopped)
      throw InputError({fmt::format("cannot train the network {} the effect", side.name),
                        side.folder.string(), program.filename().string() + " printed the reason above",
                        "correct that; if settings changed since an earlier run, remove the folder"});
    return code == 0;
  };
  return step(programs.generate, {side.dataset.string(), "--out", side.data.string()}) &&
         step(programs.train, {side.data.string(), "--experiment", side.experiment.string(), "--preset",
                               "retrain", "--out", side.results.string()});
}

/// Returns the parameter estimate of one side's network from the records. `reading`: options that state
/// columns, time range and measuring point. Throws InputError if `predict` fails.
inline validate::calibrate::NetworkEstimate ask_network(const RetrainPrograms& programs,
                                                        const validate::retrain::RetrainSide& side,
                                                        const std::string& model,
                                                        const std::vector<std::string>& records,
                                                        const std::vector<std::string>& reading) {
  const auto file = side.folder / "estimates.json";
  std::vector<std::string> words = {"--network", side.results.string(), "--model",  model,
                                    "--out",     file.string(),         "--records"};
  words.insert(words.end(), records.begin(), records.end());
  words.insert(words.end(), reading.begin(), reading.end());
  if (run_own(programs.predict, words) != 0)
    throw InputError({fmt::format("no estimate by the network {} the effect", side.name),
                      side.results.string(), "see the message of swingbank predict above",
                      "correct that and run the command again"});
  return validate::calibrate::read_estimate(file);
}

}  // namespace swingbank::jobs
