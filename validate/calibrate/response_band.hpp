#pragma once
// 95 % band of the response of a fitted model, from the uncertainty of its parameters and of each event's
// state.
#include <map>
#include <string>
#include <vector>

#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {

/// Half width of a response's 95 % band: [event][name of a fitted channel][sample] [pu].
using ResponseBands = std::vector<std::map<std::string, std::vector<double>>>;

/// Computes the bands of all events at the fitted model. The covariance of the parameters is the inverse of
/// the curvature of the events that are not held out, plus the priors of `free`. If the reduced chi-square of
/// these events exceeds 1, the bands are wider by its square root. Throws InputError if playback of a record
/// fails.
ResponseBands response_bands(const plant::PlantModel& fitted, const std::vector<record::Record>& records,
                             const std::vector<fit::FreeParameter>& free, const CalibrateOptions& options);

}  // namespace swingbank::validate::calibrate
