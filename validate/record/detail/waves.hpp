#pragma once
// Three-phase waveforms among the channels of a COMTRADE record: phase and circuit of each channel, and
// choice of one voltage and one current.
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
  std::string circuit;  ///< circuit component of the channel (COMTRADE ccbm); if empty, the channel name
                        ///< without quantity and phase
  double scale;         ///< factor to kV or kA
};
/// Returns the channel as a voltage or current; none if its unit or phase is unknown.
std::optional<Wave> wave_of(const ComtradeChannel& channel);

/// Three phase waveforms from which the positive-sequence component is computed. One may be absent; it is
/// then minus the sum of the other two (no zero-sequence component).
struct WaveSet {
  std::array<const Wave*, 3> waves{};  ///< at most one is null
  bool between = false;                ///< line-to-line voltages (ab, bc, ca)
  std::string circuit;
};

/// Returns the complete set of voltages or currents of the requested circuit, or the only complete set. Adds
/// a problem if there is none, or if there are several.
std::optional<WaveSet> choose_waves(const std::vector<Wave>& waves, bool voltage, const ReadOptions& options,
                                    const std::string& where, Problems& problems);

}  // namespace swingbank::validate::record
