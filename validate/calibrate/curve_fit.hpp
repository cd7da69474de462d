#pragma once
// Baseline: plain least squares of P and Q from the model's own values, as parameter derivation tools do it
// (EPRI's PPPD, MATLAB's lsqnonlin). It shares only the model, its instruments, the preparation and
// scores of events, and the playback with `calibrate`. Detected switching times lie half-way between samples,
// and every event starts at its pre-event mean. All samples have equal weight. There are bounds but no
// priors, and there is one start.
#include <functional>
#include <string>
#include <vector>

#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {

/// Effort and data of a curve fit.
struct CurveFitOptions {
  std::vector<std::string> held_out;   ///< record names (or their numbers, from 1) left out of the fit
  std::vector<std::string> fixed;      ///< names of fixed parameters, e.g. "GENROU.Xl"
  event::FitEventOptions events = {};  ///< measured_states is ignored: only P and Q are fitted
  int iterations = 200;                ///< maximum number of iterations
  double adequate = thresholds::adequacy.reduced_chi2;  ///< see CalibrateOptions::adequate
};

/// Result of an unweighted least-squares fit of P and Q.
struct CurveFit {
  plant::PlantModel model;  ///< with the fitted values
  /// Fitted parameters. Their intervals come from \f$ s^2 (J^T J)^{-1} \f$ with \f$ s^2 = RSS / (values -
  /// parameters) \f$, as parameter derivation tools report them. They are infinite where \f$ J^T J \f$ is
  /// singular.
  std::vector<fit::FittedParameter> parameters;
  std::vector<EventScore> events;  ///< switching times and initial states are not fitted
  double rms_before = 0,
         rms_after = 0;          ///< RMS error of P and Q in the fitted events [pu on the record's base]
  double before = 0, after = 0;  ///< reduced chi-square of the fitted events before and after the fit
  double limit = 0;              ///< largest limit of the reduced chi-square of these events
  int iterations = 0;            ///< number of iterations
  bool converged = false, adequate = false;  ///< adequate: whether every event is within its limit
  std::string sentence;                      ///< result in words
  double seconds = 0;                        ///< elapsed time [s]
};

/// Fits the records that are not held out. Throws InputError in the same cases as calibrate().
CurveFit curve_fit(const plant::PlantModel& model, std::vector<record::Record> records,
                   const CurveFitOptions& options);

}  // namespace swingbank::validate::calibrate
