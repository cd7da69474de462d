#include "validate/record/detail/times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "base/median.hpp"

namespace swingbank::validate::record {
namespace {

std::vector<double> steps_of(const std::vector<double>& t) {
  std::vector<double> steps(t.size() - 1);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) steps[k] = t[k + 1] - t[k];
  return steps;
}

/// Maximum length of a record including missing samples: more than an hour at 480 samples/s. A longer record
/// contains an invalid time.
constexpr std::size_t kMostSamples = 2'000'000;

/// Coarsest rounding of times at which a lost frame is recognised, as a fraction of the sample interval.
constexpr double kCoarsest = 0.75;

/// Largest backward step to a row off the grid, as a fraction of the sample interval.
constexpr double kFarBack = 0.98;

/// Maximum number of consecutive rows at one time, and maximum share of repeated rows. A simulation writes a
/// time two or three times at a switching; more repetitions indicate a stopped clock.
constexpr std::size_t kMostAtOneTime = 3;
constexpr double kMostRepeated = 0.05;

bool is_even(const std::vector<double>& t) {
  const std::vector<double> steps = steps_of(t);
  const double usual = upper_median(steps);
  return usual > 0 &&
         std::ranges::all_of(steps, [&](double s) { return std::abs(s - usual) <= 0.01 * usual; });
}

/// Replaces times rounded to `resolution` by a uniform grid, if all of them fit one.
bool snap(std::vector<double>& t, double resolution, Record& about) {
  const auto last = static_cast<double>(t.size() - 1);
  double h = (t.back() - t.front()) / last;
  if (!(h > 0) || !(resolution <= kCoarsest * h)) return false;
  // Instruments take a whole number of samples per second; the end points alone determine h too inaccurately.
  const double rate = std::round(1 / h);
  if (rate >= 1 && std::abs(rate * h - 1) <= 2 * resolution / (t.back() - t.front())) h = 1 / rate;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const double off = t[k] - static_cast<double>(k) * h;
    low = std::min(low, off);
    high = std::max(high, off);
  }
  if (!(high - low <= 1.05 * resolution)) return false;
  const double first = (low + high) / 2;
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = first + static_cast<double>(k) * h;
  about.notes.push_back(fmt::format(
      "Times are rounded to {:.3g} ms in the file; uniform sampling at {:.6g} samples/s was assumed.",
      1e3 * resolution, 1 / h));
  return true;
}

/// Corrects at most three adjustments of a clock between continuous samples: set back by up to 1.5 s, or
/// changed by a multiple of half an hour. Possible gaps and rows out of order are left unchanged.
void unleap(std::vector<double>& t, const SampleFaults& faults, std::vector<std::string>& notes) {
  constexpr double kSeconds = 1.5, kHalfHour = 1800;
  const std::vector<double> steps = steps_of(t);
  const double usual = upper_median(steps);
  if (!(usual > 0) || t.size() < 8) return;
  const auto usual_at = [&](std::size_t k) {
    return k >= steps.size() || (steps[k] > 0 && steps[k] < 1.8 * usual);
  };
  double shift = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const double leap = steps[k] - usual, halves = std::round(leap / kHalfHour);
    const bool back = leap < -1.5 * usual && -leap < kSeconds + usual;
    const bool hour = halves != 0 && std::abs(leap - halves * kHalfHour) < 2 * usual;
    if ((back || hour) && k > 0 && usual_at(k - 1) && usual_at(k + 1) && notes.size() < 3) {
      notes.push_back(
          fmt::format("At {} the clock was set {} by {:.6g} s; the samples were assumed evenly spaced.",
                      faults.where(k + 1), leap < 0 ? "back" : "forward", std::abs(leap)));
      shift -= leap;
    }
    t[k + 1] += shift;
  }
}

/// Returns the candidate steps of the grid [s].
std::vector<double> possible_steps(const std::vector<double>& t, double resolution) {
  const double usual = upper_median(steps_of(t)), length = t.back() - t.front();
  if (!(length > 0)) return {};
  std::vector<double> all;
  if (usual > 0 && resolution <= 0.15 * usual) {
    const double rate = std::round(1 / usual);
    if (rate >= 1 && std::abs(rate * usual - 1) < 0.02) all.push_back(1 / rate);
    all.push_back(usual);
    return all;
  }
  const double least = static_cast<double>(t.size() - 1) / length;
  for (double rate = std::max(1.0, std::ceil(0.98 * least)); rate <= 1.25 * least + 1; ++rate)
    if (resolution <= kCoarsest / rate) all.push_back(1 / rate);
  return all;
}

