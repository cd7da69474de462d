#include "validate/record/detail/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace swingbank::validate::record {
namespace {

/// Samples first .. last are lost.
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

/// Whether the voltage changes over the gap by more than its steps on both sides let expect.
bool jumps_in(const Record& r, const Gap& gap) {
  constexpr double kJump = 0.02;  // pu, what is taken for a switching elsewhere too
  const auto v = [&](std::size_t k) { return std::polar(r.V[k], r.theta.empty() ? 0.0 : r.theta[k]); };
  const std::size_t p = gap.first - 1, q = gap.last + 1;
  const std::complex<double> before = p > 0 ? v(p) - v(p - 1) : 0.0,
                             after = q + 1 < r.t.size() ? v(q + 1) - v(q) : 0.0;
  const double steps = static_cast<double>(q - p);
  return std::abs(v(q) - v(p) - steps * (before + after) / 2.0) >
         kJump + steps * std::abs(before - after) / 2;
}

/// Cubic through both ends with the slopes of the steps beside them.
void smooth(std::vector<double>& y, const Gap& gap) {
  const std::size_t p = gap.first - 1, q = gap.last + 1;
  const double steps = static_cast<double>(q - p), straight = y[q] - y[p];
  const double before = p > 0 ? (y[p] - y[p - 1]) * steps : straight;
  const double after = q + 1 < y.size() && std::isfinite(y[q + 1]) ? (y[q + 1] - y[q]) * steps : straight;
  for (std::size_t k = gap.first; k <= gap.last; ++k) {
    const double s = static_cast<double>(k - p) / steps, u = 1 - s;
    y[k] = y[p] * u * u * (1 + 2 * s) + y[q] * s * s * (1 + 2 * u) + before * s * u * u - after * s * s * u;
  }
}
void hold(std::vector<double>& y, const Gap& gap) {
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
        fmt::format("{} samples at the record's ends are without values and were left off.", cut));
  if (gaps.empty()) return true;
  std::size_t all = 0;
  for (const Gap& g : gaps) all += g.samples();
  about.notes.push_back(fmt::format(
      "{} of {} frames are missing, in {} {}, the longest of {:.3g} s at t = {:.4g} s: the voltage is bridged there, "
      "and these samples are not compared.",
      all, rows.place.size(), gaps.size(), gaps.size() == 1 ? "place" : "places",
      static_cast<double>(longest.samples()) * h, rows.t[std::min(longest.first, rows.t.size() - 1)]));
  return true;
}

void bridge(Record& r) {
  for (const Gap& gap : gaps_of(r.lost.size(), [&](std::size_t k) { return r.lost[k] != 0; })) {
    const bool jump = !r.V.empty() && jumps_in(r, gap);
    if (jump)
      r.notes.push_back(fmt::format(
          "The voltage jumps where frames are missing, between t = {:.4f} and {:.4f} s: the instant is known no better.",
          r.t[gap.first - 1], r.t[gap.last + 1]));
    for (auto* y : {&r.V, &r.theta})
      if (!y->empty()) (jump ? hold : smooth)(*y, gap);
    for (auto* y : {&r.P, &r.Q, &r.f, &r.speed, &r.Efd, &r.Ifd, &r.Vs, &r.Vref, &r.Pm, &r.Pref, &r.gate})
      if (!y->empty()) straight(*y, gap);
  }
}

}  // namespace swingbank::validate::record
