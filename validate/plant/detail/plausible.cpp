#include "validate/plant/detail/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swingbank::validate::plant {
namespace {

/// Of large machines, on their own base (Kundur 1994, tables 3.2 and 4.2): the middle, and the bounds of the
/// product of inertia [s] and reactance [pu], which no base changes.
struct Typical {
  double h, x, least, most;
};
constexpr Typical kSynchronous = {4.0, 1.6, 0.6, 40.0}, kTransient = {4.0, 0.3, 0.12, 8.0};
/// A factor between bases that no spread of machines explains, and that few machines do.
constexpr double kFar = 3.0, kFarForOne = 2.0;

/// 99, 999, 9999.0, ...: what people write for "none".
bool stands_for_none(double value) {
  double nines = 99.0;
  for (int digits = 2; digits < 8; ++digits, nines = 10 * nines + 9)
    if (std::abs(value) == nines) return true;
  return false;
}

}  // namespace

std::optional<ForeignBase> foreign_base(const std::string& reactance, double h, double x, double base_mva,
                                        bool sound) {
  const Typical& typical = reactance == "Xd" ? kSynchronous : kTransient;
  if (!(h > 0 && x > 0) || h * x < typical.least || h * x > typical.most) return {};
  const double ratio = std::sqrt(h / x * typical.x / typical.h);
  const double far = sound ? kFar : kFarForOne;
  if (ratio < far && ratio > 1 / far) return {};
  const double mva = ratio * base_mva, unit = std::pow(10.0, std::floor(std::log10(mva)) - 1);
  return ForeignBase{fmt::format("H = {:g} s and {} = {:g} pu", h, reactance, x),
                     std::round(mva / unit) * unit, ratio};
}

std::vector<std::string> settle_unlimited(sim::plant::Block& block) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < block.p.size(); ++i) {
    const sim::Parameter& p = block.effect->parameters[i];
    const double given = block.p[i];
    if ((given >= p.low && given <= p.high) || !stands_for_none(given)) continue;
    block.p[i] = std::clamp(given, p.low, p.high);
    notes.push_back(fmt::format("{}.{} = {:g} stands for no limit: taken as {:g} {}", block.effect->name,
                                p.name, given, block.p[i], p.unit));
  }
  return notes;
}

}  // namespace swingbank::validate::plant