/// Assignment of rows to a grid with a given step, with gaps at missing frames.
class Grid {
 public:
  Grid(const Rows& rows, const std::vector<double>& t, double step) : rows_(rows), t_(t), h_(step) {}

  /// Returns the rows on a grid that starts at `first_row`, without earlier rows; none if they do not fit a
  /// grid.
  std::optional<EvenRows> fit(std::size_t first_row, Record& about, SampleFaults& faults) {
    if (!count(first_row)) return std::nullopt;
    const auto last = static_cast<double>(index_.back());
    if (!coarse()) h_ = (t_[row_.back()] - t_[row_.front()]) / last;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (moved_[i]) continue;
      const double off = t_[row_[i]] - static_cast<double>(index_[i]) * h_;
      low = std::min(low, off), high = std::max(high, off);
    }
    if (!(high - low <= 1.05 * rows_.resolution + (coarse() ? 0.02 : 0.2) * h_)) return std::nullopt;
    add_notes(about, faults);
    EvenRows even;
    const double first = coarse() ? (low + high) / 2 : t_[row_.front()];
    even.place.assign(index_.back() + 1, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < row_.size(); ++i) even.place[index_[i]] = static_cast<double>(row_[i]);
    for (std::size_t g = 0; g < even.place.size(); ++g) even.t.push_back(first + static_cast<double>(g) * h_);
    return even;
  }

 private:
  [[nodiscard]] bool coarse() const { return rows_.resolution > 0.15 * h_; }

  /// Leaves out a row off the grid. Returns false after more than two rows and more than 1 % of all rows.
  [[nodiscard]] bool leave_out(std::size_t row) {
    off_.push_back(row);
    return off_.size() <= std::max<std::size_t>(2, t_.size() / 100);
  }

  /// Assigns the rows to grid points. Returns false if they do not fit a grid with this step.
  bool count(std::size_t first) {
    row_ = {first}, index_ = {0}, moved_ = {0};
    for (std::size_t k = 0; k < first; ++k)
      if (!leave_out(k)) return false;
    double before = t_[first];
    for (std::size_t k = first + 1; k < t_.size(); ++k) {
      double dt = t_[k] - before;
      bool moved = false;
      if (!coarse() && std::abs(dt) < 0.02 * h_) {
        if (rows_.same(row_.back(), k)) {
          twice_.push_back(k);
          continue;
        }
        if (k + 1 < t_.size() && std::abs(t_[k + 1] - t_[k] - 2 * h_) > 0.1 * h_) {
          if (!leave_out(k)) return false;
          continue;
        }
        moved = true;
        stuck_.push_back(k);
        dt = h_;
      }
      const double steps = std::max(std::round(dt / h_), coarse() && dt > -rows_.resolution ? 1.0 : 0.0);
      const double slack = coarse() ? 1.05 * rows_.resolution + 0.02 * h_ : 0.1 * h_ + 2.1 * rows_.resolution;
      if (!(std::abs(dt) < static_cast<double>(kMostSamples) * h_)) return false;
      if (steps < 1 || std::abs(dt - steps * h_) > slack) {
        if (dt > -kFarBack * h_ && leave_out(k)) continue;
        return false;
      }
      index_.push_back(index_.back() + static_cast<std::size_t>(steps));
      if (index_.back() >= kMostSamples) return false;
      row_.push_back(k);
      moved_.push_back(moved);
      before = moved ? before + h_ : t_[k];
    }
    return row_.size() > 1;
  }

  void add_notes(Record& about, SampleFaults& faults) const {
    const auto rate = 1 / h_;
    if (!twice_.empty())
      about.notes.push_back(
          fmt::format("{} rows repeat time stamp and values of the row before, the first at {}: ignored.",
                      twice_.size(), faults.where(twice_.front())));
    if (!stuck_.empty())
      about.notes.push_back(fmt::format(
          "{} rows have the time stamp of the row before but other values, the first at {}; their times "
          "were assumed to be one sample later.",
          stuck_.size(), faults.where(stuck_.front())));
    if (!off_.empty())
      about.notes.push_back(fmt::format(
          "{} {} fit the uniform sampling (interval {:.6g} s), the first at {} (t = {:.6g} s): ignored.",
          off_.size(), off_.size() == 1 ? "row does not" : "rows do not", h_, faults.where(off_.front()),
          t_[off_.front()]));
    if (coarse())
      about.notes.push_back(fmt::format(
          "Times are rounded to {:.3g} ms in the file; uniform sampling at {:.6g} samples/s was assumed.",
          1e3 * rows_.resolution, rate));
    for (std::size_t i = 1; i < index_.size(); ++i) {
      const double missing = static_cast<double>(index_[i] - index_[i - 1]) - 1;
      if (missing * h_ > kLongestGap * (1 + 1e-6))
        faults.add("gap", fmt::format("a gap of {:.4g} s", (missing + 1) * h_), row_[i],
                   fmt::format("samples are {:.6g} s apart, so {:.0f} are missing; up to {:g} s are bridged",
                               h_, missing, kLongestGap),
                   "fill the gap at the source, or take the section before or after it (--until, --from); "
                   "if the clock jumped there and nothing is missing, correct the time stamps");
    }
  }

  const Rows& rows_;
  const std::vector<double>& t_;
  double h_;
  std::vector<std::size_t> row_, index_;  ///< rows on the grid, and their grid points
  std::vector<char> moved_;               ///< whether the stamp of each row on the grid was corrected
  std::vector<std::size_t> twice_, stuck_, off_;
};

