#include "sim/plant/measure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/constants.hpp"
#include "sim/core/noise.hpp"
#include "sim/core/window.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::sim::plant {
Phasors phasors_of(const TerminalRecord& record, double rate, double frequency, const std::string& where) {
  Phasors phasors{rate, frequency, {}, {}, record.df};
  if (phasors.df.empty()) phasors.df = frequency_deviation(record.theta, rate, frequency);
  for (std::size_t k = 0; k < record.V.size(); ++k) {
    if (record.V[k] == 0.0)
      throw InputError({fmt::format("V = 0 pu after {:g} s", static_cast<double>(k) / rate), where,
                        "P and Q do not determine the current there, so no instrument can be applied",
                        "give the fault an impedance, or measure another plant"});
    const Complex v = std::polar(record.V[k], record.theta[k]);
    phasors.V.push_back(v);
    phasors.I.push_back(std::conj(Complex(record.P[k], record.Q[k]) / v));
  }
  return phasors;
}

TerminalRecord terminal_of(const Phasors& phasors, double first_theta) {
  TerminalRecord record;
  record.df = phasors.df;
  double last = first_theta;
  for (std::size_t k = 0; k < phasors.V.size(); ++k) {
    const Complex v = phasors.V[k], power = v * std::conj(phasors.I[k]);
    const double angle = std::arg(v),
                 theta = angle + constants::turn * std::nearbyint((last - angle) / constants::turn);
    if (std::isfinite(theta)) last = theta;
    record.V.push_back(std::abs(v));
    record.theta.push_back(theta);
    record.P.push_back(power.real());
    record.Q.push_back(power.imag());
  }
  return record;
}

void measure(std::span<const Block> chain, std::uint64_t seed, Phasors& phasors) {
  for (std::size_t k = 0; k < chain.size(); ++k)
    chain[k].effect->measure(chain[k].p.data(), seed_of(seed, k), phasors);
}

double memory(std::span<const Block> chain) {
  double sum = 0.0;
  for (const Block& block : chain)
    if (block.effect->memory && !block.effect->angle_lag) sum += block.effect->memory(block.p.data());
  return sum;
}

std::optional<Block> read_measurement(const std::string& text, const library::EffectLibrary& library,
                                      const std::string& where, Problems& problems) {
  const auto colon = text.find(':');
  const Effect* effect = library.find(text.substr(0, colon));
  if (!effect || effect->slot != Slot::measurement) {
    problems.add("no measurement effect '" + text.substr(0, colon) + "'", where,
                 "the measurement effects are " + library.names(Slot::measurement),
                 "write EFFECT[:PARAM=VALUE,...] with one of these");
    return {};
  }
  Block block{effect, effect->default_parameters()};
  Problems found;
  if (colon != text.npos) set_parameters(block, text.substr(colon + 1), where, found);
  if (found.empty()) effect->check(effect->user_model.get(), block.p.data(), where, found);
  problems.add(found);
  if (!found.empty()) return {};
  return block;
}

}  // namespace swingbank::sim::plant
