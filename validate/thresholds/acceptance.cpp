#include "validate/thresholds/acceptance.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>
#include <utility>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "validate/thresholds/adequacy.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {
namespace {

constexpr double kMostPercent = 1000;

/// Returns limits of data sheet I16 for P and Q; `of` is what the model is compared with.
Acceptance dtr(const char* name, const char* of, const std::array<Errors, 3>& limits) {
  return {name,
          fmt::format("French grid code (RTE DTR), data sheet I16, limits for comparison with {}, as "
                      "implemented in DyCoV 1.1",
                      of),
          {limits, limits},
          0.02,
          0.06,
          movement.error};
}

const std::vector<Acceptance>& presets() {
  static const std::vector<Acceptance> all = {
      dtr("dtr-test", "measurements", {{{8, 4, 7}, {10, 5, 8}, {8, 4, 7}}}),
      dtr("dtr-simulation", "simulations", {{{5, 2, 3}, {8, 5, 7}, {5, 2, 3}}}),
  };
  return all;
}

const Acceptance* preset(const std::string& name) {
  const auto found = std::ranges::find(presets(), name, &Acceptance::name);
  return found == presets().end() ? nullptr : &*found;
}

/// Keys of the windows in the file.
constexpr std::array<std::string_view, 3> kKeys = {"pre_fault", "fault", "post_fault"};
/// Keys of the errors in the file.
constexpr struct {
  const char* key;
  double Errors::*value;
  const char* meaning;
} kErrors[] = {{"mxe", &Errors::mxe, "largest absolute value of modelled - measured"},
               {"me", &Errors::me, "absolute value of the mean of modelled - measured"},
               {"mae", &Errors::mae, "mean absolute value of modelled - measured"}};
/// Keys of the times excluded after switching, and the maximum times of IEC 61400-27-2 [s].
constexpr struct {
  const char* key;
  double Acceptance::*value;
  double most;
  const char* meaning;
} kLeftOut[] = {
    {"after_fault", &Acceptance::after_fault, 0.14, "time excluded after the first switching of a fault"},
    {"after_clearing", &Acceptance::after_clearing, 0.5, "time excluded after the last switching"}};

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
      for (const auto& error : kErrors)
        a.limits[static_cast<std::size_t>(channel)][at].*error.value = number(
            table + error.key, otherwise.*error.value, {0.001, kMostPercent, "% of MVA", error.meaning});
    }
  for (const auto& time : kLeftOut)
    a.*time.value = file.optional<double>(fmt::format("left_out.{}", time.key), from ? from->*time.value : 0,
                                          {0, time.most, "s", time.meaning});
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

std::vector<Threshold> preset_thresholds() {
  // The texts of a threshold are only views.
  static std::deque<std::string> texts;
  static const std::vector<Threshold> all = [] {
    std::vector<Threshold> limits;
    for (const Acceptance& a : presets()) {
      const auto add = [&](std::string key, double value, const char* unit, const char* meaning) {
        limits.push_back({texts.emplace_back(a.name + "." + std::move(key)), value, unit,
                          texts.emplace_back(fmt::format("{} ({})", meaning, a.source))});
      };
      for (const Phase phase : kPhases)
        for (const auto& error : kErrors)
          add(fmt::format("{}.{}", kKeys[static_cast<std::size_t>(phase)], error.key),
              a.of(0, phase).*error.value, "% of MVA", error.meaning);
      for (const auto& time : kLeftOut) add(time.key, a.*time.value, "s", time.meaning);
    }
    return limits;
  }();
  return all;
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
