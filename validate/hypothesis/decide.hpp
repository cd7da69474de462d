#pragma once
// What a person could record next to tell apart what is left, and how small the set would then be.
#include <string>
#include <vector>

#include "validate/hypothesis/judge.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::validate::hypothesis {

/// A record that could be made, and how many effects the set would then hold on average.
struct NextRecord {
  std::string what;  ///< "field current in one more event like ev1"
  double expected = 0;
};
struct Decision {
  double now = 0;                ///< effects in the set
  std::vector<NextRecord> next;  ///< the most telling one first; empty: nothing to tell apart
};

/// Plays the rivals of the set into what could be recorded: events like those that were (the most telling
/// one), a load step far away, a step of the voltage's reference; with the channels of these records, and
/// with speed, field voltage or field current as well. One rival's answer is what is recorded, another's is
/// refitted to it (linear about its fit, with what the records know of its parameters), and what it then
/// leaves is the fall of its evidence. Only of whole plants.
Decision what_would_decide(const std::vector<Judgement>& ranked, const std::vector<Explanation>& all,
                           const event::WhitenedEvents& events, double spread, int threads);

/// "Field current in one more event like ev1 would decide: set of 4 -> 1.2."; empty without rivals.
std::string decide_sentence(const Decision& decision);

}  // namespace swingbank::validate::hypothesis