/// Returns whether more than a fifth of the steps deviate by more than a tenth from the median.
bool differ(const std::vector<double>& steps) {
  const double usual = upper_median(steps);
  const auto off = std::ranges::count_if(steps, [&](double s) { return std::abs(s - usual) > 0.1 * usual; });
  return 5 * static_cast<std::size_t>(off) > steps.size();
}

/// Rows that repeat the time of the row before: number, first one, longest run.
struct RepeatedTimes {
  std::size_t rows = 0, first = 0, longest = 0;
  /// Whether the steps between different times are equal. The steps differ in a simulation with variable
  /// steps, which repeats a time at an event.
  bool even = true;
};
RepeatedTimes repeated_times(const std::vector<double>& t) {
  RepeatedTimes found;
  std::vector<double> apart;
  for (const double step : steps_of(t))
    if (step > 0) apart.push_back(step);
  found.even = apart.empty() || !differ(apart);
  std::size_t run = 0;
  for (std::size_t k = 1; k < t.size(); ++k) {
    run = t[k] == t[k - 1] ? run + 1 : 0;
    if (run > 0 && found.rows++ == 0) found.first = k;
    found.longest = std::max(found.longest, run);
  }
  return found;
}

/// Returns whether the times do not decrease and many steps differ, as in a simulation with variable steps.
bool varies(const std::vector<double>& t) {
  const std::vector<double> steps = steps_of(t);
  return std::ranges::none_of(steps, [](double s) { return s < 0; }) && differ(steps);
}

/// Resamples the rows at uniform times by linear interpolation, as in a playback. None if times decrease or
/// the clock stops.
std::optional<EvenRows> resampled(const Rows& rows, Record& about) {
  constexpr std::array<double, 5> kRates = {30, 60, 120, 240, 480};
  const std::vector<double>& t = rows.t;
  const std::vector<double> steps = steps_of(t);
  const double length = t.back() - t.front();
  if (!(length > 0) || std::ranges::any_of(steps, [](double s) { return s < 0; })) return std::nullopt;
  const RepeatedTimes clock = repeated_times(t);
  if (clock.even && (clock.longest >= kMostAtOneTime ||
                     static_cast<double>(clock.rows) > 2 + kMostRepeated * static_cast<double>(t.size())))
    return std::nullopt;
  const auto apart = static_cast<double>(std::ranges::count_if(steps, [](double s) { return s > 1e-6; }));
  // A repeated time marks a step of the values, which requires a higher rate than slow movements.
  const bool steps_up = std::ranges::any_of(steps, [](double s) { return s < 1e-6; });
  const double least = std::max(apart / length, steps_up ? 120.0 : 0.0);
  const auto* rate = std::ranges::find_if(kRates, [&](double r) { return r >= least; });
  const double h = 1 / (rate == kRates.end() ? kRates.back() : *rate);
  if (length / h >= static_cast<double>(kMostSamples)) return std::nullopt;
  EvenRows even;
  std::size_t k = 0;
  for (std::size_t i = 0; t.front() + static_cast<double>(i) * h <= t.back() + 1e-9; ++i) {
    const double at = std::min(t.front() + static_cast<double>(i) * h, t.back());
    while (k + 2 < t.size() && t[k + 1] < at - 1e-9) ++k;  // at a repeated time, the value before the step
    const double part = t[k + 1] > t[k] ? std::clamp((at - t[k]) / (t[k + 1] - t[k]), 0.0, 1.0) : 0.0;
    even.t.push_back(t.front() + static_cast<double>(i) * h);
    even.place.push_back(static_cast<double>(k) + part);
  }
  about.notes.push_back(fmt::format(
      "The file's {} samples are {:.3g} to {:.3g} s apart{}: they were interpolated linearly "
      "and resampled {:g} times a second.",
      t.size(), std::ranges::min(steps), std::ranges::max(steps),
      clock.rows > 0 ? fmt::format(" ({} of them repeat the time of the sample before)", clock.rows) : "",
      1 / h));
  return even;
}

