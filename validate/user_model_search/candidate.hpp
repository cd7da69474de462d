#pragma once
// Candidates for a user-defined model u = f(signal) or u = f(time) of the inferred input. This input is the
// additional torque or field voltage that explains the records (reduced/free_input.hpp). Candidates are
// enumerated on grids of their few parameters and ranked by regression on the inferred input, which is fast
// enough for thousands of candidates. The leading candidates are then fitted to the records (search.hpp).
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::user_model_search {

/// A signal that a user-defined model may use, as deviation from its value at the operating point.
struct UserModelSignal {
  std::string_view name, expression, words;  ///< name; expression in the TOML file; description
};
/// Signals that the search examines.
inline constexpr std::array kUserModelSignals = {
    UserModelSignal{"speed", "speed", "the speed deviation"},
    UserModelSignal{"V", "V - V0", "the deviation of the terminal voltage from its value before the event"},
    UserModelSignal{"P", "P - P0", "the deviation of the active power from its value before the event"},
    UserModelSignal{"Q", "Q - Q0", "the deviation of the reactive power from its value before the event"},
    UserModelSignal{"Ifd", "Ifd - Ifd0",
                    "the deviation of the field current from its value before the event"}};

/// Signals and inferred input of one event.
struct UserModelTrace {
  std::vector<double> t;  ///< samples [s]
  /// [signal][sample] [pu on the machine's base].
  std::array<std::vector<double>, kUserModelSignals.size()> signal;
  /// First time at which V deviates from its value before the event by more than trigger_level() [s]; NaN:
  /// none.
  double trigger = std::numeric_limits<double>::quiet_NaN();
  double begin = 0;  ///< start of the inferred input [s]
  /// Value before the event [pu]: active power if the input is a torque, else field voltage.
  double rest = 0;
  std::vector<double> knots, input;  ///< knots [s] and values [pu] of the inferred input
};

/// A parameter of a user-defined model with its value and range.
struct UserModelParameter {
  std::string name, unit;               ///< name and unit
  double value = 0, low = 0, high = 0;  ///< value and range [unit]
  bool gain = false;                    ///< whether the model has no output if this parameter is zero
  std::string meaning;                  ///< meaning for the TOML file
};

/// A candidate: text of the user-defined model, and its parameters.
struct UserModelCandidate {
  fit::InputKind kind = fit::InputKind::torque;  ///< input to which the model's output is added
  std::string family;       ///< "static", "lagged", "limited", "dead-banded", "periodic", "step", ...
  std::string signal;       ///< name in kUserModelSignals, "time" or "time since the voltage deviation"
  std::string words;        ///< description with {name} in place of a parameter's value
  std::string value, body;  ///< expression and tables of the TOML file
  /// Conditions for `require` in the TOML file, each in quotes: "w1 < w2", "w2 < w3".
  std::string requirements = "";
  std::vector<UserModelParameter> parameters;  ///< parameters, in the order of the TOML file
  double explained = 0;                        ///< coefficient of determination of the inferred input
  double score = 0;  ///< Bayesian information criterion of the regression; lower is better
  std::vector<std::vector<double>> time_series;  ///< output of the model [event][knot] [pu]
};

/// Returns the voltage deviation [pu] at which the signal "time since the voltage deviation" starts. It is
/// above the voltage's noise. It is at most half of the largest deviation in any event with a switching, so
/// that each such event starts the signal. Returns 0 if no event has a switching, or if the largest deviation
/// in one of these events is too small.
double trigger_level(const noise::WhitenedEvents& events);

/// Returns the best candidate of each family and signal, in ascending order of score. `level`: see
/// trigger_level().
std::vector<UserModelCandidate> user_model_candidates(fit::InputKind kind,
                                                      const std::vector<UserModelTrace>& traces,
                                                      double level);

}  // namespace swingbank::validate::user_model_search
