#pragma once
// Comparison of several estimates of a plant's parameters: values, intervals, known true values, and the
// reduced chi-square of every event.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/calibrate/curve_fit.hpp"
#include "validate/calibrate/network.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::calibrate {

/// True values by name ("GENROU.H"); empty: unknown.
using Truth = std::map<std::string, double>;
/// Reads true values from a plant file (.toml) or a truth file of `blind-test` (.json). Throws InputError if
/// the file is neither of them, or has another MVA base than the model.
Truth read_truth(const std::filesystem::path& file, const plant::PlantModel& model);

/// Estimate by one method, with the reduced chi-square of every event. Switching times and initial state of
/// each event are fitted for each method, so that methods differ in parameters only. The separate report of
/// the curve fit does not fit them.
struct Way {
  std::string name;  ///< name of the method
  /// Estimate of one parameter.
  struct Value {
    std::string parameter, unit;          ///< "GENROU.H", "s"
    double value = 0, low = 0, high = 0;  ///< estimate and 95 % interval [unit]
  };
  std::vector<Value> values;       ///< estimates of all parameters
  std::vector<EventScore> events;  ///< scores of all events; `after`: with `values`
};
/// The model's own values, without intervals.
Way way_of_model(const Calibration& c);
/// The calibrated values with their 95 % intervals.
Way way_of(const Calibration& c);
/// The curve fit's parameters, evaluated on the calibration's events.
Way way_of(const CurveFit& f, const Calibration& c);
/// The network's estimates of the parameters that varied in training, with intervals of ±1.96 times the RMS
/// error on validation records. `plant` is the plant with these estimates (estimated_plant()). The reduced
/// chi-square of an event is infinite if the simulation of that plant fails.
Way way_of(const NetworkEstimate& estimate, const sim::plant::Plant& plant, const Calibration& c);

/// Error of an estimate over the parameters whose true value is known.
struct Distance {
  int parameters = 0;  ///< number of parameters compared
  int intervals = 0,
      covering = 0;     ///< parameters with a finite 95 % interval; intervals that contain the truth
  double relative = 0;  ///< RMS of (value - truth) / |truth|
  double mse = 0;       ///< mean of (value - truth)^2, each in the parameter's own unit
};
/// Returns the errors of a method against the true values.
Distance distance(const Way& way, const Truth& truth);

/// Table of parameters: one column for each method.
report::Table parameters_beside(const std::vector<Way>& ways, const Truth& truth);
/// Table of events: reduced chi-square by each method.
report::Table events_beside(const std::vector<Way>& ways);
/// Both tables and, if the truth is known, each method's error.
std::string beside_report(const std::vector<Way>& ways, const Truth& truth);
/// Both tables and the errors as JSON.
nlohmann::json beside_json(const std::vector<Way>& ways, const Truth& truth);

/// Report of a curve fit alone.
std::string terminal_report(const CurveFit& f, const Truth& truth);
/// Report of a curve fit as JSON.
nlohmann::json curve_fit_json(const CurveFit& f, const Truth& truth);
/// Origin of the values, for the head comment of the plant file.
std::vector<std::string> provenance_lines(const CurveFit& f, const plant::PlantModel& from,
                                          const std::string& command_line);

}  // namespace swingbank::validate::calibrate
