#pragma once
// One effect added to a model: fitted with everything else on the events seen, and held against the same
// structure refitted without it, on the unseen ones too.
#include "validate/calibrate/calibrate.hpp"
#include "validate/hypothesis/hypothesis.hpp"

namespace swingbank::validate::add {

struct AddOptions {
  calibrate::CalibrateOptions calibrate = {};  ///< spread, events held out, limits, progress
};

/// One event: chi2 per value of the model as it was, refitted without the effect, and with it.
struct AddedEvent {
  calibrate::EventScore score;  ///< before: the model as it was; after: with the effect
  double refitted = 0;          ///< chi2 per value without the effect, after refitting everything else
  [[nodiscard]] bool improves() const { return score.after < refitted; }
};

struct Addition {
  hypothesis::Hypothesis hypothesis;
  plant::PlantModel model;  ///< with the effect and the fitted values
  std::vector<fit::FittedParameter>
      parameters;  ///< all parameters that were free, those of the effect first; as calibrate gives them
                   ///< where nothing but noise is left
  int own = 0;     ///< how many are the effect's
  std::vector<AddedEvent> events;
  double evidence = 0;        ///< criterion() without - with, over the events seen: it earns its place above
                              ///< thresholds::addition.strong
  bool earns = false;         ///< evidence is strong, and no unseen event is worse with it
  bool adequate = false;      ///< nothing but noise is left in any event
  thresholds::Ruling ruling;  ///< what decided whether it is
  std::string sentence;
  event::WhitenedEvents prepared;
  fit::Fit without, with;
  double seconds = 0;
};

/// The hypothesis of that name (letters' case and blanks do not matter). Throws InputError naming those that
/// can be added to this plant; says so where the slot is taken, or where the effect belongs to one event.
hypothesis::Hypothesis find_hypothesis(const plant::PlantModel& model, const std::string& name);

/// Throws InputError as calibrate does.
Addition add_effect(const plant::PlantModel& model, const hypothesis::Hypothesis& hypothesis,
                    const std::vector<record::Record>& records, const AddOptions& options);

/// Takes out one control of a model (index into Plant::controls) and says what its evidence is with
/// everything else refitted. The returned model lacks it.
struct Removal {
  std::string effect;
  plant::PlantModel model;
  double evidence =
      0;  ///< criterion() without - with: at addition.stays and below the effect does not earn its place
};
Removal try_without(const plant::PlantModel& model, std::size_t control, std::vector<record::Record> records,
                    const AddOptions& options);

/// Everything that was done until the model was adequate, or nothing helped any more.
struct Completion {
  std::vector<Addition> added;   ///< in order
  std::vector<Removal> removed;  ///< of them
  plant::PlantModel model;
  bool adequate = false;
  std::string sentence;
};
/// Diagnoses and adds one effect at a time, `most` effects at most. After each addition, what was added
/// before must still earn its place. Neither diagnosis nor fit sees the events held out.
Completion add_until_adequate(const plant::PlantModel& model, const std::vector<record::Record>& records,
                              const AddOptions& options, int most = 4);

}  // namespace swingbank::validate::add
