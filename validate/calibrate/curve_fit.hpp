#pragma once
// The usual way, as a baseline: curves of P and Q fitted by least squares from the model's own values, as
// parameter derivation tools do it (EPRI's PPPD, MATLAB's lsqnonlin). The model is the file's, with its
// instruments, and is played as in `calibrate`; nothing else is shared. Switching instants stand half-way
// between samples, every event starts where the pre-event mean says, samples weigh alike, nothing is believed
// of a parameter but its bounds, and there is one start.
#include <functional>
#include <string>
#include <vector>

#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {

struct CurveFitOptions {
  std::vector<std::string> held_out;   ///< record names (or their numbers, from 1) left out of the fit
  std::vector<std::string> fixed;      ///< "GENROU.Xl": stays as it is
  event::FitEventOptions events = {};  ///< measured_states is not used: P and Q are fitted
  int iterations = 200;
  double adequate = thresholds::adequacy.misfit;  ///< as CalibrateOptions::adequate
};

struct CurveFit {
  plant::PlantModel model;  ///< with the fitted values
  /// Interval: s^2 (J'J)^-1 with s^2 = RSS / (values - parameters), as such tools state it; infinite where
  /// J'J is singular.
  std::vector<fit::FittedParameter> parameters;
  std::vector<EventScore> events;        ///< as the baseline sees them: without a state of their own
  double rms_before = 0, rms_after = 0;  ///< of P and Q over the events seen [pu on the record's base]
  double before = 0, after = 0,
         limit = 0;  ///< chi2 per value over the events seen; largest limit of an event
  int iterations = 0;
  bool converged = false, adequate = false;  ///< adequate: every event within its limit
  std::string sentence;
  double seconds = 0;
};

/// Throws InputError as calibrate does.
CurveFit curve_fit(const plant::PlantModel& model, std::vector<record::Record> records,
                   const CurveFitOptions& options);

}  // namespace swingbank::validate::calibrate
