#pragma once
// Joint fit of the effects that are added, and refits of the model without all effects and without each one.
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "validate/add/add.hpp"
#include "validate/add/detail/bench.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::add {

/// Fits of the model without and with the effects of an addition. Sets `without`, `with`, `hypothesis` and
/// `effects` of the addition.
class JointFit {
 public:
  /// `names`: canonical names of the effects; `a.without`: a fit of the given model.
  JointFit(const plant::PlantModel& model, const std::vector<std::string>& names,
           const hypothesis::RecordContents& recorded, Bench& bench, const AddOptions& options, Addition& a);
  JointFit(const JointFit&) = delete;
  JointFit& operator=(const JointFit&) = delete;

  /// Makes the fits. Returns whether the noise was estimated again. After an interruption, `with` is the best
  /// fit so far. Throws InputError if the effects cannot be fitted.
  bool run();

 private:
  /// The structure without one effect, refitted.
  struct LeftOut {
    std::size_t effect;             ///< index into Addition::effects
    hypothesis::Hypothesis others;  ///< all effects that can act without this effect
    fit::Fit fit;
  };

  void search();
  void leave_out();
  bool measure_noise();
  bool add_null_group();
  hypothesis::Judgement best(const hypothesis::BaseModel& base, std::vector<hypothesis::Hypothesis> all);
  std::vector<hypothesis::Judgement> judgements(const hypothesis::BaseModel& base,
                                                std::vector<hypothesis::Hypothesis> all);
  [[nodiscard]] std::vector<hypothesis::Hypothesis> addable(const sim::plant::PlantUnderTest& tested,
                                                            const std::vector<std::string>& names) const;
  [[nodiscard]] hypothesis::Hypothesis together(std::vector<std::string> names) const;
  [[nodiscard]] fit::Fit from_other(const hypothesis::Hypothesis& h, const fit::Fit& f,
                                    const fit::Fit& other) const;
  [[nodiscard]] fit::Fit finished(const hypothesis::Judgement& j) const;
  void keep(const fit::Fit& f);
  [[noreturn]] void end();

  const std::vector<std::string>& names_;
  const hypothesis::RecordContents& recorded_;
  Bench& bench_;
  const AddOptions& options_;
  Addition& a_;
  std::mutex lock_;                  ///< guards reached_
  std::optional<fit::Fit> reached_;  ///< best fit so far
  const hypothesis::BaseModel base_model_;
  std::vector<LeftOut> left_out_;  ///< one per effect if there are several
};

/// Returns the hypothesis of that name for the plant, ignoring case and blanks; empty if it cannot be added.
std::optional<hypothesis::Hypothesis> named_hypothesis(const sim::plant::PlantUnderTest& tested,
                                                       const sim::library::EffectLibrary& library,
                                                       const hypothesis::RecordContents& recorded,
                                                       const std::string& name);

}  // namespace swingbank::validate::add
