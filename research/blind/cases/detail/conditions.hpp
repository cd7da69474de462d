#pragma once
// Field conditions of one case, drawn from BlindConditions.
#include <limits>
#include <string>
#include <vector>

#include "research/blind/cases/case.hpp"
#include "research/blind/cases/detail/random.hpp"

namespace swingbank::research::blind::cases {

enum class Filter { none, class_p, class_m };

struct Conditions {
  double rate = 0;           ///< reporting rate [1/s]
  double voltage_noise = 0;  ///< noise of V [pu] and theta [rad] as a multiple of the noise of P and Q
  Filter filter = Filter::none;
  double lead = std::numeric_limits<double>::infinity();  ///< duration of the record before its event [s]
  double ambient = 0;       ///< RMS variation of every load as a share of its power
  double drift = 0;         ///< drift of all loads as a share of their power per second
  double wander = 0;        ///< amplitude of the angle reference's variation [rad]
  double wander_s = 1;      ///< period of that variation [s]
  bool longer = false;      ///< whether the first record is three times as long
  bool switchless = false;  ///< whether the last event is a frequency dip without switching
};

/// Draws the conditions. A condition that [conditions] does not name keeps its value of [record] and consumes
/// no random number. `instrument`: whether the hidden effect is an instrument error; no filter is then used.
/// `dips`: whether the grid has governors, which a frequency dip needs.
Conditions draw_conditions(const BlindConfig& config, bool instrument, bool dips, BlindDraw& draw);
/// Returns the names of the conditions that differ from a clean record, for the truth: "30/s", "class M",
/// "loads drift".
std::vector<std::string> condition_names(const Conditions& c, const BlindConfig& config);

/// Adds the variation of the loads to an event, as load steps every 0.025 s, between the samples.
void let_loads_move(BlindEvent& event, const sim::network::Network& network, const Conditions& c,
                    BlindDraw& draw);
/// Draws a frequency dip without switching: all loads rise by 2 to 5 % and return over 20 to 60 s.
BlindEvent draw_dip(const sim::network::Network& network, BlindDraw& draw);

}  // namespace swingbank::research::blind::cases
