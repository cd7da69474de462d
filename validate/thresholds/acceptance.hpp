#pragma once
// "Is the model fit for its purpose?" is asked beside "is nothing but noise left?": engineering limits of the
// errors of P and Q, window by window, as IEC 61400-27-2 counts them. The limits are a preset or stand in a
// file (configs/accept/README.md).
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::validate::thresholds {

/// Windows of an event: before its first switching, between that and its last one, and after it.
enum class Phase { pre_fault, fault, post_fault };
inline constexpr std::array kPhases = {Phase::pre_fault, Phase::fault, Phase::post_fault};
std::string_view phase_name(Phase phase);  ///< "pre-fault"

/// Maximum, mean and mean absolute error, of modelled less measured [% of the machine's MVA]. Of limits the
/// mean's holds for its size.
struct Errors {
  double mxe = 0, me = 0, mae = 0;
};

struct Acceptance {
  std::string name, source;                     ///< what the limits are called, and where they come from
  std::array<std::array<Errors, 3>, 2> limits;  ///< of P and of Q, by phase
  double after_fault = 0, after_clearing = 0;   ///< not compared after the first and the last switching [s]
  double movement = 0;  ///< RMS error after the last switching [% of the RMS movement of the channel]
  /// `channel`: 0 is P, 1 is Q.
  [[nodiscard]] const Errors& of(int channel, Phase phase) const {
    return limits[static_cast<std::size_t>(channel)][static_cast<std::size_t>(phase)];
  }
};

/// Names of the presets; the first is the default.
std::vector<std::string> acceptance_presets();
/// A preset by its name, the default where `what` is empty, else the file of that name. Throws InputError
/// with every fault of the file, or that there is neither.
Acceptance read_acceptance(const std::string& what);
/// From a file's text; `name` stands for it in messages.
Acceptance parse_acceptance(const std::string& text, const std::string& name);

/// The error of one window that is nearest to its limit, or furthest beyond it.
struct Nearest {
  std::string_view name;        ///< "MXE"
  double error = 0, limit = 0;  ///< [% of MVA]; the mean's as its size
  double ratio = 0;             ///< error / limit; infinite where the error is no number
};
Nearest nearest(const Errors& errors, const Errors& limits);
/// How many of the three exceed their limits; what is no number does.
int exceeding(const Errors& errors, const Errors& limits);

/// Exit code of a command that judges a model. 0: nothing but noise is left, and it is fit for purpose; 3:
/// not adequate, more than noise is left; 4: the same, but fit for purpose; 5: nothing but noise is left, but
/// not fit for purpose.
int exit_code(bool complete, bool fit);
/// The same in words, for `--help`.
extern const char* const kExitCodes;

}  // namespace swingbank::validate::thresholds
