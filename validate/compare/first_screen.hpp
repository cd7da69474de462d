#pragma once
// First screen of a report, and its parts for the live page: the verdict in a few words, and the error of
// each channel.
#include <string>
#include <utility>
#include <vector>

#include "validate/compare/event_use.hpp"
#include "validate/compare/played.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::compare {

/// Content of the residual of a model that is statistically complete.
enum class Remainder {
  noise,        ///< noise alone
  uncertainty,  ///< noise and, in a held-out event, the uncertainty of the fitted parameters
  playback,     ///< more than noise in the playback shown, although the fit is statistically complete
};
/// Returns the clause for a headline: ": only noise remains".
std::string remainder_text(Remainder remainder);
/// Returns the verdict in at most eight words; `model`: for example "Calibrated model".
std::string headline(bool complete, const Fitness& fitness, const std::string& model = "Model",
                     Remainder remainder = Remainder::noise);

/// Error of one channel of one event against its bounds and limits.
struct ChannelError {
  double bound = 0;   ///< largest normalised RMS / bound of all bins; above 1: more than noise
  int window = -1;    ///< window of the largest ratio; -1: no bins
  double limit = 0;   ///< largest ratio of an error to its engineering limit
  report::Tone tone;  ///< good: noise; warn: more than noise; bad: exceeds a limit
};
/// Returns the error of a channel, judged by the limits of `fitness`.
ChannelError channel_error(const Fitness& fitness, const EventComparison& event, const ChannelComparison& c);

/// Returns the judged channels above their noise bounds: "Q of event3.csv".
std::vector<std::string> beyond_noise(const Played& played);
/// Returns the content of the residual of a complete model. `noise_alone`: every event is within the limit of
/// noise alone.
Remainder remainder_of(const Played& played, bool noise_alone);

/// Content of a report's first screen.
struct FirstScreen {
  std::string headline;                   ///< at most eight words
  std::vector<std::string> reasons;       ///< one line each
  report::Tone tone = report::Tone::bad;  ///< colour of the headline
  const Played* before = nullptr;         ///< shown model; with `after`: the submitted one
  const Played* after = nullptr;          ///< changed model; null: none
  bool judge_before = false;              ///< chips are coloured by the errors of `before`; false: of `after`
  EventUse use = {};                      ///< events of the fit and of its verification
  std::string next = {};                  ///< next command; empty: none
};
/// Adds the headline, a chip for each channel of each event (RMS error, coloured by its limits), P and Q of
/// the worst event, and bars of the errors before and after.
void first_screen(report::Document& document, const FirstScreen& screen);

/// Returns the largest RMS / noise of all judged channels and its event; 0 and 0 if none has noise.
std::pair<double, std::size_t> largest_rms_over_noise(const Played& played);
/// Returns the event of largest_rms_over_noise(), and its channels for the large charts: P and Q, or the
/// first two.
std::pair<std::size_t, std::vector<std::string>> worst_event(const Played& played);

/// Returns the chart of one channel: the measured curve, and the simulated curve of each model with its line
/// style (Ink). The chart has no series if no model has the channel.
report::Curves channel_curves(const std::vector<std::pair<const Played*, report::Ink>>& models,
                              std::size_t event, const std::string& channel);
/// Returns the id of the chart of a channel.
std::string chart_id(std::size_t event, const std::string& channel);
/// Returns an empty chart of an event, which shows 1 s before to 5 s after the first switching.
report::Curves event_chart(const EventComparison& e, const std::string& title, const std::string& unit);
/// Returns scale * values + shift, for charts in the unit of a channel.
std::vector<double> scaled(std::vector<double> values, double scale, double shift = 0);

/// Returns the command line of another command with the same inputs: "swingbank add SEXS --model ...".
std::string next_command(const report::Provenance& rows, const std::string& command);

}  // namespace swingbank::validate::compare
