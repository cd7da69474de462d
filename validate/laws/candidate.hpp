#pragma once
// Small laws u = f(signal) or u = f(time) that could be the inferred input. They are enumerated over grids of
// their few numbers, and each is judged by how much of the input's course it takes away. This is cheap, so
// thousands can be tried; the leading ones are then fitted to the records themselves (search.hpp).
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::laws {

/// A signal that laws may read, as deviation from its value at the operating point.
struct LawSignal {
  std::string_view name, expression, words;
};
inline constexpr std::array kLawSignals = {
    LawSignal{"speed", "speed", "the speed deviation"},
    LawSignal{"V", "V - V0", "the deviation of the terminal voltage from its value before the event"},
    LawSignal{"P", "P - P0", "the deviation of the active power from its value before the event"},
    LawSignal{"Q", "Q - Q0", "the deviation of the reactive power from its value before the event"},
    LawSignal{"Ifd", "Ifd - Ifd0", "the deviation of the field current from its value before the event"}};

/// One event as laws see it.
struct LawTrace {
  std::vector<double> t;  ///< samples [s]
  std::array<std::vector<double>, kLawSignals.size()>
      signal;                                                 ///< [signal][sample] [pu on the machine's base]
  double trigger = std::numeric_limits<double>::quiet_NaN();  ///< first switching that V shows [s]; NaN: none
  double begin = 0;                                           ///< from when the input is known [s]
  double rest = 0;                                            ///< active power or field voltage at rest [pu]
  std::vector<double> knots, input;                           ///< the inferred input [s], [pu]
};

struct LawParameter {
  std::string name, unit;
  double value = 0, low = 0, high = 0;
  bool gain = false;  ///< at zero the law does nothing
  std::string meaning;
};

/// A law: its text but for the parameters' values.
struct LawCandidate {
  fit::InputKind kind = fit::InputKind::torque;
  std::string family;             ///< "static", "lagged", "limited", "dead-banded", "periodic", "step", ...
  std::string signal;             ///< of kLawSignals, "time" or "time since the voltage moved"
  std::string words;              ///< with {name} where a parameter's value belongs
  std::string value, body;        ///< of the law file: the expression, and the tables that it needs
  std::string requirements = "";  ///< of the law file: conditions on the parameters, in quotes
  std::vector<LawParameter> parameters;
  double explained = 0;                     ///< share of the inferred input's square that it takes away
  double score = 0;                         ///< the same less what its numbers cost; lower is better
  std::vector<std::vector<double>> course;  ///< [event][knot] [pu]
};

/// Deviation of the voltage that counts as an event [pu]. It is well above the voltage's noise, and half of
/// what the smallest event with a switching shows. 0: no event shows any.
double trigger_level(const event::WhitenedEvents& events);

/// The best of each family and signal, best first. `level` as from trigger_level.
std::vector<LawCandidate> law_candidates(fit::InputKind kind, const std::vector<LawTrace>& traces,
                                         double level);

}  // namespace swingbank::validate::laws
