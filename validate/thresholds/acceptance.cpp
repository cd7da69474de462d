#include "validate/thresholds/acceptance.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "validate/thresholds/adequacy.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {
namespace {

/// Maximum times that IEC 61400-27-2 excludes after a fault and after its clearing [s].
constexpr double kMostAfterFault = 0.14, kMostAfterClearing = 0.5;
constexpr double kMostPercent = 1000;

/// Returns one preset of thresholds.hpp; P and Q have the same limits.
template <class Preset>
Acceptance acceptance_of(const Preset& p, std::string name, std::string source) {
  const std::array<Errors, 3> one = {Errors{p.pre_fault_mxe, p.pre_fault_me, p.pre_fault_mae},
                                     Errors{p.fault_mxe, p.fault_me, p.fault_mae},
                                     Errors{p.post_fault_mxe, p.post_fault_me, p.post_fault_mae}};
  return {std::move(name), std::move(source), {one, one}, p.after_fault, p.after_clearing, movement.error};
}

const std::vector<Acceptance>& presets() {
  static const std::vector<Acceptance> all = {
      acceptance_of(
          dtr_test, "dtr-test",
          "French grid code (RTE DTR), data sheet I16, limits for comparison with measurements, as implemented "
          "in DyCoV 1.1"),
      acceptance_of(
          dtr_simulation, "dtr-simulation",
          "French grid code (RTE DTR), data sheet I16, limits for comparison with simulations, as implemented "
          "in DyCoV 1.1"),
  };
  return all;
}

const Acceptance* preset(const std::string& name) {
  const auto found = std::ranges::find(presets(), name, &Acceptance::name);
  return found == presets().end() ? nullptr : &*found;
}

/// Keys of the windows in the file.
constexpr std::array<std::string_view, 3> kKeys = {"pre_fault", "fault", "post_fault"};

Acceptance read(Config& file) {
  Acceptance a;
  a.name = file.require<std::string>("name", {.meaning = "name of the limits, printed with the verdict"});
  a.source =
      file.require<std::string>("source", {.meaning = "source of the limits, printed with the verdict"});
  const Acceptance* from = nullptr;
  if (file.has("preset"))
    from = preset(file.choice("preset", acceptance_presets(),
                              Range{.meaning = "preset of the limits that this file omits"}));
  const auto number = [&](const std::string& key, double otherwise, const Range& range) {
    return from ? file.optional<double>(key, otherwise, range) : file.require<double>(key, range);
  };
  for (int channel = 0; channel < 2; ++channel)
    for (const Phase phase : kPhases) {
      const auto at = static_cast<std::size_t>(phase);
      const std::string table = fmt::format("{}.{}.", channel == 0 ? "P" : "Q", kKeys[at]);
      const Errors otherwise = from ? from->of(channel, phase) : Errors{};
      const auto limit = [&](const char* key, double value, const char* meaning) {
        return number(table + key, value, {0.001, kMostPercent, "% of MVA", meaning});
      };
      a.limits[static_cast<std::size_t>(channel)][at] = {
          limit("mxe", otherwise.mxe, "largest absolute value of modelled - measured"),
          limit("me", otherwise.me, "absolute value of the mean of modelled - measured"),
          limit("mae", otherwise.mae, "mean absolute value of modelled - measured")};
    }
  a.after_fault =
      file.optional<double>("left_out.after_fault", from ? from->after_fault : 0,
                            {0, kMostAfterFault, "s", "time excluded after the first switching of a fault"});
  a.after_clearing =
      file.optional<double>("left_out.after_clearing", from ? from->after_clearing : 0,
                            {0, kMostAfterClearing, "s", "time excluded after the last switching"});
  a.movement = file.optional<double>(
      "movement.error", movement.error,
      {0.001, kMostPercent, "% of movement", "RMS of modelled - measured after the last switching"});
  file.raise();
  return a;
}

}  // namespace

std::string_view phase_name(Phase phase) {
  static constexpr std::array<std::string_view, 3> names = {"pre-fault", "fault", "post-fault"};
  return names[static_cast<std::size_t>(phase)];
}

std::vector<std::string> acceptance_presets() {
  std::vector<std::string> names;
  for (const Acceptance& a : presets()) names.push_back(a.name);
  return names;
}

Acceptance read_acceptance(const std::string& what) {
  if (what.empty()) return presets().front();
  if (const Acceptance* named = preset(what)) return *named;
  if (!std::filesystem::exists(what))
    throw InputError({"no limits '" + what + "'", "--accept", "no preset or file has this name",
                      fmt::format("give a file (configs/accept/README.md) or one of {}",
                                  fmt::join(acceptance_presets(), ", "))});
  Config file{std::filesystem::path(what)};
  return read(file);
}

Acceptance parse_acceptance(const std::string& text, const std::string& name) {
  Config file{text, std::filesystem::path(name)};
  return read(file);
}

std::string acceptance_schema() {
  return describe_keys("Limits of fitness of Swingbank", [](Config& file) { read(file); });
}

Nearest nearest(const Errors& errors, const Errors& limits) {
  const Nearest all[] = {{"MXE", errors.mxe, limits.mxe},
                         {"ME", std::abs(errors.me), limits.me},
                         {"MAE", errors.mae, limits.mae}};
  Nearest worst;
  worst.ratio = -1;
  for (Nearest one : all) {
    one.ratio = std::isfinite(one.error) ? one.error / one.limit : std::numeric_limits<double>::infinity();
    if (one.ratio > worst.ratio) worst = one;
  }
  return worst;
}

int exceeding(const Errors& errors, const Errors& limits) {
  const auto within = [](double error, double limit) { return std::abs(error) <= limit; };
  return 3 - within(errors.mxe, limits.mxe) - within(errors.me, limits.me) - within(errors.mae, limits.mae);
}

int exit_code(bool complete, bool fit) {
  if (complete) return fit ? 0 : kNotFit;
  return fit ? kFitOnly : kNotAdequate;
}

const char* const kExitCodes =
    "Exit codes: 0 statistically complete and fit for purpose, 3 neither, 4 fit for purpose, but not "
    "statistically complete, 5 statistically complete, but not fit for purpose, 1 bad input.";

}  // namespace swingbank::validate::thresholds
