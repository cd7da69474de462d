#pragma once
// Bayesian least-squares fit of a plant to several events. The plant's free parameters are common to all
// events. Each event has its own switching times and its own initial state. The optimiser is
// Levenberg-Marquardt (Ceres) with the sensitivities of the playback model.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/parameter_id.hpp"
#include "validate/event/play.hpp"
#include "validate/noise/event_fit.hpp"
#include "validate/noise/noise_transfer.hpp"

namespace swingbank::validate::fit {

using event::EventState, event::InputKind;
using noise::EventFit;

/// A parameter that a fit may change. `prior_sd` is its prior standard deviation relative to its value; 0: no
/// prior. If the value is 0, `prior_sd` is relative to 5 % of the parameter's range, at most 1. The fit moves
/// the logarithm if moves_by_logarithm(), otherwise the value.
struct FreeParameter {
  sim::plant::ParameterId id;  ///< parameter of the plant
  double prior_sd = 0.3;       ///< relative, see above
};

/// Returns the parameters of a block that a fit may change. Excludes codes (modes, bus numbers), parameters
/// at zero or at their null value, and parameters that set a switching time of the effect.
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, int block, double prior_sd);
/// Returns these parameters of all blocks except the instruments.
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, double prior_sd);

/// Returns the present values of the free parameters.
std::vector<double> values_of(const sim::plant::Plant& plant, const std::vector<FreeParameter>& free);
/// Returns the plant with these values of the free parameters; without `values`, the plant as it is.
sim::plant::Plant with_values(sim::plant::Plant plant, const std::vector<FreeParameter>& free,
                              const std::vector<double>& values);

/// A fitted parameter with standard error and 95 % interval.
struct FittedParameter {
  FreeParameter where;            ///< the parameter, with its prior
  std::string block, name, unit;  ///< names of block and parameter; unit
  double start = 0, value = 0;    ///< value before and after the fit [unit]
  double error = 0;          ///< standard error from the curvature [unit]; NaN if singular or not computed
  double low = 0, high = 0;  ///< bounds of the 95 % interval [unit], within physical limits
  /// Whether the value is at the end of its range or at an ordering constraint (X''d > Xl). The 95 % interval
  /// is then not valid.
  bool at_bound = false;
  std::string active_constraint = {};  ///< the ordering constraint, for example "X''d > Xl"; empty: none
  /// Returns "block.parameter".
  [[nodiscard]] std::string full_name() const { return sim::plant::ParameterName{block, name}.text(); }
  /// One minus the ratio of posterior to prior variance, 0 to 1. At 0, the prior alone determines the value.
  /// At 1, the records alone determine the value, or it has no prior.
  double decided = 0;
};

/// Result of a fit to several events.
struct Fit {
  sim::plant::Plant plant;                  ///< with the fitted values
  std::vector<FittedParameter> parameters;  ///< free parameters, in the order of the request
  std::vector<EventFit> events;             ///< fits of the events, in their order
  noise::NoiseModel noise;                  ///< noise model in which chi2 is computed
  double chi2 = 0, prior_cost = 0;          ///< chi2 of the data; chi2 of the priors
  int values = 0,
      fitted = 0;  ///< number of compared values; number of variables, including fixed event states
  /// Log determinant of the posterior precision in units of the priors' precision (Occam factor). A parameter
  /// that the records do not determine contributes 0. NaN if the fit computed no standard errors.
  double occam = 0;
  /// Reduction of chi2 that results only from a lower transfer of the voltage noise than in the reference
  /// structure. Such a reduction is no evidence, so data_cost() and criterion() add it back. The value is 0
  /// before correct_noise_transfer().
  double transfer_deficit = 0;
  int iterations = 0;      ///< number of successful steps; at least one is counted for each search
  bool converged = false;  ///< whether the search ended at a minimum
  std::string failed;      ///< reason why the start could not be evaluated; empty: it was evaluated
  /// Returns the reduced chi-square of all events: chi2 divided by the number of compared values [-].
  [[nodiscard]] double reduced_chi2() const { return chi2 / values; }
};

/// Returns for example "GENROU.Xdpp (limited by X''d > Xl), GENROU.H: at a bound; the 95 % interval is not
/// valid."; empty if no parameter is at a bound.
std::string bounds_text(const std::vector<FittedParameter>& parameters);

