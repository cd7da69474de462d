#pragma once
// Addition of effects to a model: joint fit to the seen events, and comparison with the model refitted
// without the effects, also on unseen events.
#include <functional>

#include "validate/calibrate/calibrate.hpp"
#include "validate/hypothesis/hypothesis.hpp"

namespace swingbank::validate::add {

/// Options of an addition.
struct AddOptions {
  calibrate::CalibrateOptions calibrate = {};  ///< priors, held-out events, limits, progress
  /// Called from any thread with each fit that includes the effect and is better than all earlier ones. May
  /// be empty.
  std::function<void(const fit::Fit&)> reached = {};
};

/// Scores of one event: reduced chi-square of the given model, without the effect (refitted) and with it.
struct AddedEvent {
  calibrate::EventScore score;  ///< before: given model; after: with the effect
  double refitted = 0;          ///< reduced chi-square without the effect, everything else refitted
  /// Whether the event's reduced chi-square is lower with the effect.
  [[nodiscard]] bool improves() const { return score.after < refitted; }
};

/// One of the effects that are added together.
struct AddedEffect {
  std::string name;     ///< "SEXS"
  std::string what;     ///< "exciter SEXS (simplified excitation system)"
  double evidence = 0;  ///< 2 ln(Bayes factor) over the refitted model with only the other effects
};

/// Result of an addition.
struct Addition {
  hypothesis::Hypothesis hypothesis;  ///< the added effects with their free parameters
  std::vector<AddedEffect> effects;   ///< sorted by name
  plant::PlantModel model;            ///< model with the effects and the fitted values
  /// All free parameters, those of the effects first. They have the corrections of calibrate() if the
  /// residual is noise.
  std::vector<fit::FittedParameter> parameters;
  int own = 0;                     ///< number of parameters of the effects
  std::vector<AddedEvent> events;  ///< scores of all events, in the order given
  /// criterion() of the fit without the effects minus that of the fit with all effects, over the seen events.
  double evidence = 0;
  /// Whether the evidence of each effect exceeds thresholds::addition.strong and no unseen event is worse
  /// with them, unless it is within its limit.
  bool earns = false;
  bool adequate = false;           ///< whether the residual is noise in every event
  thresholds::Ruling ruling;       ///< the criterion that decided `adequate`
  std::string sentence;            ///< result in words
  noise::WhitenedEvents prepared;  ///< the events with their noise model
  fit::Fit without, with;          ///< fits to the seen events without and with the effect
  double seconds = 0;              ///< processing time [s]
  /// Returns the names of the effects: "FREQLAG + SEXS".
  [[nodiscard]] std::string name() const;
  /// Returns the scores of `events`.
  [[nodiscard]] std::vector<calibrate::EventScore> scores() const;
};

/// Returns the hypothesis of that name, ignoring case and blanks. Throws InputError with the effects that can
/// be added to this plant. The message states the reason: the slot is occupied, the effect acts at given
/// times of one event only, or the records cannot show the effect.
hypothesis::Hypothesis find_hypothesis(const plant::PlantModel& model, const std::string& name,
                                       const std::vector<record::Record>& records);

/// Returns the names in texts of one or several names: "SEXS", "FREQLAG + SEXS".
std::vector<std::string> effect_names(const std::vector<std::string>& texts);

/// Adds the effects of these names together and scores them. A text may hold several names: "FREQLAG + SEXS".
/// The order of the names has no influence on the result. Throws InputError with every name that cannot be
/// added, and in the same cases as calibrate().
Addition add_effects(const plant::PlantModel& model, const std::vector<std::string>& names,
                     const std::vector<record::Record>& records, const AddOptions& options);

/// Result of the removal of one control: the control's evidence with everything else refitted, and the model
/// without the control.
struct Removal {
  std::string effect;       ///< name of the removed effect
  plant::PlantModel model;  ///< model without it, refitted
  /// criterion() of the fit without the effect minus that of the fit with it. The effect is removed if this
  /// is at most addition.stays.
  double evidence = 0;
};
/// Refits the model without one control; `control`: index into Plant::controls.
Removal try_without(const plant::PlantModel& model, std::size_t control, std::vector<record::Record> records,
                    const AddOptions& options);

/// Sequence of additions and removals until the model was adequate or no effect helped.
struct Completion {
  std::vector<Addition> added;   ///< in order of addition
  std::vector<Removal> removed;  ///< effects of `added` that were removed later
  plant::PlantModel model;       ///< completed model
  bool adequate = false;         ///< whether the residual is noise in every event
  std::string sentence;          ///< result in words
};
/// Diagnoses the model and adds what each diagnosis names, in at most four additions. After each addition,
/// the controls added before are removed if they lack evidence (try_without). The held-out events are
/// excluded from diagnoses and fits.
Completion add_until_adequate(const plant::PlantModel& model, const std::vector<record::Record>& records,
                              const AddOptions& options);

}  // namespace swingbank::validate::add
