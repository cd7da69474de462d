#pragma once
// Baseline: plain least squares of P and Q from the model's own values, as parameter derivation tools do it
// (EPRI's PPPD, MATLAB's lsqnonlin). It shares the model, its instruments and the playback with `calibrate`,
// and nothing else. Switching times lie half-way between samples, and every event starts at its pre-event
// mean. All samples have equal weight, there are no priors but bounds, and there is one start.
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
  double adequate = thresholds::adequacy.reduced_chi2;  ///< as CalibrateOptions::adequate
};

/// Result of an unweighted least-squares fit of P and Q, for comparison with such tools.
struct CurveFit {
  plant::PlantModel model;  ///< with the fitted values
  /// Intervals from \f$ s^2 (J^T J)^{-1} \f$ with \f$ s^2 = RSS / (values - parameters) \f$, as such tools
  /// report them; infinite where \f$ J^T J \f$ is singular.
  std::vector<fit::FittedParameter> parameters;
  std::vector<EventScore> events;        ///< with prepared switching times and start, which are not fitted
  double rms_before = 0, rms_after = 0;  ///< of P and Q over the fitted events [pu on the record's base]
  /// Reduced chi-square of the fitted events; largest limit of one of them.
  double before = 0, after = 0, limit = 0;   ///< before and after the fit; limit
  int iterations = 0;                        ///< number of iterations
  bool converged = false, adequate = false;  ///< adequate: every event within its limit
  std::string sentence;                      ///< result in words
  double seconds = 0;                        ///< processing time [s]
};

/// Fits the records that are not held out. Throws InputError as calibrate().
CurveFit curve_fit(const plant::PlantModel& model, std::vector<record::Record> records,
                   const CurveFitOptions& options);

}  // namespace swingbank::validate::calibrate
