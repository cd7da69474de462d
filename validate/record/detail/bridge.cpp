#include "validate/record/detail/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "validate/record/detail/across.hpp"

namespace swingbank::validate::record {
namespace {

/// Lost samples first .. last, both included.
struct Gap {
  std::size_t first, last;
  [[nodiscard]] std::size_t samples() const { return last - first + 1; }
};
template <class Lost>
std::vector<Gap> gaps_of(std::size_t n, Lost lost) {
  std::vector<Gap> gaps;
  for (std::size_t k = 0; k < n; ++k) {
    if (!lost(k)) continue;
    if (!gaps.empty() && gaps.back().last + 1 == k)
      gaps.back().last = k;
    else
      gaps.push_back({k, k});
  }
  return gaps;
}

constexpr double kStepThreshold = 0.02;  // [pu], [rad]; also used for the detection of switchings

constexpr std::size_t kReach = 8;  // samples on each side; at 30 samples/s about a third of a swing's period

/// Returns the samples around a gap that are used for interpolation, up to the next gap or step. A step is
/// detected by the third difference, which suppresses a swing but not a step.
std::vector<std::size_t> beside(const Record& r, const Gap& gap) {
  const auto v = [&](std::size_t k) { return std::polar(r.V[k], r.theta.empty() ? 0.0 : r.theta[k]); };
  const auto walk = [&](std::size_t from, std::ptrdiff_t out, std::size_t available) {
    const auto at = [&](std::ptrdiff_t i) { return v(from + static_cast<std::size_t>(out * i)); };
    std::vector<std::size_t> side = {from};
    for (std::ptrdiff_t i = 1; side.size() < kReach && side.size() < available; ++i) {
      const auto k = from + static_cast<std::size_t>(out * i);
      if (r.lost[k]) break;
      if (side.size() + 2 < available &&
          !(std::abs(at(i - 1) - 3.0 * at(i) + 3.0 * at(i + 1) - at(i + 2)) < kStepThreshold))
        break;
      side.push_back(k);
    }
    return side;
  };
  std::vector<std::size_t> all = walk(gap.first - 1, -1, gap.first);
  const std::vector<std::size_t> after = walk(gap.last + 1, 1, r.t.size() - gap.last - 1);
  all.insert(all.end(), after.begin(), after.end());
  return all;
}

/// Interpolates one channel across the gap from the samples `neighbours`.
Across interpolate(const std::vector<double>& y, const Gap& gap, const std::vector<std::size_t>& neighbours) {
  const auto place = [&](std::size_t k) {
    return (static_cast<double>(k) - static_cast<double>(gap.first + gap.last) / 2) /
           static_cast<double>(kReach);
  };
  std::vector<double> at, value, inside;
  for (const std::size_t k : neighbours) at.push_back(place(k)), value.push_back(y[k]);
  for (std::size_t k = gap.first; k <= gap.last; ++k) inside.push_back(place(k));
  return across(at, value, inside);
}
/// Returns whether the voltage has a step in the gap. With fewer than kMinAcross neighbours, the change over
/// the gap is compared with the changes just before and after it.
bool steps_within(const Record& r, const Gap& gap, const std::vector<std::size_t>& neighbours) {
  if (neighbours.size() >= kMinAcross)
    return std::abs(interpolate(r.V, gap, neighbours).step) > kStepThreshold ||
           (!r.theta.empty() && std::abs(interpolate(r.theta, gap, neighbours).step) > kStepThreshold);
  const auto v = [&](std::size_t k) { return std::polar(r.V[k], r.theta.empty() ? 0.0 : r.theta[k]); };
  const std::size_t p = gap.first - 1, q = gap.last + 1;
  const std::complex<double> before = p > 0 ? v(p) - v(p - 1) : 0.0,
                             after = q + 1 < r.t.size() ? v(q + 1) - v(q) : 0.0;
  const double steps = static_cast<double>(q - p);
  return std::abs(v(q) - v(p) - steps * (before + after) / 2.0) >
         kStepThreshold + steps * std::abs(before - after) / 2;
}
void smooth(std::vector<double>& y, const Gap& gap, const std::vector<std::size_t>& neighbours) {
  std::ranges::copy(interpolate(y, gap, neighbours).inside,
                    y.begin() + static_cast<std::ptrdiff_t>(gap.first));
}
void fill_nearest(std::vector<double>& y, const Gap& gap) {
  const std::size_t p = gap.first - 1, q = gap.last + 1;
  for (std::size_t k = gap.first; k <= gap.last; ++k) y[k] = 2 * k < p + q ? y[p] : y[q];
}
void straight(std::vector<double>& y, const Gap& gap) {
  const std::size_t p = gap.first - 1, q = gap.last + 1;
  for (std::size_t k = gap.first; k <= gap.last; ++k)
    y[k] = y[p] + (y[q] - y[p]) * static_cast<double>(k - p) / static_cast<double>(q - p);
}

}  // namespace

bool gaps_are_short(EvenRows& rows, Record& about) {
  const auto lost = [&](std::size_t k) { return !std::isfinite(rows.place[k]); };
  const double h =
      rows.t.size() > 1 ? (rows.t.back() - rows.t.front()) / static_cast<double>(rows.t.size() - 1) : 0;
  std::vector<Gap> gaps = gaps_of(rows.place.size(), lost);
  if (gaps.empty()) return true;
  const Gap longest = *std::ranges::max_element(gaps, {}, &Gap::samples);
  if (static_cast<double>(longest.samples()) * h > kLongestGap * (1 + 1e-6)) return false;
  std::size_t cut = 0;
  if (gaps.back().last + 1 == rows.place.size()) {
    cut += gaps.back().samples();
    rows.place.resize(gaps.back().first);
    rows.t.resize(gaps.back().first);
    gaps.pop_back();
  }
  if (!gaps.empty() && gaps.front().first == 0) {
    const auto n = static_cast<std::ptrdiff_t>(gaps.front().samples());
    cut += gaps.front().samples();
    rows.place.erase(rows.place.begin(), rows.place.begin() + n);
    rows.t.erase(rows.t.begin(), rows.t.begin() + n);
    gaps.erase(gaps.begin());
  }
  if (cut > 0)
    about.notes.push_back(
        fmt::format("{} samples without values at the ends of the record were removed.", cut));
  if (gaps.empty()) return true;
  std::size_t all = 0;
  for (const Gap& g : gaps) all += g.samples();
  about.notes.push_back(fmt::format(
      "{} of {} samples {} missing ({} {}; longest {:.3g} s, at t = {:.4g} s). The voltage is interpolated there; P and Q "
      "are not compared.",
      all, rows.place.size(), all == 1 ? "is" : "are", gaps.size(), gaps.size() == 1 ? "gap" : "gaps",
      static_cast<double>(longest.samples()) * h, rows.t[std::min(longest.first, rows.t.size() - 1)]));
  return true;
}

void bridge(Record& r) {
  for (const Gap& gap : gaps_of(r.lost.size(), [&](std::size_t k) { return r.lost[k] != 0; })) {
    const auto neighbours = r.V.empty() ? std::vector<std::size_t>() : beside(r, gap);
    const bool stepped = !r.V.empty() && steps_within(r, gap, neighbours);
    if (stepped)
      r.notes.push_back(
          fmt::format("The voltage has a step in a gap, between t = {:.4f} and {:.4f} s; the gap is the "
                      "uncertainty of the switching time.",
                      r.t[gap.first - 1], r.t[gap.last + 1]));
    const bool bends = !stepped && neighbours.size() >= kMinAcross;
    for (auto* y : {&r.V, &r.theta, &r.f, &r.speed, &r.P, &r.Q}) {
      if (y->empty()) continue;
      if (bends)
        smooth(*y, gap, neighbours);
      else if (stepped && (y == &r.V || y == &r.theta))
        fill_nearest(*y, gap);
      else
        straight(*y, gap);
    }
    for (auto* y : {&r.Efd, &r.Ifd, &r.Vs, &r.Vref, &r.Pm, &r.Pref, &r.gate})
      if (!y->empty()) straight(*y, gap);
  }
}

}  // namespace swingbank::validate::record
