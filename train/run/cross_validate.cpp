#include "train/run/cross_validate.hpp"

namespace swingbank::train::run {

std::vector<std::int32_t> share_of(const std::vector<std::int32_t>& folds, runtime::Place place) {
  std::vector<std::int32_t> mine;
  for (auto i = static_cast<std::size_t>(place.rank); i < folds.size();
       i += static_cast<std::size_t>(place.size))
    mine.push_back(folds[i]);
  return mine;
}

RunOutcome cross_validate(const data::ShardStream& stream, RunRequest request,
                          const std::vector<std::int32_t>& folds) {
  RunOutcome outcome = RunOutcome::already_done;
  for (const std::int32_t fold : folds) {
    request.generator = fold;
    const RunOutcome one = run(stream, request);
    if (one == RunOutcome::stopped) return one;
    if (one == RunOutcome::done) outcome = one;
  }
  return outcome;
}

}  // namespace swingbank::train::run
