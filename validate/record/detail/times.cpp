#include "validate/record/detail/times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "base/median.hpp"

namespace swingbank::validate::record {
namespace {

/// Reads from the front of a text; every part may fail, which leaves `ok` false.
struct Scanner {
  std::string_view rest;
  bool ok = true;

  long integer(std::size_t most) {
    long v = 0;
    const std::size_t n = std::min(rest.size(), most);
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + n, v);
    if (error != std::errc{} || v < 0) return ok = false, 0;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return v;
  }
  bool take(std::string_view any) {
    if (rest.empty() || any.find(rest.front()) == std::string_view::npos) return false;
    rest.remove_prefix(1);
    return true;
  }
  void expect(std::string_view any) { ok = take(any) && ok; }
};

bool day_of(long year, long month, long day, long& days) {
  using namespace std::chrono;
  const year_month_day date{std::chrono::year(static_cast<int>(year)),
                            std::chrono::month(static_cast<unsigned>(month)),
                            std::chrono::day(static_cast<unsigned>(day))};
  if (year < 1900 || year > 2200 || !date.ok()) return false;
  days = sys_days(date).time_since_epoch().count();
  return true;
}

/// "2024-05-01" or "5/1/2024", and what divides it from the time.
void scan_date(Scanner& s, Stamp& stamp) {
  const long a = s.integer(4);
  s.expect("-/.");
  const long b = s.integer(2);
  s.expect("-/.");
  const long c = s.integer(4);
  if (!s.ok) return;
  s.ok = a > 31 ? day_of(a, b, c, stamp.day) : day_of(c, a, b, stamp.day) || day_of(c, b, a, stamp.day);
  s.expect("T ");
  while (s.take(" ")) {
  }
}

void scan_time(Scanner& s, Stamp& stamp) {
  const long hour = s.integer(2);
  s.expect(":");
  const long minute = s.integer(2);
  s.expect(":");
  const long second = s.integer(2);
  double fraction = 0, digit = 0.1;
  if (s.take(".,"))
    for (; !s.rest.empty() && s.rest.front() >= '0' && s.rest.front() <= '9'; digit /= 10, ++stamp.decimals) {
      fraction += digit * (s.rest.front() - '0');
      s.rest.remove_prefix(1);
    }
  s.ok = s.ok && hour < 24 && minute < 60 && second < 61;
  stamp.second = static_cast<double>(hour * 3600 + minute * 60 + second) + fraction;
}

/// "PM", "Z", "+02:00".
void scan_end(Scanner& s, Stamp& stamp) {
  while (s.take(" ")) {
  }
  if (s.rest.size() >= 2 && (s.rest[1] == 'M' || s.rest[1] == 'm') && s.rest.find_first_of("AaPp") == 0) {
    const bool afternoon = s.rest[0] == 'P' || s.rest[0] == 'p';
    const bool twelve = stamp.second >= 12 * 3600;
    if (stamp.second >= 13 * 3600) s.ok = false;
    stamp.second += (afternoon ? 12 : 0) * 3600 - (twelve ? 12 : 0) * 3600;
    s.rest.remove_prefix(2);
  }
  if (s.rest.empty()) return;
  stamp.zoned = true;
  for (const std::string_view zone : {"Z", "z", "UTC", "GMT"})
    if (s.rest == zone) return;
  const bool east = s.rest.front() == '+';
  s.expect("+-");
  const long hours = s.integer(2);
  s.take(":");
  const long minutes = s.rest.empty() ? 0 : s.integer(2);
  stamp.second -= (east ? 1 : -1) * static_cast<double>(hours * 3600 + minutes * 60);
  s.ok = s.ok && s.rest.empty();
}

std::vector<double> steps_of(const std::vector<double>& t) {
  std::vector<double> steps(t.size() - 1);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) steps[k] = t[k + 1] - t[k];
  return steps;
}

