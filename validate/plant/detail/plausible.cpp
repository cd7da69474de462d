#include "validate/plant/detail/plausible.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "sim/plant/usual.hpp"

namespace swingbank::validate::plant {
namespace {

/// Typical values of large machines on their own base (Kundur 1994, tables 3.2 and 4.2): medians of inertia h
/// [s] and reactance x [pu], and bounds of their product [s pu]. The product does not depend on the base.
struct Typical {
  double h, x, least, most;
};
constexpr Typical kSynchronous = {4.0, 1.6, 0.6, 40.0}, kTransient = {4.0, 0.3, 0.12, 8.0};
/// Ratios of the probable to the stated base from which the data count as being on another base. kFar: beyond
/// the variation among machines. kFarForOne: few machines reach it, so it suffices if one of the values is
/// unusual by itself.
constexpr double kFar = 3.0, kFarForOne = 2.0;

/// Returns the ratio of the machine's probable base to that of the data; empty if the data are plausible.
std::optional<double> ratio_of_bases(const Typical& typical, double h, double x, double far) {
  if (!(h > 0 && x > 0) || h * x < typical.least || h * x > typical.most) return {};
  const double ratio = std::sqrt(h / x * typical.x / typical.h);
  if (ratio < far && ratio > 1 / far) return {};
  return ratio;
}

std::optional<double> value_of(const sim::plant::Block& block, std::string_view parameter) {
  const int at = block.effect->parameter_index(parameter);
  if (at < 0 || static_cast<std::size_t>(at) >= block.p.size()) return {};
  return block.p[static_cast<std::size_t>(at)];
}

}  // namespace

std::optional<ForeignBase> foreign_base(const sim::plant::Block& machine, double base_mva) {
  if (!machine.effect || machine.effect->converter) return {};
  const auto h = value_of(machine, "H");
  const bool subsynchronous = !value_of(machine, "Xd");
  const char* reactance = subsynchronous ? "Xdp" : "Xd";
  const auto x = value_of(machine, reactance);
  if (!h || !x) return {};
  const double far = sim::plant::unusual(machine).empty() ? kFar : kFarForOne;
  const auto ratio = ratio_of_bases(subsynchronous ? kTransient : kSynchronous, *h, *x, far);
  if (!ratio) return {};
  const double likely = *ratio * base_mva, unit = std::pow(10.0, std::floor(std::log10(likely)) - 1);
  const double mva = std::round(likely / unit) * unit;
  return ForeignBase{
      fmt::format("H = {:g} s and {} = {:g} pu", *h, reactance, *x),
      fmt::format("on a base of {:g} MVA, these values describe a machine of about {:g} MVA; they are "
                  "probably on another base",
                  base_mva, mva),
      fmt::format("set base_mva to the machine's rating (about {0:g} MVA) and convert the values to it: "
                  "divide H, and multiply reactances and resistances, by {1:.3g}",
                  mva, mva / base_mva)};
}

}  // namespace swingbank::validate::plant
