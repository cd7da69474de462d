#pragma once
// The programs that make, train and ask the two networks of `swingbank add --retrain`, one after the other.
// Each goes on where it stopped.
#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "base/own_command.hpp"
#include "validate/retrain/retrain.hpp"

namespace swingbank::jobs {

constexpr int kStopped = 2;  ///< exit code of generate and train after a signal: run again to go on

struct RetrainPrograms {
  std::filesystem::path generate, train, predict;
};

/// Throws InputError where this build cannot train.
inline RetrainPrograms retrain_programs() {
  const std::string remedy = "build with LibTorch (-DSWINGBANK_TRAIN=ON), or add without --retrain";
  return {own_command("generate", remedy), own_command("train", remedy), own_command("predict", remedy)};
}

/// Dataset and network of one side. False if a signal stopped it. Throws InputError if a step fails.
inline bool make_network(const RetrainPrograms& programs, const validate::retrain::RetrainSide& side) {
  const auto step = [&](const std::filesystem::path& program, const std::vector<std::string>& words) {
    const int code = run_own(program, words);
    if (code != 0 && code != kStopped)
      throw InputError({fmt::format("the network {} the effect was not made", side.name),
                        side.folder.string(), program.filename().string() + " says why above",
                        "correct that; if settings changed since an earlier run, remove the folder"});
    return code == 0;
  };
  return step(programs.generate, {side.dataset.string(), "--out", side.data.string()}) &&
         step(programs.train, {side.data.string(), "--experiment", side.experiment.string(), "--preset",
                               "retrain", "--out", side.results.string()});
}

/// What the network of one side says of the records.
inline validate::calibrate::NetworkEstimate ask_network(const RetrainPrograms& programs,
                                                        const validate::retrain::RetrainSide& side,
                                                        const std::string& model,
                                                        const std::vector<std::string>& records) {
  const auto file = side.folder / "estimates.json";
  std::vector<std::string> words = {"--network", side.results.string(), "--model",  model,
                                    "--out",     file.string(),         "--records"};
  words.insert(words.end(), records.begin(), records.end());
  if (run_own(programs.predict, words) != 0)
    throw InputError({fmt::format("no estimate by the network {} the effect", side.name),
                      side.results.string(), "swingbank predict says why above",
                      "correct that and run the command again"});
  return validate::calibrate::read_estimate(file);
}

}  // namespace swingbank::jobs
