#pragma once
// What could be missing: every registered effect in a slot that has room, every group of parameters at their
// neutral values, every measurement fault, every convention. And what could be of another kind: every control
// in a slot that holds one only. Nothing is listed by name: an effect joins by existing.
#include <string>
#include <vector>

#include "validate/fit.hpp"

namespace swingbank::validate {

enum class Side { none, mechanical, excitation, machine, measurement };
std::string_view side_name(Side side);

struct Hypothesis {
  std::string name;       ///< "SEXS", "GENROU:S10,S12", "EXST1 in place of SEXS"
  std::string what;       ///< "exciter SEXS (simplified excitation system)"
  std::string with = {};  ///< what was added before it; empty: nothing
  Side side = Side::none;
  bool replaces = false;  ///< it takes the place of the control that stands in its slot
  int slot = -1;          ///< of the effect that would fill it (sim::Slot); -1: none is filled
  sim::Plant plant;       ///< the base with it, at a value to start from
  sim::Conventions conventions;
  std::vector<FreeParameter> free;          ///< those it brings
  std::vector<std::vector<double>> starts;  ///< values of `free`, tried in turn
  bool drawn = false;                       ///< starts after the first are draws about it
};

/// Everything that may be added to the plant. Some of it may change nothing there (a stabiliser without an
/// exciter); trying shows. Effects that act at given instants are not among them: they belong to one event.
std::vector<Hypothesis> all_hypotheses(const sim::Plant& base, const sim::Conventions& conventions);
/// Every control of the plant that has its slot to itself, by every other effect of that slot in its place.
std::vector<Hypothesis> all_replacements(const sim::Plant& base, const sim::Conventions& conventions);
/// More draws of its first `own` free parameters than the starts it came with; their longest time about
/// `within` [s] at most.
std::vector<std::vector<double>> further_draws(const Hypothesis& h, std::size_t own, std::size_t count,
                                               double within);
/// Its name after that of what was added before: "SEXS + GENROU:Ra".
std::string full_name(const Hypothesis& h);
/// The hypothesis's plant with `start` as values of its free parameters.
sim::Plant started(const Hypothesis& h, const std::vector<double>& start);

}  // namespace swingbank::validate
