#pragma once
// The measurement chain between a plant's terminal and a record.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/library/library.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// What is known of a terminal, uniformly sampled; all vectors have the same length.
struct TerminalRecord {
  std::vector<double> V, theta;  ///< [pu], [rad]
  std::vector<double> P, Q;      ///< out of the plant [pu]
  std::vector<double> df;        ///< frequency deviation [pu]
};

/// The phasors of a terminal; current is conj((P + jQ) / V). Where record.df is empty the frequency is the
/// derivative of theta (central difference). `rate` [1/s], `frequency` of the system [Hz]. Throws InputError
/// where V = 0, for P and Q do not tell the current there; `where` names the record.
Phasors phasors_of(const TerminalRecord& record, double rate, double frequency, const std::string& where);
/// Back again; theta is continuous from sample to sample, in the turn of `first_theta` [rad].
TerminalRecord terminal_of(const Phasors& phasors, double first_theta);

/// Sends the phasors through the instruments one after another. Block k draws from its own random numbers,
/// made of `seed` and k.
void measure(std::span<const Block> chain, std::uint64_t seed, Phasors& phasors);
/// How far an output of the whole chain reaches to either side [s].
double memory(std::span<const Block> chain);

/// "EFFECT[:PARAM=VALUE,...]" of the measurement slot, with the effects of `library`. What is wrong becomes
/// problems that name `where`.
std::optional<Block> read_measurement(const std::string& text, const library::EffectLibrary& library,
                                      const std::string& where, Problems& problems);

}  // namespace swingbank::sim::plant
