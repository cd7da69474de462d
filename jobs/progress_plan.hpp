#pragma once
// Progress text of long commands: phase, share done and time left. The share of each phase in the total time
// was measured on examples. Other plants differ; the text therefore says "about 20 s left".
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.hpp"
#include "validate/event/progress.hpp"

namespace swingbank::jobs {

using validate::event::Phase, validate::event::phase_words;

/// Time interval of one phase of a command.
struct PlannedPhase {
  Phase phase;
  double from, to;      ///< share of the total time at the phase's begin and end
  bool beyond = false;  ///< optional phase after an unsuccessful search; the time left is not estimated
};
/// Sequence of a command's phases.
using ProgressPlan = std::vector<PlannedPhase>;

/// Phases of `diagnose`, measured on two shared cores with the four events of configs/records/record-example
/// (28 s, including 6 s of optional phases).
inline const ProgressPlan kDiagnosePlan = {
    {Phase::base, 0, 0.01},
    {Phase::every_parameter, 0.01, 0.015},
    {Phase::parameter_subsets, 0.01, 0.015},
    {Phase::subsets_less_one, 0.01, 0.015},
    {Phase::missing_input, 0.015, 0.02},
    {Phase::quick_fits, 0.02, 0.3},
    {Phase::screening, 0.3, 0.42},
    {Phase::full_fits, 0.42, 0.84},
    {Phase::noise_again, 0.84, 0.89},
    {Phase::unseen_events, 0.89, 0.97},
    {Phase::user_models, 0.89, 0.97},
    {Phase::second_screening, 0.95, 0.97, true},
    {Phase::second_quick_fits, 0.95, 0.97, true},
    {Phase::second_full_fits, 0.95, 0.97, true},
    {Phase::pair_exchanges, 0.95, 0.97, true},
    {Phase::pair_crossings, 0.95, 0.97, true},
    {Phase::pair_unseen_events, 0.95, 0.97, true},
    {Phase::playing, 0.97, 1},
};
/// Phases of `calibrate`, measured with two of the four events above (5 s each).
inline const ProgressPlan kCalibratePlan = {
    {Phase::model_as_it_is, 0, 0.15},  {Phase::parameter_sets, 0.15, 0.2}, {Phase::starts, 0.2, 0.62},
    {Phase::voltage_noise, 0.62, 0.8}, {Phase::fitted_model, 0.8, 0.82},   {Phase::sensitivities, 0.82, 0.95},
    {Phase::playing, 0.95, 1},
};
/// Phases of `add`, measured with the same four events (4 s).
inline const ProgressPlan kAddPlan = {
    {Phase::model_as_it_is, 0, 0.06},    {Phase::missing_input, 0.06, 0.23},
    {Phase::quick_fits, 0.23, 0.26},     {Phase::screening, 0.23, 0.26},
    {Phase::full_fits, 0.26, 0.32},      {Phase::noise_again, 0.32, 0.42},
    {Phase::effect_left_out, 0.42, 0.5}, {Phase::effect_added, 0.5, 0.52},
    {Phase::sensitivities, 0.52, 0.8},   {Phase::playing, 0.8, 1},
};
/// Phases of `calibrate --sparse`, measured with twelve events of a unit with four controls behind its
/// transformer (480 s).
inline const ProgressPlan kSparsePlan = {
    {Phase::every_parameter, 0, 0.12},
    {Phase::parameter_subsets, 0.12, 0.75},
    {Phase::subsets_less_one, 0.75, 0.98},
    {Phase::playing, 0.98, 1},
};

/// Progress of a command through its phases. The printed share never decreases, and the estimated total time
/// never increases.
class PlannedProgress {
 public:
  explicit PlannedProgress(ProgressPlan plan) : plan_(std::move(plan)) {}
  /// Returns the text "37 % done, about 1 min 20 s left: quick fits (SEXS, 16 of 26)". `seconds`: time since
  /// the start [s]. Omits share and time for a phase that the plan does not contain. Adds "round 2" if a
  /// phase begins again.
  std::string line(Phase phase, const std::string& item, int done, int total, double seconds) {
    const int round = round_of(phase, done);
    const std::string what =
        fmt::format("{} ({}{} of {}{})", phase_words(phase), item.empty() ? "" : item + ", ", done, total,
                    round > 1 && phase != Phase::playing ? fmt::format(", round {}", round) : "");
    const auto planned = std::ranges::find(plan_, phase, &PlannedPhase::phase);
    if (planned == plan_.end()) return what;
    const double part = total > 0 ? static_cast<double>(done) / total : 0;
    share_ = std::max(share_, planned->from + (planned->to - planned->from) * part);
    beyond_ = beyond_ || planned->beyond;
    const std::string share =
        beyond_ ? std::string("optional search phase") : fmt::format("{:.0f} % done", 100 * share_);
    return share + time_left(seconds) + ": " + what;
  }

 private:
  struct Seen {
    int done = 0, rounds = 1;
  };
  /// Returns how often the phase has begun. A new round begins if `done` restarts.
  int round_of(Phase phase, int done) {
    const auto [seen, first] = seen_.try_emplace(phase);
    if (!first && done <= seen->second.done && done <= 1 && seen->second.done > 1) ++seen->second.rounds;
    seen->second.done = done;
    return seen->second.rounds;
  }
  /// Returns ", about 1 min 20 s left". Empty if the estimated total time exceeds the shortest earlier
  /// estimate by more than the factor kMayGrow, because such an estimate is unreliable.
  std::string time_left(double seconds) {
    if (beyond_ || share_ < kLeastDone || share_ >= 1) return "";
    const double end = seconds / share_;
    if (end > end_ * kMayGrow) return "";
    end_ = std::min(end_, end);
    const double left = std::max(end_ - seconds, 0.0);
    return left > 0 ? fmt::format(", about {} left", duration_text(left)) : "";
  }

  static constexpr double kLeastDone = 0.02;  ///< smallest share done for an estimate
  static constexpr double kMayGrow = 1.2;     ///< largest ratio of an estimate to the shortest earlier one
  ProgressPlan plan_;
  std::map<Phase, Seen> seen_;
  double share_ = 0;
  double end_ = std::numeric_limits<double>::infinity();  ///< shortest estimate of the total time [s]
  bool beyond_ = false;
};

}  // namespace swingbank::jobs