/// Reports times shared by many samples as one fault. Returns whether there are any.
bool report_repeated_times(const Rows& rows, SampleFaults& faults) {
  const std::vector<double>& t = rows.t;
  const RepeatedTimes clock = repeated_times(t);
  if (!clock.even || (clock.longest < kMostAtOneTime && 5 * clock.rows < t.size())) return false;
  const double length = t.back() - t.front();
  // Rounding repeats times throughout the record; a stopped clock repeats one time.
  const auto apart = static_cast<double>(t.size() - clock.rows);
  const bool rounded = clock.longest < t.size() / 4 || !(length > 0);
  const std::string what =
      fmt::format("{} of {} samples have the time of the sample before", clock.rows, t.size());
  if (rounded)
    faults.add(
        "standing", what, clock.first,
        rows.resolution > 0 && length > 0
            ? fmt::format(
                  "the times have too few digits: they are rounded to {:.3g} s, so that {:.0f} samples "
                  "have the same time",
                  rows.resolution, std::ceil(static_cast<double>(t.size()) / apart))
            : "the times have too few digits",
        "export the record from its source again; a spreadsheet rounds times to the displayed digits (mm:ss.0, "
        "1.77E+12): give the column a format with milliseconds before you save it");
  else
    faults.add(
        "standing", what, clock.first, fmt::format("the clock stops at t = {:.6g} s", t[clock.first]),
        fmt::format("take the section before it (--until {:.6g}), or export the record again with its times",
                    t[clock.first]));
  return true;
}

/// Reports every step that differs from the others.
void report_uneven_steps(const Rows& rows, SampleFaults& faults) {
  const std::vector<double>& t = rows.t;
  const std::vector<double> steps = steps_of(t);
  std::vector<double> known;
  std::ranges::copy_if(steps, std::back_inserter(known), [](double s) { return std::isfinite(s); });
  if (known.empty()) return;
  const bool repeated = known.size() == steps.size() && report_repeated_times(rows, faults);
  const double usual = upper_median(known), resolution = rows.resolution;
  const bool rounded = resolution > 0 && resolution <= 0.15 * usual;
  const double slack = std::max(0.01 * usual, rounded ? 2.1 * resolution : 0.0);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!std::isfinite(steps[k])) continue;  // already reported as an invalid value
    if (steps[k] < 0 || (steps[k] == 0 && !repeated)) {
      faults.add(steps[k] == 0 ? "repeated" : "backwards",
                 fmt::format("t = {:.10g} s after t = {:.10g} s", t[k + 1], t[k]), k + 1,
                 steps[k] == 0 ? "the time is repeated" : "time runs backwards",
                 "sort the record and remove repeated lines");
    } else if (usual > 0 && !repeated && std::abs(steps[k] - usual) > slack) {
      const double missing = std::round(steps[k] / usual) - 1;
      faults.add("step", fmt::format("a time step of {:.6g} s", steps[k]), k + 1,
                 fmt::format("elsewhere samples are {:.6g} s apart", usual) +
                     (missing >= 1 ? fmt::format("; {:.0f} missing", missing) : ""),
                 "fill gaps at the source, and give times with at least 5 decimals");
    }
  }
}

}  // namespace

EvenRows settle_rows(const Rows& rows, Record& about, SampleFaults& faults) {
  EvenRows even{rows.t, std::vector<double>(rows.t.size())};
  std::iota(even.place.begin(), even.place.end(), 0.0);
  const bool known = std::ranges::all_of(rows.t, [](double t) { return std::isfinite(t); });
  if (rows.t.size() < 2 || (known && is_even(even.t))) return even;
  if (known && rows.uneven)
    if (auto sampled = resampled(rows, about)) return *sampled;
  if (known && !rows.uneven) {
    if (snap(even.t, rows.resolution, about)) return even;
    std::vector<std::string> leaps;
    unleap(even.t, faults, leaps);
    std::ranges::move(leaps, std::back_inserter(about.notes));
    if (is_even(even.t) || snap(even.t, rows.resolution, about)) return even;
    for (std::size_t first = 0; first < std::min<std::size_t>(3, rows.t.size() - 1); ++first)
      for (const double h : possible_steps(even.t, rows.resolution))
        if (auto grid = Grid(rows, even.t, h).fit(first, about, faults)) return *grid;
    if (varies(even.t))
      if (auto sampled = resampled(rows, about)) return *sampled;
  }
  report_uneven_steps(rows, faults);
  return even;
}

}  // namespace swingbank::validate::record
