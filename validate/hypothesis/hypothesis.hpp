#pragma once
// Hypotheses on missing effects: every effect of a library in a free slot, every group of parameters at their
// null values, every linear instrument error, the speed-voltage convention, every switch of a converter's
// controls. At its null value a parameter has no influence. In addition, a control in a slot that holds one
// effect may be replaced by every other effect of this slot. The code lists no effect by name, so a new
// effect is included automatically.
#include <string>
#include <vector>

#include "sim/library/library.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::hypothesis {

/// Side of a plant on which an effect acts.
enum class Side { none, mechanical, excitation, machine, measurement };
/// Returns the name of a side in reports, for example "excitation".
std::string_view side_name(Side side);

/// A possible change of the model: an added or replaced effect, freed parameters, another position of a
/// switch, or another convention.
struct Hypothesis {
  std::string name;              ///< "SEXS", "GENROU:S10,S12", "EXST1 in place of SEXS"
  std::string what;              ///< "exciter SEXS (simplified excitation system)"
  std::string with = {};         ///< name of the effect added before; empty: none
  Side side = Side::none;        ///< side of the plant that it changes
  bool replaces = false;         ///< whether it replaces the control in its slot
  int slot = -1;                 ///< slot that the effect fills (sim::Slot); -1: none or shared
  sim::plant::Plant plant;       ///< the base model with the hypothesis added, at its first start values
  sim::Conventions conventions;  ///< conventions with the hypothesis
  std::vector<fit::FreeParameter> free;     ///< parameters of the hypothesis
  std::vector<std::vector<double>> starts;  ///< start values of `free`
  bool added = false;                       ///< whether it adds an effect other than an instrument
  /// Further start values of `free`, for the identification only.
  std::vector<std::vector<double>> further = {};
  /// Returns references to plant and conventions; the hypothesis must outlive them.
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
};

/// Properties of the records that determine which hypotheses can be tested.
struct RecordContents {
  record::Component component = record::Component::plant;  ///< recorded part of the plant
  bool integrated_angle = false;  ///< whether any angle was integrated from a frequency
};

/// Returns every hypothesis that the library allows for the plant; the hypotheses refer to the library's
/// effects. Excludes effects whose output no block reads (a stabiliser without an exciter). Also excludes
/// effects that act at given times, because these are specific to one event. For the record of a component,
/// only effects of this component are returned.
std::vector<Hypothesis> all_hypotheses(const sim::plant::PlantUnderTest& tested,
                                       const sim::library::EffectLibrary& library,
                                       const RecordContents& recorded = {});
/// For every control in a slot that holds one effect, returns its replacements by all other effects of that
/// slot.
std::vector<Hypothesis> all_replacements(const sim::plant::PlantUnderTest& tested,
                                         const sim::library::EffectLibrary& library);
/// Returns extensions of `h` that also free a group of the added effect's parameters. The group is at null
/// values by default, such as a rate feedback KF = 0. There is one extension for each group ("EXST1 with KF")
/// and, if the group may have either sign, one for each sign. A parameter that acts only with the group (TF)
/// has the same wide prior as the group. `fitted` is the plant of a fit of `h`. Further start values are
/// those of this fit, with random draws for the freed parameters. Empty if `h` adds no effect with such a
/// group.
std::vector<Hypothesis> with_left_off(const Hypothesis& h, const sim::plant::Plant& fitted);
/// Returns the name of the hypothesis with that of the effect added before: "SEXS + GENROU:Ra".
std::string full_name(const Hypothesis& h);
/// Returns the plant as a hypothesis without a change and without free parameters.
Hypothesis unchanged(const sim::plant::PlantUnderTest& tested);
/// Returns the hypothesis's plant with `start` as values of its free parameters.
sim::plant::Plant started(const Hypothesis& h, const std::vector<double>& start);

}  // namespace swingbank::validate::hypothesis
