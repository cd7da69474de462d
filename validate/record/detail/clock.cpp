#include "validate/record/detail/clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace swingbank::validate::record {
namespace {

constexpr double kDay = 86400;

/// Clock that counts from a known date.
struct Clock {
  double from, until;  ///< range of values: 1985 (ns: 1992) to 2128 for ticks, 1982 to 2100 for days
  Unit unit;
  double origin;  ///< count at 1970-01-01 [days]
  std::string_view what;
};
constexpr Clock kDays[] = {
    {30000, 73051, Unit::day, 25569, "days since 1899-12-30, as spreadsheets count them"},
    {723911, 767011, Unit::day, 719529, "days since year 0, as MATLAB counts them"},
};
constexpr Clock kUnix[] = {
    {5e8, 5e9, Unit::second, 0, "seconds since 1970"},
    {5e11, 5e12, Unit::millisecond, 0, "milliseconds since 1970"},
    {5e14, 5e15, Unit::microsecond, 0, "microseconds since 1970"},
    {7e17, 5e18, Unit::nanosecond, 0, "nanoseconds since 1970"},
};

/// Returns the 10 % quantile of the positive steps; NaN if there are none. A higher quantile may be a long
/// step of a simulation with variable steps.
double usual_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t k = 0; k + 1 < t.size(); ++k)
    if (t[k + 1] > t[k]) steps.push_back(t[k + 1] - t[k]);
  if (steps.empty()) return kNoValue;
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 10);
  std::ranges::nth_element(steps, at);
  return *at;
}

template <class Clocks>
const Clock* clock_of(const Clocks& clocks, double first) {
  const auto* found =
      std::ranges::find_if(clocks, [&](const Clock& c) { return first >= c.from && first < c.until; });
  return found == std::end(clocks) ? nullptr : found;
}

/// Converts days to seconds from the day `first`.
void count_days(RawRecord& raw, RawColumn& time, double first, const Clock& clock) {
  for (double& v : time.values) v = (v - first) * kDay;
  raw.time_resolution *= kDay;
  time.meaning.unit = Unit::second;
  std::string start = utc_text((first - clock.origin) * kDay);
  start.pop_back();  // the zone is unknown
  start[start.find('T')] = ' ';
  raw.about.start = start;
  raw.about.notes.push_back(
      fmt::format("The times of '{}' are {}: t = 0 is {} (zone not known).", time.name, clock.what, start));
}

}  // namespace

void settle_clock(RawRecord& raw) {
  constexpr double kMostOfASample =
      1.2e-5;  // [days] = 1 s; times in the range of kDays with longer steps are seconds
  RawColumn& time = time_column(raw);
  auto& unit = time.meaning.unit;
  if (unit && unit != Unit::day) return;
  const auto at = std::ranges::find_if(time.values, [](double v) { return std::isfinite(v); });
  const double first = at == time.values.end() ? 0 : *at;
  const double step = usual_step(time.values);
  if (const Clock* days = clock_of(kDays, first); days && (unit || !(step > kMostOfASample)))
    return count_days(raw, time, first, *days);
  if (unit) return;
  const Clock* clock = clock_of(kUnix, first);
  unit = clock ? clock->unit : Unit::second;
  raw.about.notes.push_back(fmt::format("The column '{}' names no unit: it was interpreted as {}.", time.name,
                                        clock ? clock->what : "seconds"));
}

bool check_clock(const std::vector<double>& t, const ColumnMeaning& time, const ReadOptions& options,
                 const std::string& file, Problems& problems) {
  constexpr double kSlowest = 0.55, kSlowestGovernor = 5.5;  // [s]: 2 samples/s, or 1 in 5 s for governors
  constexpr double kShortestHere = 0.5;                      // [s], length of a record
  const auto plausible = [](double step) { return step > 1e-4 && step < 0.2; };
  const double step = usual_step(t);
  if (!(step > 0)) return false;
  // If most samples have the time of their predecessor, times were rounded or the clock stopped, which
  // settle_rows reports. The remaining steps are then not sample intervals.
  std::size_t repeated = 0;
  for (std::size_t k = 1; k < t.size(); ++k) repeated += t[k] == t[k - 1];
  if (2 * repeated > t.size()) return false;
  if (step > (options.component == Component::governor ? kSlowestGovernor : kSlowest)) {
    struct Smaller {
      double factor;
      std::string_view name, column;
    };
    constexpr std::array<Smaller, 3> smaller = {
        {{1e-3, "ms", "t_ms"}, {1e-6, "microseconds", "t_us"}, {1e-9, "nanoseconds", "t_ns"}}};
    const auto* other = step < 2 ? smaller.end() : std::ranges::find_if(smaller, [&](const Smaller& s) {
      return plausible(step * s.factor);
    });
    if (other != smaller.end() && time.unit == Unit::second)
      problems.add(
          fmt::format("time steps of {:.4g} s", step), file,
          fmt::format("no swing is visible at {:.3g} samples/s; with times in {} the rate would be {:.4g} "
                      "samples/s",
                      1 / step, other->name, 1 / (step * other->factor)),
          fmt::format("are the times in {}? Name the column {}, or say so: --columns \"t=NAME [{}]\"",
                      other->name, other->column, other->column.substr(2)));
    else
      problems.add(
          fmt::format("{:.3g} samples/s", 1 / step), file, "a swing of 1 Hz needs at least 10 samples/s",
          "give the record of a phasor measurement unit or fault recorder, at 10 to 120 samples/s, or "
          "check the unit of the times");
    return true;
  }
  const double length = t.back() - t.front();
  const bool small =
      time.unit == Unit::millisecond || time.unit == Unit::microsecond || time.unit == Unit::nanosecond;
  if (!small || !(length < kShortestHere)) return false;
  const double factor = time.unit == Unit::millisecond ? 1e3 : time.unit == Unit::microsecond ? 1e6 : 1e9;
  if (!plausible(step * factor)) return false;
  problems.add(fmt::format("{:.3g} s", length), file,
               fmt::format("the record is too short; with times in s the rate would be {:.4g} samples/s",
                           1 / (step * factor)),
               "are the times in s? Name the column t_s; otherwise give a longer record");
  return true;
}

}  // namespace swingbank::validate::record