/// Returns chi2 of data and priors; infinite if the fit failed. fit() minimises this cost once the reduced
/// chi-square is near 1.
double penalised(const Fit& f);
/// Returns -2 log evidence of the structure by Laplace's approximation (MacKay, Neural Computation 4, 1992,
/// p. 415), up to a constant common to all structures:
///
/// \f[ \chi^2 + \sum_i (z_i / \sigma_i)^2 + \ln\det(\Sigma H) \f]
///
/// H: half the Hessian of the cost; \f$ \Sigma = \mathrm{diag}(\sigma_i^2) \f$: prior covariance.
/// Fit::transfer_deficit is added back. Requires a fit with standard errors.
double criterion(const Fit& f);
/// Returns chi2 of the data alone, with Fit::transfer_deficit added back; infinite if the fit failed.
double data_cost(const Fit& f);

/// Sets Fit::transfer_deficit of `fit`, a fit of another structure than the reference of `noise_transfer`.
/// The deficit is at least 0, so a higher noise transfer earns no credit. Every competing explanation must be
/// corrected, including the refit with an unknown input. Does nothing if `noise_transfer` is null or the fit
/// failed.
void correct_noise_transfer(const noise::NoiseTransfer* noise_transfer, const sim::Conventions& conventions,
                            Fit& fit);

/// Returns the reduction of `cost` between two fits; negative if the cost rises. Throws std::logic_error if
/// the fits have different noise models, because their costs then have different units. A failed fit has
/// infinite cost in any unit.
double gain(const Fit& from, const Fit& to, double (*cost)(const Fit&) = penalised);
/// Returns the reduction of chi2 of one event between two fits.
double gain(const EventFit& from, const EventFit& to);
/// Returns whether fit `a` has the lower penalised cost.
bool better(const Fit& a, const Fit& b);
constexpr double kFitTolerance = event::Playing{}.tolerance;  ///< tolerance of the integration

/// Target of a fit: a penalised cost of at most `cost` within `steps` steps. The steps may include those of
/// later fits that continue this one.
struct Goal {
  double cost = std::numeric_limits<double>::infinity();  ///< chi2 with the penalty of the priors
  int steps = 0;                                          ///< maximum number of steps
};

/// Effort, tolerances and start of a fit.
struct FitOptions {
  int iterations = 60;               ///< maximum number of successful steps
  double tolerance = kFitTolerance;  ///< tolerance of the integration (event::Playing)
  /// The search allows larger integration errors in states that hardly affect the compared channels
  /// (event::Playing). Secant updates (Broyden) correct the sensitivities during the search. The final cost
  /// is computed without these larger errors, the standard errors with them. A fit that cannot be evaluated
  /// at the start is repeated with this option.
  bool lenient = false;
  /// The fit is compared only with other brief fits. The final cost of a lenient fit is then computed with
  /// the larger integration errors too.
  bool brief = false;
  bool steady_start = false;  ///< whether every event starts in its pre-event steady state
  /// Start values of the event states. Empty: those of the FitEvent; if a response diverges from its record,
  /// its switching times are first fitted to the early part of the record.
  std::vector<EventState> start = {};
  std::vector<double> values = {};  ///< start values of the free parameters; empty: the plant's
  bool errors = true;  ///< whether to compute standard errors: one further evaluation of all sensitivities
  /// The fit ends early if it cannot reach this goal. The prediction assumes that every remaining step
  /// reduces the cost by the larger relative reduction of the last two steps.
  Goal goal = {};
};

/// Returns options for a fit that continues from the end of `f`. The priors stay centred on the plant that is
/// passed to fit().
FitOptions continued(FitOptions o, const Fit& f, const std::vector<FreeParameter>& free);

/// Fits the `free` parameters of the plant and every event's own state. If the start cannot be evaluated, the
/// result has `failed` set. Later steps to points that cannot be evaluated are refused.
///
/// With a wrong structure the residuals would outweigh the priors, and parameters would be biased to
/// compensate for the missing effect. The priors' cost is therefore multiplied by the reduced chi-square
/// reached so far, as if the noise variance were larger by this factor. The factor falls as the fit improves.
Fit fit(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
        const std::vector<FreeParameter>& free, const FitOptions& options = {});

}  // namespace swingbank::validate::fit
