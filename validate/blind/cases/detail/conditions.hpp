#pragma once
// The conditions that one case is recorded under, drawn from BlindConditions: what a clean record of a quiet
// grid does not have.
#include <limits>
#include <string>
#include <vector>

#include "validate/blind/cases/case.hpp"
#include "validate/blind/cases/detail/random.hpp"

namespace swingbank::validate::blind::cases {

enum class Filter { none, class_p, class_m };

struct Conditions {
  double rate = 0;           ///< of the record [1/s]
  double voltage_noise = 0;  ///< noise of V [pu] and theta [rad] as a multiple of that of P and Q
  Filter filter = Filter::none;
  double lead =
      std::numeric_limits<double>::infinity();  ///< the record begins that long before its event [s]
  double ambient = 0;                           ///< rms of every load about its power, as a part of it
  double drift = 0;                             ///< of all loads, as a part of them per second
  double wander = 0;  ///< of the angle's reference: amplitude [rad], over a period of `wander_s`
  double wander_s = 1;
  bool longer = false;      ///< the first event is recorded three times as long
  bool switchless = false;  ///< the last event is a dip of frequency without any switching
};

/// What stands in [record] is kept where [conditions] does not name it, and takes no draw then. `instrument`:
/// what is hidden is one, so that no filter is drawn beside it. `dips`: whether the grid has governors, which
/// a dip of frequency needs.
Conditions draw_conditions(const BlindConfig& config, bool instrument, bool dips, BlindDraw& draw);
/// What of it is not the usual, for the truth: "30/s", "class M", "ambient 0.3 %".
std::vector<std::string> told(const Conditions& c, const BlindConfig& config);

/// Lets the loads of an event move as the conditions say: stairs of 0.025 s that lie off the samples.
void let_loads_move(BlindEvent& event, const sim::network::Network& network, const Conditions& c,
                    BlindDraw& draw);
/// All loads rise by a few per cent and fall back over 20 to 60 s, without any switching.
BlindEvent draw_dip(const sim::network::Network& network, BlindDraw& draw);

}  // namespace swingbank::validate::blind::cases
