#pragma once
// Channels of a COMTRADE record as three-phase waveforms: which phase of which circuit each of them is, and
// the choice of one voltage and one current.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "validate/record/comtrade.hpp"
#include "validate/record/detail/phase.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

struct Wave {
  const ComtradeChannel* channel;
  bool voltage;
  Phase phase;
  std::string circuit;  ///< the channel's component, else what its name has beside quantity and phase
  double scale;         ///< to kV or kA
};
/// A voltage or current of which the unit and the phase are known.
std::optional<Wave> wave_of(const ComtradeChannel& channel);

/// Three waveforms that give the positive sequence; a channel may be the negative sum of the two others.
struct WaveSet {
  std::array<const Wave*, 3> waves{};  ///< at most one is none
  bool between = false;                ///< voltages ab, bc, ca
  std::string circuit;
};

/// The only complete set of that kind, or that of the circuit asked for. Adds a problem where there is none,
/// or several.
std::optional<WaveSet> choose_waves(const std::vector<Wave>& waves, bool voltage, const ReadOptions& options,
                                    const std::string& where, Problems& problems);

}  // namespace swingbank::validate::record
