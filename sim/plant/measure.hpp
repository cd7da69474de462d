#pragma once
// Simulation of the measurement chain between a plant's terminal and a record.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/library/library.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Terminal quantities, uniformly sampled; all vectors have the same length.
struct TerminalRecord {
  std::vector<double> V, theta;  ///< voltage magnitude [pu] and angle [rad]
  std::vector<double> P, Q;      ///< power out of the plant [pu]
  std::vector<double> df;        ///< frequency deviation [pu]
};

/// Returns the phasors of a terminal; current is conj((P + jQ) / V). If record.df is empty, the frequency is
/// the derivative of theta (central difference). `rate` [1/s]; `frequency`: system frequency [Hz]. Throws
/// InputError if V = 0 at a sample, because P and Q then do not determine the current; `where` names the
/// record.
Phasors phasors_of(const TerminalRecord& record, double rate, double frequency, const std::string& where);
/// Inverse of phasors_of(). theta is unwrapped, and its first value is within pi of `first_theta` [rad].
TerminalRecord terminal_of(const Phasors& phasors, double first_theta);

/// Applies the instruments of `chain` in order. Block k has its own random numbers, derived from `seed` and
/// k.
void measure(std::span<const Block> chain, std::uint64_t seed, Phasors& phasors);
/// Returns an upper bound of the time, to either side, over which V and I at the chain's input affect V and I
/// at its output: the sum of Effect::memory [s]. An instrument that only delays the frequency
/// (Effect::angle_lag) does not count.
double memory(std::span<const Block> chain);

/// Reads "EFFECT[:PARAM=VALUE,...]" for the measurement slot, with the effects of `library`. Errors are added
/// to `problems` with the place `where`.
std::optional<Block> read_measurement(const std::string& text, const library::EffectLibrary& library,
                                      const std::string& where, Problems& problems);

}  // namespace swingbank::sim::plant
