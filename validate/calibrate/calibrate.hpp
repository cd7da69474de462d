#pragma once
// Multistart calibration of a plant model's parameters on several events. Also computes standard errors and
// intervals, lists parameters that the records do not identify, and judges the structure on fitted and
// held-out events.
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/fit.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::calibrate {

/// Additional start of the search, with its name in reports.
struct GivenStart {
  std::string name;         ///< name in reports
  sim::plant::Plant plant;  ///< plant with the start values
};

/// Effort, priors and data of a calibration.
struct CalibrateOptions {
  double prior_sd = thresholds::parameters.prior_sd;  ///< relative prior standard deviation of the parameters
  int draws = 24;  ///< number of random parameter sets; not used if the fit from the closed form is adequate
  int starts = 2;  ///< number of the best draws that are refined
  std::uint64_t seed = 1;             ///< seed of the random draws
  std::vector<std::string> held_out;  ///< record names (or their numbers, from 1) left out of the fit
  std::vector<std::string> fixed;     ///< names of fixed parameters, e.g. "GENROU.Xl"
  std::vector<GivenStart> given;      ///< starts in addition to the model's own values and the draws
  bool only_given =
      false;  ///< if true: no start at the model's own values or closed form; no simulation of further events
  std::vector<fit::FreeParameter> free = {};  ///< free parameters with priors; empty: chosen_parameters()
  /// Lower bound of the limit of the reduced chi-square. It allows for interpolation errors of the played-in
  /// voltage.
  double adequate = thresholds::adequacy.reduced_chi2;
  event::FitEventOptions events = {};  ///< preparation of the records
  event::Progress progress = {};       ///< recipient of progress messages; empty: none
};

/// Errors of one channel of one event in the fit, with the event's own switching times and initial state
/// fitted. Commands show the errors of compare::error_table() instead.
struct ChannelScore {
  playin::Output channel;                ///< output that is compared
  std::string unit;                      ///< unit of the errors
  double scale = 1;                      ///< value of 1 pu of the record's base [unit]
  double rms_before = 0, rms_after = 0;  ///< RMS of model - measured [unit]
  double over_noise = 0;                 ///< rms_after / standard deviation of the noise in the fit
};
/// Reduced chi-square of one event before and after the calibration.
struct EventScore {
  std::string record;            ///< name of the record
  bool seen = true;              ///< whether the fit used it; of a held-out event, only the state was fitted
  double before = 0, after = 0;  ///< reduced chi-square
  double limit = 0;              ///< limit of the reduced chi-square
  /// Part of `limit` beyond the limit of noise alone. It covers the uncertainty of the fitted parameters in a
  /// held-out event, and the chi-square increase of the correction for voltage noise.
  double allowance = 0;
  double colour = 0;                   ///< lag-1 autocorrelation of the pre-event residual
  std::vector<ChannelScore> channels;  ///< errors of each channel
  /// Whether the reduced chi-square after the calibration is within its limit.
  [[nodiscard]] bool adequate() const { return thresholds::within_limit(after, limit); }
  /// Whether the reduced chi-square after the calibration is within the limit of noise alone.
  [[nodiscard]] bool is_noise() const { return thresholds::within_limit(after, limit - allowance); }
};

/// Parameter combination that the records do not identify: a change along it hardly changes the simulated
/// response.
struct UnidentifiedCombination {
  /// Component of the combination along one parameter.
  struct Member {
    int parameter;  ///< index into Calibration::parameters
    double change;  ///< change for one posterior standard deviation along the combination [unit of the
                    ///< parameter]
  };
  std::vector<Member> members;  ///< the largest first
  double decided = 0;           ///< share of the posterior precision that comes from the records
  /// Whether the combination is a single parameter.
  [[nodiscard]] bool alone() const { return members.size() == 1; }
};

/// Simulated event that was not recorded, with the parameter errors that it would give.
struct Candidate {
  std::string what;           ///< description of the event
  std::vector<double> error;  ///< standard error of each parameter with this event added [unit]
};

/// Calibrated parameter with the contributions to its error.
struct CalibratedParameter {
  fit::FittedParameter fit;    ///< error and interval include the widening for coloured residuals
  double curvature_error = 0;  ///< standard error from the curvature alone, for white noise [unit]
  double shift = 0;            ///< correction applied for noise of the played-in voltage [unit]
  int best_candidate =
      -1;  ///< index of the candidate that reduces the error most; -1: none reduces it by a fifth
  double narrowed = 1;  ///< standard error with that candidate / without it
};

/// Verdict of a calibration.
enum class Adequacy {
  adequate,         ///< residuals are within noise before and after the fit
  parameters_poor,  ///< residuals are within noise only after the fit
  structure_poor,   ///< residuals exceed noise after the fit: a model component is missing
};

/// Result of one start of the search.
struct StartScore {
  std::string name;  ///< "closed form", "model", "network", "draw 3"
  double before = 0,
         after = 0;     ///< reduced chi-square of the fitted events; infinite if the simulation fails
  bool agrees = false;  ///< whether it reached the best optimum
};

/// Result of a calibration.
struct Calibration {
  plant::PlantModel model;                            ///< with the fitted values
  Adequacy adequacy = Adequacy::adequate;             ///< verdict
  thresholds::Ruling ruling;                          ///< criterion and figures behind `adequacy`
  std::string sentence;                               ///< verdict in words
  std::vector<CalibratedParameter> parameters;        ///< free parameters
  Eigen::MatrixXd correlation;                        ///< correlation of the estimates [parameter][parameter]
  std::vector<UnidentifiedCombination> unidentified;  ///< parameter combinations that are not identified
  std::vector<Candidate> candidates;                  ///< simulated further events
  std::vector<EventScore> events;                     ///< scores of all events, in the order given
  double before = 0, after = 0, limit = 0;            ///< reduced chi-square of the fitted events; its limit
  std::vector<StartScore> started;                    ///< each refined start, in the order tried
  int agreeing = 0;                                   ///< number of starts that reached the best optimum
  bool converged = false;                             ///< whether the search ended at a minimum
  double voltage_noise = 0;             ///< share of the pre-event variation of V that is instrument noise
  fit::Fit fit;                         ///< fit of the events that are not held out
  std::vector<fit::EventState> states;  ///< state of every event at the fitted parameters
  noise::WhitenedEvents prepared;       ///< every event, in the order given
  double seconds = 0;                   ///< elapsed time [s]
};

/// Calibrates `model` on the records that are not held out. Throws InputError: no events, unknown names in
/// `held_out` or `fixed`, all events held out, records without a pre-event window, or a model without a
/// steady state at its operating point.
Calibration calibrate(const plant::PlantModel& model, std::vector<record::Record> records,
                      const CalibrateOptions& options);

/// Returns the free parameters of the plant and of the instruments whose error can be inverted, without those
/// in `fixed` ("GENROU.Xl" or "Xl"). Throws InputError: unknown names, or no free parameter.
std::vector<fit::FreeParameter> chosen_parameters(const sim::plant::Plant& plant, double prior_sd,
                                                  const std::vector<std::string>& fixed);

/// Returns one flag per record: true if `names` contains its name (with or without extension) or its number,
/// counted from 1. Throws InputError: no record, unknown names, or every record held out.
std::vector<bool> held_out_events(const std::vector<record::Record>& records,
                                  const std::vector<std::string>& names);
/// Returns the records that are not held out. Throws InputError in the same cases as held_out_events().
std::vector<record::Record> seen_records(const std::vector<record::Record>& records,
                                         const std::vector<std::string>& held_out);

/// Returns the number of pre-event samples over all events, minus one per event.
int pre_event_samples(const noise::WhitenedEvents& events);

/// Returns the limit of an event's reduced chi-square that noise alone exceeds with probability 0.001, at
/// least `least`. It allows for the autocorrelation of the pre-event residual (Bartlett) and for a noise
/// level estimated from `pre_event` samples.
double reduced_chi2_limit(const event::FitEvent& event, const fit::EventFit& fitted, int pre_event,
                          double least);

/// Returns a bound on the increase of a held-out event's reduced chi-square due to parameter uncertainty: the
/// mean increase plus 3.09 standard deviations. It is exceeded with probability 0.001 if many parameter
/// combinations are uncertain. The probability is about 0.02 if one combination dominates, because a single
/// squared Gaussian has a longer tail. `information`: Fisher information of the event; `covariance`:
/// covariance of the parameters, in the same units; `values`: number of compared values.
double unseen_allowance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance, int values);

/// Returns the clause on the residual of adequate events: "the residual is noise". If an event exceeds the
/// limit of noise alone, the clause states instead that the residual is within the uncertainty of the
/// parameters.
std::string residual_text(const std::vector<EventScore>& events);

/// Returns the reduced chi-square and channel errors of one event before and after the calibration. Both fits
/// must use the noise of `event`. Throws std::logic_error if their noise models differ from each other.
EventScore score_event(noise::WhitenedEvent event, const fit::EventFit& before, const fit::EventFit& after,
                       bool seen, int pre_event, double least);

}  // namespace swingbank::validate::calibrate
