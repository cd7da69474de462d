#pragma once
// Least squares over several events at once: the plant's free parameters, common to all, and what belongs to
// one event only (when exactly it was switched, where exactly the plant stood). Levenberg-Marquardt (Ceres)
// on the sensitivities of the driven plant.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/parameter_id.hpp"
#include "validate/event/play.hpp"

namespace swingbank::validate::fit {

using event::EventState, event::InputKind;

/// A parameter that may move. `spread` is how far its value is believed to be off: relative where the
/// parameter is positive by nature (it is then fitted as a logarithm), absolute otherwise; 0: no belief.
struct FreeParameter {
  sim::plant::ParameterId id;
  double spread = 0.3;
};

/// Parameters of a block that a fit may move: no codes, none that sits at its neutral value or at zero, and
/// none that says when something happens.
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, int block, double spread);
/// The same of all blocks but the instruments.
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, double spread);

/// Present values of the free parameters.
std::vector<double> values_of(const sim::plant::Plant& plant, const std::vector<FreeParameter>& free);

struct EventFit {
  EventState state;
  double chi2 = 0;                         ///< sum of squared whitened residuals
  int values = 0;                          ///< how many
  std::vector<std::vector<double>> model;  ///< [channel][sample]
  std::vector<std::vector<double>>
      residual;             ///< model - measured, whitened: [channel][sample]; 0 where not compared
  event::NoiseModel noise;  ///< what chi2 and residual are measured in
  /// chi2 per value: 1 where nothing but noise is left.
  [[nodiscard]] double misfit() const { return chi2 / values; }
};

struct FittedParameter {
  FreeParameter where;
  std::string block, name, unit;
  double start = 0, value = 0;
  double error = 0;          ///< standard error from the curvature [unit]; NaN where the fit is singular
  double low = 0, high = 0;  ///< 95 % interval [unit], within the physical bounds
  /// At the end of its range, or held by an ordering (X''d > Xl): the interval is then not valid.
  bool at_bound = false;
  std::string held_by = {};  ///< that ordering, "X''d > Xl"; empty: none
  [[nodiscard]] std::string full_name() const { return sim::plant::ParameterName{block, name}.text(); }
  /// Share of the interval that the records decide; the belief decides the rest. 0: the records decide
  /// nothing, 1: all.
  double decided = 0;
};

struct Fit {
  sim::plant::Plant plant;  ///< with the fitted values
  std::vector<FittedParameter> parameters;
  std::vector<EventFit> events;
  event::NoiseModel noise;      ///< what chi2 is measured in
  double chi2 = 0, belief = 0;  ///< chi2 of the data, and the cost of the beliefs
  int values = 0, fitted = 0;   ///< numbers compared; free numbers, those of the events included
  /// Log determinant of what records and beliefs know of the parameters, in units of what the beliefs knew. A
  /// parameter that the records do not decide adds nothing. NaN without errors.
  double occam = 0;
  /// Chi2 that is gone only because this structure passes less of the voltage's noise than the one it is held
  /// against: it explains nothing, so data_cost() and criterion() count it back. 0 until count_passed().
  double passes_less = 0;
  int iterations = 0;
  bool converged = false;
  std::string failed;  ///< why the start could not be evaluated; empty if it could
  [[nodiscard]] double misfit() const { return chi2 / values; }
};

/// "GENROU.Xdpp (held by X''d > Xl), GENROU.H: at a bound, where the 95 % interval is not valid."; empty
/// where none is.
std::string bounds_text(const std::vector<FittedParameter>& parameters);

/// The cost that is minimised, where nothing but noise is left; infinite if the fit failed.
double penalised(const Fit& f);
/// -2 log of the structure's evidence by Laplace's approximation (MacKay, Neural Computation 4, 1992, p.
/// 415), up to what all structures share, with what less passed noise took off counted back
/// (Fit::passes_less). Needs a fit with errors.
double criterion(const Fit& f);
/// chi2 of the data alone, counted back in the same way; infinite if the fit failed.
double data_cost(const Fit& f);

/// By how much a cost falls from one fit to another; negative if it rises. Every comparison of two fits goes
/// through here. Throws std::logic_error where they were made with different noise, because their costs are
/// then in different units. A fit that failed costs infinitely much in any unit.
double gain(const Fit& from, const Fit& to, double (*cost)(const Fit&) = penalised);
/// The same for chi2 of one event.
double gain(const EventFit& from, const EventFit& to);
/// Whether the first fit costs less than the second.
bool better(const Fit& a, const Fit& b);
/// Throws std::logic_error where gain() would, for fits that are set beside each other.
void require_same_noise(const EventFit& a, const EventFit& b);

constexpr double kFitTolerance = event::Playing{}.tolerance;  ///< of the integration

/// What a fit has to get to: to cost `cost` (penalised) at most, in as many steps as are left to it and to
/// the fits that go on from it.
struct Goal {
  double cost = std::numeric_limits<double>::infinity();
  int steps = 0;
};

struct FitOptions {
  int iterations = 30;
  double tolerance = kFitTolerance;  ///< of the integration
  /// Steps may miss what the channels do not show, and slopes are linear about each step (event::Playing),
  /// corrected by what steps of the search showed them to be off by. What the fit ends with is measured
  /// without; its errors are not. Where other steps do not get past the start, these are taken in any case.
  bool lenient = false;
  /// It is compared with other brief fits only: a lenient one ends with what its own steps made of the
  /// answer.
  bool brief = false;
  bool start_stands = false;           ///< every event starts in the steady state before it
  double enough = 1e-5;                ///< relative change of the cost at which the fit stops
  std::vector<EventState> start = {};  ///< of the events; empty: as prepared
  std::vector<double> values = {};     ///< of the free parameters, to start from; empty: the plant's
  bool errors = true;                  ///< of the parameters too: one more look at all slopes
  /// It ends early where it is out of reach: where the goal would be missed even if every step that is left
  /// took off as large a share of the cost as the better one of the last two.
  Goal goal = {};
};

/// Options to go on where `f` ended; beliefs stay about the plant that is fitted.
FitOptions continued(FitOptions o, const Fit& f, const std::vector<FreeParameter>& free);

/// Fills in everything but the state: what `answer` leaves of that event.
void compare(const event::WhitenedEvents& events, std::size_t event, const playin::Response& answer,
             EventFit& fit);

/// Fits `free` parameters of the plant and every event's own state. A start that cannot be evaluated gives
/// `failed`; parameters that cannot be are never reached, the search turns back. While the structure is wrong
/// the misfit is large, and beliefs would count for nothing: parameters would be bent out of all reason to
/// mimic what is missing. So beliefs weigh as if the noise were as large as the misfit reached, and give way
/// as it falls.
Fit fit(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
        const std::vector<FreeParameter>& free, const FitOptions& options = {});

}  // namespace swingbank::validate::fit
