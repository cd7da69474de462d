// Steps of switched shunts between power-flow solutions.
#include "sim/network/detail/shunt_steps.hpp"

#include <algorithm>

namespace swingbank::sim::network {
namespace {

constexpr double kSameStep = 1e-9;  ///< tolerance [pu], because steps are rounded sums

/// Returns -1 for too much susceptance, +1 for too little, 0 within the band.
int way_to_band(const SwitchedShunt& s, double v) { return v > s.most ? -1 : v < s.least ? 1 : 0; }

/// Returns the next susceptance in a direction [pu], or `now` if there is none.
double next_step(const SwitchedShunt& s, double now, int direction) {
  if (direction > 0) {
    const auto found = std::ranges::upper_bound(s.steps, now + kSameStep);
    return found == s.steps.end() ? now : *found;
  }
  const auto found = std::ranges::lower_bound(s.steps, now - kSameStep);
  return found == s.steps.begin() ? now : *std::prev(found);
}

}  // namespace

ShuntSteps::ShuntSteps(const Network& network) : n_(network) {
  for (const SwitchedShunt& s : n_.switched) banks_.push_back({s.present});
}

bool ShuntSteps::step(const std::function<double(int)>& voltage,
                      const std::function<void(int, double)>& change) {
  bool moved = false;
  for (std::size_t i = 0; i < banks_.size(); ++i) {
    const SwitchedShunt& s = n_.switched[i];
    Bank& bank = banks_[i];
    const int way = way_to_band(s, voltage(s.regulated));
    if (way == 0) continue;
    if (bank.last == -way) continue;  // the band is narrower than a step
    const double to = next_step(s, bank.now, way);
    if (to == bank.now) continue;
    change(s.bus, to - bank.now);
    bank.now = to;
    bank.last = way;
    moved = true;
  }
  return moved;
}

std::vector<SteppedShunt> ShuntSteps::result(const std::function<double(int)>& voltage) const {
  std::vector<SteppedShunt> list;
  for (std::size_t i = 0; i < banks_.size(); ++i) {
    const bool in_band = way_to_band(n_.switched[i], voltage(n_.switched[i].regulated)) == 0;
    if (!in_band || banks_[i].now != n_.switched[i].present) list.push_back({i, banks_[i].now, in_band});
  }
  return list;
}

}  // namespace swingbank::sim::network
