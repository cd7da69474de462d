#include "validate/record/detail/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/median.hpp"

namespace swingbank::validate::record {
namespace {

/// Returns the columns that are all zero in a lost frame. Empty if the record has no voltage, or neither
/// power nor current, because zeros are then not conclusive.
std::vector<RawColumn*> phasors_of(RawRecord& raw) {
  std::vector<RawColumn*> all;
  bool power = false, voltage = false;
  for (RawColumn& c : raw.columns) {
    const Quantity q = c.meaning.quantity;
    voltage = voltage || q == Quantity::V;
    power = power || q == Quantity::P || q == Quantity::Q || q == Quantity::I;
    for (const auto one :
         {Quantity::V, Quantity::theta, Quantity::P, Quantity::Q, Quantity::I, Quantity::phi})
      if (q == one) all.push_back(&c);
  }
  if (!voltage || !power) all.clear();
  return all;
}

/// Returns whether V and the power at row `after` equal those at row `before`, within 0.02 pu and 5 % of the
/// power. The tolerance is larger if V or the power moved before the gap: 1.5 times their movement over as
/// many rows as the gap has.
bool goes_on(const RawRecord& raw, std::size_t before, std::size_t after) {
  constexpr double kVoltageGoesOn = 0.02, kPowerGoesOn = 0.05;
  const auto moved = [&](const RawColumn& c) {
    const std::size_t n = std::min(before, after - before);
    double most = 0;
    for (std::size_t k = before - n; k < before; ++k)
      if (std::isfinite(c.values[k])) most = std::max(most, std::abs(c.values[k] - c.values[before]));
    return most;
  };
  double power = 0;
  for (const auto q : {Quantity::P, Quantity::Q, Quantity::I})
    if (const auto* c = find_column(raw, q)) power = std::max(power, std::abs(c->values[before]));
  for (const auto q : {Quantity::V, Quantity::P, Quantity::Q, Quantity::I})
    if (const auto* c = find_column(raw, q)) {
      const double limit =
          std::max(q == Quantity::V ? kVoltageGoesOn : kPowerGoesOn * power, 1.5 * moved(*c));
      if (!(std::abs(c->values[after] - c->values[before]) <= limit)) return false;
    }
  return true;
}

}  // namespace

bool same_rows(const RawRecord& raw, std::size_t a, std::size_t b) {
  return std::ranges::all_of(raw.columns, [&](const RawColumn& c) {
    const double x = c.values[a], y = c.values[b];
    return c.meaning.quantity == Quantity::time || x == y || (!std::isfinite(x) && !std::isfinite(y));
  });
}

void drop_repeats(RawRecord& raw, SampleFaults& faults) {
  const std::vector<double>& t = time_column(raw).values;
  if (t.size() < 3 || !std::ranges::all_of(t, [](double v) { return std::isfinite(v); })) return;
  std::vector<double> steps;
  for (std::size_t k = 0; k + 1 < t.size(); ++k) steps.push_back(t[k + 1] - t[k]);
  const double usual = upper_median(std::move(steps));
  if (!(usual > 0)) return;
  std::vector<std::size_t> kept;
  std::size_t dropped = 0, first = 0;
  // Returns whether a kept row has the same time and values.
  const auto repeats = [&](std::size_t k) {
    const auto at =
        std::ranges::lower_bound(kept, t[k] - 0.1 * usual, {}, [&](std::size_t i) { return t[i]; });
    return at != kept.end() && std::abs(t[*at] - t[k]) <= 0.1 * usual && same_rows(raw, *at, k);
  };
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (!kept.empty() && t[k] < t[kept.back()] - 0.5 * usual) {
      std::size_t end = k;
      while (end < t.size() && t[end] <= t[kept.back()] + 0.1 * usual && repeats(end)) ++end;
      // Equal rows are not conclusive: a clock may have been set back while the signals were constant.
      bool varied = end == k + 1;
      for (std::size_t i = k; i + 1 < end; ++i) varied = varied || !same_rows(raw, i, i + 1);
      const bool whole = end == t.size() || t[end] > t[kept.back()] + 0.1 * usual;
      if (!whole || !varied || end == k) return;
      if (dropped == 0) first = k;
      dropped += end - k;
      k = end - 1;
      continue;
    }
    kept.push_back(k);
  }
  if (dropped == 0) return;
  raw.about.notes.push_back(
      fmt::format("{} rows repeat the times and values of earlier rows, the first at {}: ignored.", dropped,
                  faults.where(first)));
  for (RawColumn& c : raw.columns) {
    std::vector<double> values;
    for (const std::size_t k : kept) values.push_back(c.values[k]);
    c.values = std::move(values);
  }
  faults.keep_rows(std::move(kept));
}

void lose_zero_frames(RawRecord& raw, SampleFaults& faults) {
  const std::vector<RawColumn*> phasors = phasors_of(raw);
  if (phasors.empty()) return;
  const std::size_t n = phasors.front()->values.size();
  const auto zero = [&](std::size_t k) {
    return std::ranges::all_of(phasors, [&](const RawColumn* c) { return c->values[k] == 0; });
  };
  const auto measured = [&](std::size_t k) {
    return std::ranges::all_of(phasors, [&](const RawColumn* c) { return std::isfinite(c->values[k]); });
  };
  std::size_t lost = 0, first = 0, kept = 0, first_kept = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (!zero(k)) continue;
    std::size_t end = k;
    while (end < n && (zero(end) || !measured(end))) ++end;
    std::size_t before = k;
    while (before > 0 && !measured(--before)) {
    }
    const bool inside = k > 0 && end < n && measured(before);
    const auto zeros = static_cast<std::size_t>(std::count_if(
        phasors.front()->values.begin() + static_cast<std::ptrdiff_t>(k),
        phasors.front()->values.begin() + static_cast<std::ptrdiff_t>(end), [](double v) { return v == 0; }));
    if (inside && !goes_on(raw, before, end)) {
      if (kept == 0) first_kept = k;
      kept += zeros;
    } else {
      if (lost == 0) first = k;
      lost += zeros;
      for (std::size_t i = k; i < end; ++i)
        if (zero(i))
          for (RawColumn* c : phasors) {
            faults.lose(c->name, fmt::format("{} = 0", c->name), i,
                        "voltage, power and angle are all exactly zero, which is not a measurement",
                        "fill the gap at the source, or end the record before it (--until)");
            c->values[i] = kNoValue;
          }
    }
    k = end;
  }
  const auto note = [&](std::size_t count, std::size_t row, const char* what) {
    if (count > 0)
      raw.about.notes.push_back(
          fmt::format("{} {} exactly zero in voltage, power and angle, the first at {}: {}.", count,
                      count == 1 ? "sample is" : "samples are", faults.where(row), what));
  };
  note(lost, first, "these samples are treated as missing");
  note(kept, first_kept,
       "V, P and Q differ before and after, so these samples are treated as a fault at the terminals");
}

}  // namespace swingbank::validate::record
