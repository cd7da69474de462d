#pragma once
// Checks of the parameter values of an effect. A message names the parameter, its value and its unit.
#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/problem.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

/// Reason to refuse the step of a dead-band.
inline constexpr std::string_view kDeadBandStep =
    "a dead-band with a step and hysteresis at its edge is not modelled";

/// Checks of the parameter values of one effect; every violation becomes a problem.
class ValueCheck {
 public:
  /// All arguments must outlive the object. `model`: name in messages; `p`: values of `parameters`.
  ValueCheck(std::string_view model, std::span<const Parameter> parameters, const double* p,
             const std::string& where, Problems& problems)
      : model_(model), parameters_(parameters), p_(p), where_(where), problems_(problems) {}

  /// Returns the usual notation of a parameter: "X'd".
  [[nodiscard]] std::string_view symbol(int i) const {
    return parameters_[static_cast<std::size_t>(i)].symbol;
  }
  /// Returns "X'd = 0.3 pu".
  [[nodiscard]] std::string text(int i) const {
    const Parameter& r = parameters_[static_cast<std::size_t>(i)];
    const bool plain = r.is_code() || r.unit == "-";
    return fmt::format("{} = {:g}{}{}", r.symbol, p_[i], plain ? "" : " ", plain ? "" : r.unit);
  }
  /// Returns "KF = 0.1 with TF1 = 0 s, TF2 = 0 s".
  template <class... I>
  [[nodiscard]] std::string text(int i, int second, I... more) const {
    std::string all = text(i) + " with " + text(second);
    ((all += ", " + text(more)), ...);
    return all;
  }

  /// Adds a problem if `wrong`.
  void refuse(bool wrong, const std::string& what, std::string_view why, std::string_view remedy) const {
    if (wrong) problems_.add(what, where_, std::string(why), std::string(remedy));
  }
  /// Adds a problem with parameter i and its value if `wrong`.
  void refuse(bool wrong, int i, std::string_view why, std::string_view remedy) const {
    refuse(wrong, text(i), why, remedy);
  }
  void require_positive(std::initializer_list<int> list, std::string_view why) const {
    for (const int i : list) refuse(!(p_[i] > 0), i, why, fmt::format("give {} > 0", symbol(i)));
  }
  /// Returns the reason why a value must be positive: "GENSAL divides by it".
  [[nodiscard]] std::string divides() const { return fmt::format("{} divides by it", model_); }
  /// Requires values > 0 because the model divides by them.
  void require_divisors(std::initializer_list<int> list) const { require_positive(list, divides()); }
  /// Requires p[high] > p[low] because the model divides by their difference.
  void require_difference(int high, int low) const {
    require_above(high, low, fmt::format("{} divides by {} - {}", model_, symbol(high), symbol(low)));
  }
  void refuse_negative(std::initializer_list<int> list,
                       std::string_view why = "it cannot be negative") const {
    for (const int i : list) refuse(!(p_[i] >= 0), i, why, fmt::format("give {} >= 0", symbol(i)));
  }
  void refuse_positive(std::initializer_list<int> list,
                       std::string_view why = "it cannot be positive") const {
    for (const int i : list) refuse(!(p_[i] <= 0), i, why, fmt::format("give {} <= 0", symbol(i)));
  }
  void require_times(std::initializer_list<int> list) const {
    refuse_negative(list, "a time constant cannot be negative");
  }
  /// Requires 0 or 1.
  void require_switches(std::initializer_list<int> list) const {
    for (const int i : list)
      refuse(p_[i] != 0 && p_[i] != 1, i, "only these codes are defined", "give 0 or 1");
  }
  /// Requires whole numbers from 0 to the upper end of the parameter's range: bus numbers, 0 for none.
  void require_numbers(std::initializer_list<int> list) const {
    for (const int i : list) {
      const double high = parameters_[static_cast<std::size_t>(i)].high;
      refuse(!(p_[i] >= 0 && p_[i] <= high && p_[i] == std::floor(p_[i])), i, "there is no such number",
             fmt::format("give 0 to {:.0f}", high));
    }
  }
  void require_finite(std::initializer_list<int> list) const {
    for (const int i : list) refuse(!(p_[i] - p_[i] == 0), i, "it must be finite", "give a number");
  }
  /// Requires p[high] > p[low].
  void require_above(int high, int low, std::string_view why = "the range must not be empty") const {
    refuse(!(p_[high] > p_[low]), text(high, low), why,
           fmt::format("give {} > {}", symbol(high), symbol(low)));
  }
  /// Requires p[high] >= p[low] of each pair.
  void require_ranges(std::initializer_list<std::pair<int, int>> pairs) const {
    for (const auto& [high, low] : pairs)
      refuse(!(p_[high] >= p_[low]), text(high, low), "the limits cross",
             fmt::format("give {} >= {}", symbol(high), symbol(low)));
  }
  /// Applies the common rule for a time constant of zero. A lag or lead-lag with T = 0 passes its input
  /// (sim/core/blocks.hpp). Any other block, such as a washout or a rate feedback, requires T > 0 if it acts.
  /// A block with zero gain or an unused output is off and requires only T >= 0. Its state then keeps the
  /// steady value, because prepare() takes inverse(T), which is 0 for T = 0. `off`: condition that switches
  /// the block off ("KF = 0").
  void require_time(int i, bool acts, std::string_view off) const {
    if (!acts) return require_times({i});
    refuse(!(p_[i] > 0), i, divides(),
           fmt::format("give {} > 0, or {}, which switches the block off", symbol(i), off));
  }

 private:
  std::string_view model_;
  std::span<const Parameter> parameters_;
  const double* p_;
  const std::string& where_;
  Problems& problems_;
};

}  // namespace swingbank::sim::effects::shared
