#pragma once
// Switchings of the network in a record, and the record's samples that an instrument has filtered around
// them.
#include <vector>

#include "base/complex.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::switching {

/// Change of the network with a step of the voltage. A sample at `time` itself counts as before the
/// switching.
struct Switching {
  double time = 0;                             ///< [s]
  double uncertainty = 0;                      ///< the time lies within ± uncertainty [s]; 0: known
  bool has_before = false, has_after = false;  ///< whether `before` and `after` are known
  Complex before{}, after{};                   ///< one-sided voltages at `time` [pu], if known
  double turn = 0;                             ///< step added to an integrated angle from this time on [rad]
};

/// Step of the voltage in one sample interval above which it counts as a switching [pu].
constexpr double kStepThreshold = 0.02;

/// Noise floor [pu]: residual of the interpolation between samples in a record without noise.
constexpr double kLeastNoise = 1e-4;

/// Shape of all voltage steps as the instrument records them: sharp or filtered; `either`: unknown.
enum class StepShape { either, sharp, filtered };

/// Switching times of a record.
struct SwitchingTimes {
  std::vector<Switching> switchings;  ///< ascending; those with an uncertainty are fitted
  /// Marks samples inside or next to a step filtered by the instrument; these are not played in.
  std::vector<char> filtered_samples = {};
};

/// A record with its switching times.
struct SwitchedRecord : SwitchingTimes {
  record::Record record = {};  ///< record as read
  /// Time, V and theta of the samples that are not filtered, and of the reconstructed voltage at filtered
  /// ones. Empty if no sample is filtered.
  record::Record clean = {};
};

}  // namespace swingbank::validate::switching
