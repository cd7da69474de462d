#pragma once
// Fit for purpose: engineering limits of the errors of P and Q in each window, with the error measures of IEC
// 61400-27-2. This test is independent of the test for noise. The limits are a preset or are read from a file
// (configs/accept/README.md).
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {

/// Windows of an event: before the first switching, between the first and the last one, and after the last
/// one.
enum class Phase { pre_fault, fault, post_fault };
/// All phases, in order of time.
inline constexpr std::array kPhases = {Phase::pre_fault, Phase::fault, Phase::post_fault};
std::string_view phase_name(Phase phase);  ///< "pre-fault"

/// Maximum, mean and mean absolute error, modelled - measured [% of the machine's MVA]. As limits, `me`
/// applies to the absolute value of the mean.
struct Errors {
  double mxe = 0, me = 0, mae = 0;  ///< maximum, mean and mean absolute error [% of MVA]
};

/// A set of limits for fit for purpose.
struct Acceptance {
  std::string name, source;                     ///< name of the limits, and their source
  std::array<std::array<Errors, 3>, 2> limits;  ///< [P, Q][phase]
  double after_fault = 0, after_clearing = 0;   ///< time excluded after the first and the last switching [s]
  double movement = 0;  ///< RMS error after the last switching [% of the RMS movement of the channel]
  /// Returns the limits of a channel (0: P, 1: Q) in a phase.
  [[nodiscard]] const Errors& of(int channel, Phase phase) const {
    return limits[static_cast<std::size_t>(channel)][static_cast<std::size_t>(phase)];
  }
};

/// Names of the presets; the first is the default.
std::vector<std::string> acceptance_presets();
/// Returns the limits of every preset: "dtr-test.fault.mxe", of P and of Q.
std::vector<Threshold> preset_thresholds();
/// Returns the preset `what` (the default if empty) or the limits of the file of that name. Throws InputError
/// with every problem of the file, or if neither a preset nor a file has this name.
Acceptance read_acceptance(const std::string& what);
/// Reads limits from a file's text; `name` is the file name in messages.
Acceptance parse_acceptance(const std::string& text, const std::string& name);
/// Returns the JSON Schema of the files.
std::string acceptance_schema();

/// The error of one window with the largest ratio to its limit.
struct Nearest {
  std::string_view name;        ///< "MXE"
  double error = 0, limit = 0;  ///< [% of MVA]; absolute value of the mean
  double ratio = 0;             ///< error / limit; infinite if the error is not finite
};
/// Returns the error with the largest ratio to its limit.
Nearest nearest(const Errors& errors, const Errors& limits);
/// Returns how many of the three errors exceed their limits; NaN counts as exceeding.
int exceeding(const Errors& errors, const Errors& limits);

/// Returns the exit code of a command that judges a model. 0: statistically complete (the residual is noise)
/// and fit for purpose; 3: neither; 4: fit for purpose only; 5: statistically complete only.
int exit_code(bool complete, bool fit);
/// Description of the exit codes for `--help`.
extern const char* const kExitCodes;

}  // namespace swingbank::validate::thresholds
