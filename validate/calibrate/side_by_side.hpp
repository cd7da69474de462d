#pragma once
// Several ways to a plant's parameters set side by side: values, intervals, the truth where it is known, and
// what each leaves of every event.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/calibrate/curve_fit.hpp"
#include "validate/calibrate/network.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::calibrate {

/// True values by "GENROU.H"; empty: not known.
using Truth = std::map<std::string, double>;
/// From a plant file (.toml), or from the truth that `blind-test` sealed (.json). Throws InputError: neither,
/// or on another MVA base than the model.
Truth read_truth(const std::filesystem::path& file, const plant::PlantModel& model);

/// One way: what it says of the parameters and what is left of the events then. Every event is met with its
/// own switching instants and start, so that only the parameters differ.
struct Way {
  std::string name;
  struct Value {
    std::string parameter, unit;  ///< "GENROU.H", "s"
    double value = 0, low = 0, high = 0;
  };
  std::vector<Value> values;
  std::vector<EventScore> events;  ///< `after`: with these values
};
/// The model as it is, without intervals.
Way way_of_model(const Calibration& c);
Way way_of(const Calibration& c);
/// The curve fit's parameters, tried on the events of the calibration.
Way way_of(const CurveFit& f, const Calibration& c);
/// The network's estimates where the plant has them, with its spread for an interval; `plant`: with them
/// (estimated_plant). Where that plant cannot follow an event, what is left of it is infinite.
Way way_of(const NetworkEstimate& estimate, const sim::plant::Plant& plant, const Calibration& c);

/// How far one way is from the truth, over the parameters that both know.
struct Distance {
  int parameters = 0;           ///< compared
  int intervals = 0, held = 0;  ///< of them, with a 95 % interval; of those, that hold the truth
  double relative = 0;          ///< rms of (value - truth) / |truth|
  double mse = 0;               ///< mean of (value - truth)^2, raw units, as the thesis counts
};
Distance distance(const Way& way, const Truth& truth);

report::Table parameters_beside(const std::vector<Way>& ways, const Truth& truth);
report::Table events_beside(const std::vector<Way>& ways);
/// Both tables and, where the truth is known, how far each way is from it.
std::string beside_report(const std::vector<Way>& ways, const Truth& truth);
nlohmann::json beside_json(const std::vector<Way>& ways, const Truth& truth);

/// A curve fit by itself.
std::string terminal_report(const CurveFit& f, const Truth& truth);
nlohmann::json curve_fit_json(const CurveFit& f, const Truth& truth);
std::vector<std::string> provenance_lines(const CurveFit& f, const plant::PlantModel& from,
                                          const std::string& command_line);

}  // namespace swingbank::validate::calibrate