/// Of a record after missing ones are counted: more than an hour at 480 samples/s. What would be longer holds
/// a time that is none.
constexpr std::size_t kMostSamples = 2'000'000;

/// Times rounded more coarsely than this share of a step do not tell a lost frame.
constexpr double kCoarsest = 0.75;

bool is_even(const std::vector<double>& t) {
  const std::vector<double> steps = steps_of(t);
  const double usual = upper_median(steps);
  return usual > 0 &&
         std::ranges::all_of(steps, [&](double s) { return std::abs(s - usual) <= 0.01 * usual; });
}

/// Puts times that are rounded to `resolution` on an even grid if all of them fit one.
bool snap(std::vector<double>& t, double resolution, Record& about) {
  const auto last = static_cast<double>(t.size() - 1);
  double h = (t.back() - t.front()) / last;
  if (!(h > 0) || !(resolution <= kCoarsest * h)) return false;
  // Instruments sample a whole number of times per second; the end points alone leave h uncertain.
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
      "Times are rounded to {:.3g} ms in the file; the samples were taken to be {:.6g} per second.",
      1e3 * resolution, 1 / h));
  return true;
}

/// A clock that was put back, or on to another hour, while the samples went on evenly: `t` goes on too. At
/// most three times; what may be a gap or rows out of order is left as it is.
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
          fmt::format("At {} the clock was put {} by {:.6g} s; the samples were taken to go on evenly.",
                      faults.where(k + 1), leap < 0 ? "back" : "on", std::abs(leap)));
      shift -= leap;
    }
    t[k + 1] += shift;
  }
}

/// Steps of the grid that the rows may stand on [s].
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

/// Rows on a grid of a given step, with gaps where frames are missing.
class Grid {
 public:
  Grid(const Rows& rows, const std::vector<double>& t, double step) : rows_(rows), t_(t), h_(step) {}

