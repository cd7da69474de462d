#pragma once
// Session of the live page: the steps from the submitted model to the completed one, and playback while a
// slider moves. Each step is compared with all records.
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/calibrate/response_band.hpp"
#include "validate/compare/played.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::live {

/// Inputs that all sessions share. They do not change after the start.
struct Setup {
  plant::PlantModel model;                         ///< submitted model
  std::vector<record::Record> records;             ///< one for each event
  std::vector<compare::Measurement> measured;      ///< measurements of `records`, with the options `compare`
  std::vector<std::vector<std::string>> warnings;  ///< notes on each record
  compare::CompareOptions compare;                 ///< options of the comparison
  event::FitEventOptions events;                   ///< preparation of the records for fits
  thresholds::Acceptance by;                       ///< limits of fitness for purpose
  double prior_sd = 0;                             ///< relative prior standard deviation of parameters
  int threads = 0;                                 ///< number of processor cores to use; 0: all
  /// Options of the command line that read these records, for the equivalent command of each step.
  std::string options;
  std::string plant_file;  ///< as given by the user
};

/// Fitted parameter of a step with its 95 % interval.
struct Interval {
  std::string name;          ///< "SEXS.K"
  double low = 0, high = 0;  ///< [unit of the parameter]
};

/// One step of a session. Immutable once it is in the session.
struct Step {
  /// Origin of a step.
  enum class Kind { submitted, manual, added, calibrated };
  Kind kind = Kind::submitted;           ///< origin
  int parent = -1;                       ///< step before it; -1: none
  std::string label;                     ///< "GENROU.H 6.54 → 5.2 s", "+ SEXS"
  std::string command;                   ///< equivalent command line; empty: none
  std::string sentence = {};             ///< result of the fit in words
  plant::PlantModel model;               ///< model of this step
  bool fitted = false;                   ///< this step, or one before it, was fitted to the records
  std::vector<Interval> intervals = {};  ///< intervals of the fitted parameters; empty after a manual change
  calibrate::ResponseBands bands = {};   ///< 95 % bands of the response; empty: not a fitted model
  std::vector<std::string> held_out = {};  ///< names of records that the fit excluded
  double evidence = 0;       ///< 2 ln(Bayes factor) of an added effect over the refit without it
  bool provisional = false;  ///< whether it comes from first_step()
  bool complete = false;     ///< whether the residual is noise in every bin
  std::shared_ptr<const compare::Played> played = {};  ///< comparison with all records
};

/// Returns the step of the submitted model, compared with all records.
Step submitted_step(const Setup& setup);
/// Returns this step with detected instead of fitted switching times, for the first screen. It takes a tenth
/// of the time.
Step first_step(const Setup& setup);

/// Values of parameters by full name ("GENROU.H") [unit of the parameter].
using Values = std::vector<std::pair<std::string, double>>;
/// Returns the parameter of a full name. Throws InputError if there is none.
sim::plant::ParameterId find_parameter(const sim::plant::Plant& plant, const std::string& name);
/// Returns the model with other parameter values. Throws InputError if a name is unknown, or if a value is
/// not finite or not allowed by the equations.
plant::PlantModel with_values(plant::PlantModel model, const Values& values);

/// Steps of one open page. All functions may be called from several threads.
class Session {
 public:
  /// Begins with the submitted model. From `most` steps on, each new step replaces the oldest manual change
  /// that no other step builds on. A step with its comparisons takes about 1 MB.
  Session(std::shared_ptr<const Setup> setup, std::shared_ptr<const Step> submitted, std::size_t most = 24);
  [[nodiscard]] const Setup& setup() const { return *setup_; }  ///< inputs
  /// Returns a step. Throws InputError if there is none of that number.
  [[nodiscard]] std::shared_ptr<const Step> step(int number) const;
  /// Returns the number of steps, including those that were dropped.
  [[nodiscard]] int steps() const;
  /// Returns the numbers of the steps that are kept, in ascending order.
  [[nodiscard]] std::vector<int> kept() const;
  /// Replaces the first step, which was provisional.
  void compared(std::shared_ptr<const Step> submitted);
  /// Changes values of the model of step `from`, compares it with all records, and appends it as a step.
  /// Returns the number of the new step, or `from` if no value changes.
  int change(int from, const Values& values);
  /// Appends the model of a fit, compared with all records. Returns the number of the step.
  int append(Step step);
  /// Stores the result of the diagnosis of a step, in words.
  void diagnosed(int step, std::string result);
  /// Returns the result of the last diagnosis of a step; empty if there was none.
  [[nodiscard]] std::string diagnosis_of(int step) const;

 private:
  int put(std::shared_ptr<const Step> step);

  std::shared_ptr<const Setup> setup_;
  std::size_t most_;
  mutable std::mutex lock_;
  std::vector<std::shared_ptr<const Step>> steps_;
  std::map<int, std::string> diagnoses_;  ///< result of the last diagnosis of each step
};

/// Simulated curves of one event while a slider moves.
struct Preview {
  std::vector<compare::ReplayedChannel> channels;  ///< in the order of the channels of the step's comparison
};
/// Plays one event into a step's model with other values. Switching times and initial state are those of the
/// step.
Preview preview(const Step& step, std::size_t event, const Values& values);

}  // namespace swingbank::validate::live
