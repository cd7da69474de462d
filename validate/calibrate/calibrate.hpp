#pragma once
// Calibration: the free parameters of the present structure fitted to several events at once, from several
// starts; what the records decide and what they cannot; and whether the structure holds after that, on the
// events it was fitted to and on those left out.
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/fit.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::calibrate {

/// A further start of the search, and the name that reports give it.
struct GivenStart {
  std::string name;
  sim::plant::Plant plant;
};

struct CalibrateOptions {
  double spread = thresholds::parameters.spread;  ///< relative uncertainty believed of the parameters
  int draws = 24;  ///< parameter sets tried as starts, unless the machine's closed form is good enough
  int starts = 2;  ///< how many of these are refined beside the model's own values
  std::uint64_t seed = 1;
  std::vector<std::string> held_out;          ///< record names (or their numbers, from 1) left out of the fit
  std::vector<std::string> fixed;             ///< "GENROU.Xl": stays as it is
  std::vector<GivenStart> given;              ///< starts beside the model's own values and those drawn
  bool only_given = false;                    ///< starts from `given` alone, and no further event is tried
  std::vector<fit::FreeParameter> free = {};  ///< with their priors; empty: chosen_parameters()
  double adequate =
      thresholds::adequacy.misfit;  ///< chi2 per value that interpolation and the played-in voltage may leave
  event::FitEventOptions events = {};
  event::Progress progress = {};
};

/// One channel of one event in the fit, which moves the event's own state. The errors that commands show are
/// those of compare::error_table.
struct ChannelScore {
  playin::Output channel;
  std::string unit;
  double scale = 1;                      ///< units in 1 pu of the record's base
  double rms_before = 0, rms_after = 0;  ///< of model - measured [unit]
  double over_noise = 0;                 ///< rms_after over the noise that the fit is weighted by
};
struct EventScore {
  std::string record;
  bool seen = true;              ///< false: left out of the fit; only its own state was fitted
  double before = 0, after = 0;  ///< chi2 per value
  double limit = 0;              ///< limit of chi2 per value; above it, more than noise is left
  double colour = 0;             ///< correlation of neighbouring samples of the pre-event residual
  std::vector<ChannelScore> channels;
  [[nodiscard]] bool adequate() const { return thresholds::within_limit(after, limit); }
};

/// Parameters that move together without the records noticing.
struct Blur {
  struct Member {
    int parameter;  ///< index into Calibration::parameters
    double change;  ///< along the direction [unit of the parameter], for one standard deviation
  };
  std::vector<Member> members;  ///< the largest first
  double decided = 0;           ///< share of this direction that the records decide
  bool alone = false;           ///< one parameter by itself: it leaves no trace in the records
};

/// An event that the records do not hold, tried in simulation.
struct Candidate {
  std::string what;
  std::vector<double> error;  ///< standard error of each parameter with this event added [unit]
};

struct CalibratedParameter {
  fit::FittedParameter fit;    ///< error and interval: widened where the residual is coloured
  double curvature_error = 0;  ///< standard error as the curvature alone says
  double shift = 0;            ///< shift by noise of the played-in voltage, which has been taken back [unit]
  int best_candidate = -1;     ///< index of the event that would narrow the error most; -1: none by a fifth
  double narrowed = 1;         ///< its error with that event / without
};

enum class Adequacy {
  adequate,         ///< before and after: the parameters were as good
  parameters_poor,  ///< only after: the structure holds, the parameters did not
  structure_poor,   ///< what is left survives the refit: something is missing
};

/// One start of the search.
struct StartScore {
  std::string name;              ///< "closed form", "model", "network", "draw 3"
  double before = 0, after = 0;  ///< chi2 per value over the events seen; infinite where it cannot be run
  bool agrees = false;           ///< came to the best optimum
};

struct Calibration {
  plant::PlantModel model;  ///< with the fitted values
  Adequacy adequacy = Adequacy::adequate;
  thresholds::Ruling ruling;  ///< what decided whether the structure holds
  std::string sentence;
  std::vector<CalibratedParameter> parameters;
  Eigen::MatrixXd correlation;
  std::vector<Blur> blurs;
  std::vector<Candidate> candidates;
  std::vector<EventScore> events;
  double before = 0, after = 0, limit = 0;  ///< chi2 per value over the events seen
  int starts = 0, agreeing = 0;             ///< refined starts; how many came to the same optimum
  std::vector<StartScore> started;          ///< each refined start, in the order tried
  bool converged = false;
  double voltage_noise = 0;             ///< share of the pre-event movement of V that is the instrument's
  fit::Fit fit;                         ///< of the events seen
  std::vector<fit::EventState> states;  ///< of every event, at the fitted parameters
  event::WhitenedEvents prepared;       ///< every event, in the order given
  double seconds = 0;
};

/// Throws InputError: no events, unknown names in `held_out` or `fixed`, all events held out, records without
/// a pre-event, a model that cannot hold its operating point.
Calibration calibrate(const plant::PlantModel& model, std::vector<record::Record> records,
                      const CalibrateOptions& options);

/// The plant's free parameters, and the errors of its instruments that can be taken back, without those in
/// `fixed` ("GENROU.Xl" or "Xl"). Throws InputError: unknown names, none left.
std::vector<fit::FreeParameter> chosen_parameters(const sim::plant::Plant& plant, double spread,
                                                  const std::vector<std::string>& fixed);

/// Which of the events are left out: by record name (with or without ending) or number from 1.
std::vector<bool> held_out_events(const std::vector<record::Record>& records,
                                  const std::vector<std::string>& names);

/// Number of samples that the noise was estimated from, less one for each event.
int pre_event_samples(const event::WhitenedEvents& events);

/// Limit of chi2 per value for nothing but noise, which one in a thousand exceeds. It allows for residuals as
/// coloured as the event's pre-event stretch and for a noise that was estimated from `pre_event` samples, and
/// is at least `least`.
double misfit_limit(const event::FitEvent& event, const fit::EventFit& fitted, int pre_event, double least);

/// What uncertain parameters add to the chi2 per value of an event that they were not fitted to: mean
/// and 3.09 standard deviations. One event in a thousand exceeds it where the uncertainty is that of many
/// directions, and two in a hundred where one direction governs, because a single square has a longer tail.
/// `information`: of that event; `covariance` of the parameters in the same units.
double unseen_allowance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance, int values);

/// Misfit of one event before and after, seen or not. Both fits were made with the noise of `event`.
EventScore score_event(event::WhitenedEvent event, const fit::EventFit& before, const fit::EventFit& after,
                       bool seen, int pre_event, double least);

}  // namespace swingbank::validate::calibrate