  std::optional<EvenRows> fit(Record& about, SampleFaults& faults) {
    if (!count()) return std::nullopt;
    const auto last = static_cast<double>(index_.back());
    if (!coarse()) h_ = (t_[row_.back()] - t_.front()) / last;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (moved_[i]) continue;
      const double off = t_[row_[i]] - static_cast<double>(index_[i]) * h_;
      low = std::min(low, off), high = std::max(high, off);
    }
    if (!(high - low <= 1.05 * rows_.resolution + (coarse() ? 0.02 : 0.2) * h_)) return std::nullopt;
    tell(about, faults);
    EvenRows even;
    const double first = coarse() ? (low + high) / 2 : t_.front();
    even.place.assign(index_.back() + 1, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < row_.size(); ++i) even.place[index_[i]] = static_cast<double>(row_[i]);
    for (std::size_t g = 0; g < even.place.size(); ++g) even.t.push_back(first + static_cast<double>(g) * h_);
    return even;
  }

 private:
  [[nodiscard]] bool coarse() const { return rows_.resolution > 0.15 * h_; }

  /// False where the rows do not stand on such a grid.
  bool count() {
    row_ = {0}, index_ = {0}, moved_ = {0};
    double before = t_.front();
    for (std::size_t k = 1; k < t_.size(); ++k) {
      double dt = t_[k] - before;
      bool moved = false;
      if (!coarse() && std::abs(dt) < 0.02 * h_) {
        if (rows_.same(row_.back(), k)) {
          twice_.push_back(k);
          continue;
        }
        if (k + 1 < t_.size() && std::abs(t_[k + 1] - t_[k] - 2 * h_) > 0.1 * h_) return false;
        moved = true;
        stuck_.push_back(k);
        dt = h_;
      }
      const double steps = std::max(std::round(dt / h_), coarse() && dt > -rows_.resolution ? 1.0 : 0.0);
      const double slack = coarse() ? 1.05 * rows_.resolution + 0.02 * h_ : 0.1 * h_ + 2.1 * rows_.resolution;
      if (steps < 1 || steps > static_cast<double>(kMostSamples) || std::abs(dt - steps * h_) > slack)
        return false;
      index_.push_back(index_.back() + static_cast<std::size_t>(steps));
      if (index_.back() >= kMostSamples) return false;
      row_.push_back(k);
      moved_.push_back(moved);
      before = moved ? before + h_ : t_[k];
    }
    return !row_.empty();
  }

  void tell(Record& about, SampleFaults& faults) const {
    const auto rate = 1 / h_;
    if (!twice_.empty())
      about.notes.push_back(
          fmt::format("{} rows repeat the row before with its time stamp, the first at {}: left out.",
                      twice_.size(), faults.where(twice_.front())));
    if (!stuck_.empty())
      about.notes.push_back(fmt::format(
          "{} time stamps repeat the one before although the values go on, the first at {}: these rows were taken to "
          "be one step later.",
          stuck_.size(), faults.where(stuck_.front())));
    if (coarse())
      about.notes.push_back(fmt::format(
          "Times are rounded to {:.3g} ms in the file; the samples were taken to be {:.6g} per second.",
          1e3 * rows_.resolution, rate));
    for (std::size_t i = 1; i < index_.size(); ++i) {
      const double missing = static_cast<double>(index_[i] - index_[i - 1]) - 1;
      if (missing * h_ > kLongestGap * (1 + 1e-6))
        faults.add(
            "gap", fmt::format("a gap of {:.4g} s", (missing + 1) * h_), row_[i],
            fmt::format("samples are {:.6g} s apart, so {:.0f} are missing; up to {:g} s are bridged", h_,
                        missing, kLongestGap),
            "fill the gap at the source, or take the stretch before or after it (--until, --from); if the "
            "clock leapt there and nothing is missing, mend the stamps");
    }
  }

  const Rows& rows_;
  const std::vector<double>& t_;
  double h_;
  std::vector<std::size_t> row_, index_;  ///< rows that stay, and their places on the grid
  std::vector<char> moved_;               ///< by row that stays: its stamp was wrong
  std::vector<std::size_t> twice_, stuck_;
};

/// Do many steps differ, as where a simulation chose them?
bool varies(const std::vector<double>& t) {
  const std::vector<double> steps = steps_of(t);
  if (std::ranges::any_of(steps, [](double s) { return s < 0; })) return false;
  const double usual = upper_median(steps);
  const auto off = std::ranges::count_if(steps, [&](double s) { return std::abs(s - usual) > 0.1 * usual; });
  return 5 * static_cast<std::size_t>(off) > steps.size();
}

/// The rows at even instants by straight lines, as a playback of them is meant. None where they run
/// backwards.
std::optional<EvenRows> resampled(const Rows& rows, Record& about) {
  constexpr std::array<double, 5> kRates = {30, 60, 120, 240, 480};
  const std::vector<double>& t = rows.t;
  const std::vector<double> steps = steps_of(t);
  const double length = t.back() - t.front();
  if (!(length > 0) || std::ranges::any_of(steps, [](double s) { return s < 0; })) return std::nullopt;
  const auto apart = static_cast<double>(std::ranges::count_if(steps, [](double s) { return s > 1e-6; }));
  // A step stands at a time that is there twice: it needs closer samples than what moves slowly.
  const bool steps_up = std::ranges::any_of(steps, [](double s) { return s < 1e-6; });
  const double least = std::max(apart / length, steps_up ? 120.0 : 0.0);
  const auto* rate = std::ranges::find_if(kRates, [&](double r) { return r >= least; });
  const double h = 1 / (rate == kRates.end() ? kRates.back() : *rate);
  if (length / h >= static_cast<double>(kMostSamples)) return std::nullopt;
  EvenRows even;
  std::size_t k = 0;
  for (std::size_t i = 0; t.front() + static_cast<double>(i) * h <= t.back() + 1e-9; ++i) {
    const double at = std::min(t.front() + static_cast<double>(i) * h, t.back());
    while (k + 2 < t.size() && t[k + 1] < at - 1e-9) ++k;  // a sample at a repeated time counts as before it
    const double part = t[k + 1] > t[k] ? std::clamp((at - t[k]) / (t[k + 1] - t[k]), 0.0, 1.0) : 0.0;
    even.t.push_back(t.front() + static_cast<double>(i) * h);
    even.place.push_back(static_cast<double>(k) + part);
  }
  about.notes.push_back(fmt::format(
      "The file's {} samples are {:.3g} to {:.3g} s apart: they were joined by straight lines and taken {:g} times "
      "a second.",
      t.size(), std::ranges::min(steps), std::ranges::max(steps), 1 / h));
  return even;
}

