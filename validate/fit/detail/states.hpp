#pragma once
// The state that every event has of its own: its operating point and how it moves at the start.
#include <array>

#include "validate/playin/play_in.hpp"

namespace swingbank::validate::fit {

inline constexpr int kStates = 4;  ///< P, Q [pu], angle [rad], speed [pu]
inline constexpr std::array<playin::Direction::Kind, kStates> kStateKind = {
    playin::Direction::Kind::P, playin::Direction::Kind::Q, playin::Direction::Kind::angle,
    playin::Direction::Kind::speed};
/// One unit of each state, as the search steps: it is far below any effect and far above rounding.
inline constexpr std::array<double, kStates> kStateScale = {1e-3, 1e-3, 1e-3, 1e-5};
/// A start is believed to be off by so many of those units, because a plant nearly stands still before an
/// event.
inline constexpr std::array<double, kStates> kStateBelief = {20, 20, 20, 20};
/// The same in the units of the states.
inline constexpr std::array<double, kStates> kStateSpread = [] {
  std::array<double, kStates> spread{};
  for (std::size_t k = 0; k < kStates; ++k) spread[k] = kStateScale[k] * kStateBelief[k];
  return spread;
}();

}  // namespace swingbank::validate::fit
