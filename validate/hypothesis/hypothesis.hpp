#pragma once
// What could be missing: every effect of a library in a slot that has room, every group of parameters at
// their neutral values, every measurement fault, every convention. And what could be of another kind: every
// control in a slot that holds only one control. Nothing is listed by name: an effect joins by existing.
#include <string>
#include <vector>

#include "sim/library/library.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::hypothesis {

enum class Side { none, mechanical, excitation, machine, measurement };
std::string_view side_name(Side side);

struct Hypothesis {
  std::string name;       ///< "SEXS", "GENROU:S10,S12", "EXST1 in place of SEXS"
  std::string what;       ///< "exciter SEXS (simplified excitation system)"
  std::string with = {};  ///< name of what was added before it; empty: nothing
  Side side = Side::none;
  bool replaces = false;    ///< it takes the place of the control that stands in its slot
  int slot = -1;            ///< slot that the effect would fill (sim::Slot); -1: none is filled
  sim::plant::Plant plant;  ///< the base with the hypothesis added, at a value to start from
  sim::Conventions conventions;
  std::vector<fit::FreeParameter> free;     ///< parameters that the hypothesis brings
  std::vector<std::vector<double>> starts;  ///< values of `free`, tried in turn
  bool drawn = false;                       ///< whether the starts after the first are draws about it
  /// Further values of `free`, each of which is optimised where the effect is identified alone.
  std::vector<std::vector<double>> further = {};
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
};

/// Everything of the library that may be added to the plant. The hypotheses refer to its effects. Some of it
/// may change nothing there (a stabiliser without an exciter), which only trying shows. Effects that act at
/// given instants belong to one event and are not among them. Of a component only what is part of it.
std::vector<Hypothesis> all_hypotheses(const sim::plant::PlantUnderTest& tested,
                                       const sim::library::EffectLibrary& library,
                                       record::Component component = record::Component::plant);
/// Every control of the plant that has its slot to itself, replaced by every other effect of that slot.
std::vector<Hypothesis> all_replacements(const sim::plant::PlantUnderTest& tested,
                                         const sim::library::EffectLibrary& library);
/// The hypothesis with a further group of parameters free that its effect's default values leave at their
/// null values, as a rate feedback KF = 0: one for each group ("EXST1 with KF") and, where a group may have
/// either sign, for each sign. What acts only beside the group (TF) has as wide a prior as the group.
/// `fitted` is the plant of a fit of `h`: further starts have its values, and draws of what was freed. None
/// where the starts of `h` are no draws.
std::vector<Hypothesis> with_left_off(const Hypothesis& h, const sim::plant::Plant& fitted);
/// More draws of the hypothesis's first `own` free parameters than the starts it came with. Their longest
/// time is about `within` [s] at most.
std::vector<std::vector<double>> further_draws(const Hypothesis& h, std::size_t own, std::size_t count,
                                               double within);
/// Its name after that of what was added before: "SEXS + GENROU:Ra".
std::string full_name(const Hypothesis& h);
/// The hypothesis's plant with `start` as values of its free parameters.
sim::plant::Plant started(const Hypothesis& h, const std::vector<double>& start);

}  // namespace swingbank::validate::hypothesis