/// Every step that is not like the others.
void tell_steps(const Rows& rows, SampleFaults& faults) {
  const std::vector<double>& t = rows.t;
  const std::vector<double> steps = steps_of(t);
  std::vector<double> known;
  std::ranges::copy_if(steps, std::back_inserter(known), [](double s) { return std::isfinite(s); });
  if (known.empty()) return;
  const double usual = upper_median(known), resolution = rows.resolution;
  const bool rounded = resolution > 0 && resolution <= 0.15 * usual;
  const double slack = std::max(0.01 * usual, rounded ? 2.1 * resolution : 0.0);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!std::isfinite(steps[k])) continue;  // already told as a value
    if (!(steps[k] > 0)) {
      faults.add(steps[k] == 0 ? "repeated" : "backwards",
                 fmt::format("t = {:.10g} s after t = {:.10g} s", t[k + 1], t[k]), k + 1,
                 steps[k] == 0 ? "the time is repeated" : "time runs backwards",
                 "sort the record and remove repeated lines");
    } else if (usual > 0 && std::abs(steps[k] - usual) > slack) {
      const double missing = std::round(steps[k] / usual) - 1;
      faults.add("step", fmt::format("a step of {:.6g} s", steps[k]), k + 1,
                 fmt::format("elsewhere samples are {:.6g} s apart", usual) +
                     (missing >= 1 ? fmt::format("; {:.0f} missing", missing) : ""),
                 "fill gaps at the source, and give times with at least 5 decimals");
    }
  }
}

}  // namespace

std::optional<Stamp> parse_stamp(std::string_view text) {
  Scanner s{text};
  Stamp stamp;
  const auto first = text.find_first_of("-/:.");
  if (first == std::string_view::npos) return std::nullopt;
  if (text[first] != ':') scan_date(s, stamp);
  scan_time(s, stamp);
  if (s.ok) scan_end(s, stamp);
  return s.ok ? std::optional(stamp) : std::nullopt;
}

EvenRows settle_rows(const Rows& rows, Record& about, SampleFaults& faults) {
  EvenRows even{rows.t, std::vector<double>(rows.t.size())};
  std::iota(even.place.begin(), even.place.end(), 0.0);
  const bool known = std::ranges::all_of(rows.t, [](double t) { return std::isfinite(t); });
  if (rows.t.size() < 2 || (known && is_even(even.t))) return even;
  if (known && rows.uneven) return resampled(rows, about).value_or(even);
  if (known) {
    if (snap(even.t, rows.resolution, about)) return even;
    std::vector<std::string> leaps;
    unleap(even.t, faults, leaps);
    std::ranges::move(leaps, std::back_inserter(about.notes));
    if (is_even(even.t) || snap(even.t, rows.resolution, about)) return even;
    for (const double h : possible_steps(even.t, rows.resolution))
      if (auto grid = Grid(rows, even.t, h).fit(about, faults)) return *grid;
    if (varies(even.t))
      if (auto sampled = resampled(rows, about)) return *sampled;
  }
  tell_steps(rows, faults);
  return even;
}

}  // namespace swingbank::validate::record
