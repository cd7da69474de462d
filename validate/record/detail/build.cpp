#include "validate/record/detail/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "validate/record/detail/bridge.hpp"
#include "validate/record/detail/clock.hpp"
#include "validate/record/detail/frames.hpp"
#include "validate/record/detail/phases.hpp"
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {

std::vector<double>* channel(Record& r, Quantity q) {
  switch (q) {
    case Quantity::time:
      return &r.t;
    case Quantity::V:
      return &r.V;
    case Quantity::theta:
      return &r.theta;
    case Quantity::f:
      return &r.f;
    case Quantity::P:
      return &r.P;
    case Quantity::Q:
      return &r.Q;
    case Quantity::speed:
      return &r.speed;
    case Quantity::Efd:
      return &r.Efd;
    case Quantity::Ifd:
      return &r.Ifd;
    case Quantity::Vs:
      return &r.Vs;
    case Quantity::Vref:
      return &r.Vref;
    case Quantity::Pm:
      return &r.Pm;
    case Quantity::Pref:
      return &r.Pref;
    case Quantity::gate:
      return &r.gate;
    case Quantity::I:
    case Quantity::phi:
      return nullptr;
  }
  return nullptr;
}

std::vector<double> at_places(const std::vector<double>& values, const std::vector<double>& places) {
  std::vector<double> all;
  all.reserve(places.size());
  for (const double place : places) {
    if (!std::isfinite(place)) {
      all.push_back(kNoValue);
      continue;
    }
    const auto below = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(below);
    all.push_back(part > 0 ? values[below] + part * (values[below + 1] - values[below]) : values[below]);
  }
  return all;
}

void settle_angle(Record& r, const ReadOptions& options) {
  if (!r.theta.empty()) return;
  if (r.component == Component::exciter || r.component == Component::governor) {
    r.theta.assign(r.t.size(), 0.0);
    r.angle = AngleSource::none;
    return;
  }
  if (!r.f.empty()) {
    r.theta = angle_of_frequency(r);
    r.angle = AngleSource::integrated;
    if (!options.breaker_opens)
      r.notes.emplace_back(
          "The record has no angle: it was integrated from the frequency. A measured frequency "
          "shows the angle step at a switching late, smoothed or not at all; the angle steps are "
          "therefore fitted. If the instrument filters the frequency, the angle lags: effect FREQLAG removes "
          "the lag.");
    return;
  }
  r.theta.assign(r.t.size(), 0.0);
  r.angle = AngleSource::none;
  if (!options.breaker_opens)
    r.notes.emplace_back(
        "The record has neither angle nor frequency. The voltage magnitude alone is insufficient "
        "for a playback, so P and Q are played in and V is compared; nominal frequency before "
        "the event is assumed.");
  if (!r.Efd.empty())
    r.notes.emplace_back(
        "An exciter alone needs no angle, and Efd is recorded: test it with --component exciter.");
}

namespace {

/// Computes P + jQ = V conj(I), per unit on the record's base.
void power_from_current(Record& r, const std::vector<double>& current, const std::vector<double>& angle) {
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double s = r.V[k] * current[k], between = r.theta[k] - angle[k];
    r.P.push_back(s * std::cos(between));
    r.Q.push_back(s * std::sin(between));
  }
  r.notes.emplace_back("P and Q were computed from the voltage and current phasors.");
}

void check_magnitudes(const RawRecord& raw, SampleFaults& faults) {
  for (const RawColumn& c : raw.columns)
    for (std::size_t k = 0; c.meaning.quantity == Quantity::V && k < c.values.size(); ++k)
      if (c.values[k] < 0)
        faults.add("V < 0", fmt::format("V = {:.6g} pu", c.values[k]), k, "a magnitude cannot be negative",
                   "give V as a magnitude and theta as its angle; are their columns swapped?");
}

/// Returns whether a frequency in mHz is a deviation: all values are below a quarter of nominal frequency.
bool is_deviation(const RawColumn& column, const RecordBase& base) {
  if (column.meaning.unit != Unit::millihertz || column.meaning.deviation) return false;
  return std::ranges::none_of(column.values, [&](double v) { return std::abs(v) > 250 * base.frequency; });
}

void convert(RawRecord& raw, const RecordBase& base) {
  for (RawColumn& column : raw.columns) {
    if (is_deviation(column, base)) {
      column.meaning.deviation = true;
      raw.about.notes.push_back(fmt::format(
          "The column '{}' was interpreted as the deviation from nominal frequency.", column.name));
    }
    for (double& v : column.values) v = to_record_units(column.meaning, v, base);
    if (column.meaning.quantity == Quantity::time)
      raw.time_resolution = std::abs(to_record_units({Quantity::time, column.meaning.unit, false, {}, false},
                                                     raw.time_resolution, base));
  }
}

std::vector<double>& times_of(RawRecord& raw) { return time_column(raw).values; }

/// Shifts times above 1e6 s to begin at zero, because reports cannot display seconds since 1970.
void begin_at_zero(RawRecord& raw, Record& about) {
  std::vector<double>& t = times_of(raw);
  if (t.empty() || !(std::abs(t.front()) > 1e6)) return;
  const double first = t.front();
  about.start = fmt::format("{:.6f} s", first);
  if (first > 5e8 && first < 5e9) {  // 1985 to 2128
    about.epoch = first;
    about.notes.push_back("The times are interpreted as seconds since 1970-01-01 UTC: t = 0 is " +
                          utc_text(first) + ".");
  }
  for (double& v : t) v -= first;
}

/// Removes rows outside the requested time range, with their faults.
void cut_rows(RawRecord& raw, const ReadOptions& options, SampleFaults& faults) {
  if (std::isinf(options.from) && std::isinf(options.until)) return;
  const std::vector<double>& t = times_of(raw);
  std::size_t first = 0, last = t.size();
  while (first < t.size() && t[first] < options.from) ++first;
  while (last > first && t[last - 1] > options.until) --last;
  faults.keep(first, last > 0 ? last - 1 : 0);
  faults.shift(first);
  for (RawColumn& c : raw.columns) {
    c.values.resize(last);
    c.values.erase(c.values.begin(), c.values.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

/// Returns whether a frame without this quantity counts as lost, as it does for each input of the playback.
/// For a component, and for one of several joined files, every column is required.
bool is_required(const RawRecord& raw, const ReadOptions& options, Quantity q) {
  if (options.part || options.component != Component::plant) return true;
  const auto has = [&](Quantity wanted) { return find_column(raw, wanted) != nullptr; };
  if (q == Quantity::V || q == Quantity::theta) return true;
  if (has(Quantity::theta)) return false;
  return q == Quantity::f || (!has(Quantity::f) && (q == Quantity::P || q == Quantity::Q));
}
/// Returns whether a required input is missing in a row.
bool is_lost(const RawRecord& raw, const ReadOptions& options, std::size_t row) {
  return std::ranges::any_of(raw.columns, [&](const RawColumn& c) {
    return c.meaning.quantity != Quantity::time && !std::isfinite(c.values[row]) &&
           is_required(raw, options, c.meaning.quantity);
  });
}
/// Returns whether a column has no value on the grid for longer than kLongestGap.
bool is_long_without(const std::vector<double>& values, const EvenRows& rows) {
  if (rows.t.size() < 2) return false;
  const double step = (rows.t.back() - rows.t.front()) / static_cast<double>(rows.t.size() - 1);
  std::size_t longest = 0, run = 0;
  for (const double place : rows.place) {
    run = std::isfinite(place) && !std::isfinite(values[static_cast<std::size_t>(place)]) ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return static_cast<double>(longest) * step > kLongestGap * (1 + 1e-6);
}

/// Returns the rows on a uniform grid, without lost rows at the ends. Gaps over kLongestGap become faults.
EvenRows settle(RawRecord& raw, const ReadOptions& options, Record& r, SampleFaults& faults) {
  check_magnitudes(raw, faults);
  const std::vector<double>& t = times_of(raw);
  EvenRows rows = settle_rows({.t = t,
                               .resolution = raw.time_resolution,
                               .uneven = raw.uneven,
                               .same = [&](std::size_t a, std::size_t b) { return same_rows(raw, a, b); }},
                              r, faults);
  const std::vector<char> lost = faults.lost(t.size());
  const auto gone = [&](double row) {
    const auto k = static_cast<std::size_t>(row);
    return lost[k] && is_lost(raw, options, k);
  };
  if (!lost.empty())
    for (double& place : rows.place)
      if (std::isfinite(place) && (gone(place) || gone(std::ceil(place)))) place = kNoValue;
  if (!gaps_are_short(rows, r) || (!lost.empty() && std::ranges::any_of(raw.columns, [&](const RawColumn& c) {
        return c.meaning.quantity != Quantity::time && is_long_without(c.values, rows);
      })))
    faults.report_missing();
  return rows;
}

/// Interpolates one column linearly at samples whose frame was recorded without this column's value. Returns
/// the interpolated samples.
std::vector<std::size_t> fill_unmeasured(std::vector<double>& values, const EvenRows& rows) {
  std::vector<std::size_t> filled;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values[k]) && std::isfinite(rows.place[k])) filled.push_back(k);
  const std::vector<double> given = values;
  for (const std::size_t k : filled) {
    std::size_t before = k, after = k;
    while (before > 0 && !std::isfinite(given[before])) --before;
    while (after + 1 < given.size() && !std::isfinite(given[after])) ++after;
    const bool first = std::isfinite(given[before]), last = std::isfinite(given[after]);
    const double part =
        static_cast<double>(k - before) / static_cast<double>(std::max<std::size_t>(after - before, 1));
    values[k] = first && last ? given[before] + part * (given[after] - given[before])
                : first       ? given[before]
                : last        ? given[after]
                              : 0.0;
  }
  return filled;
}

/// Sets the channels of `r` on the grid `rows`. Returns marks of frames in which a compared channel has no
/// value.
std::vector<char> fill_channels(RawRecord& raw, const EvenRows& rows, Record& r) {
  std::vector<double> current, angle;
  std::vector<char> unmeasured;
  for (RawColumn& column : raw.columns) {
    const Quantity q = column.meaning.quantity;
    if (q == Quantity::time) continue;
    std::vector<double> as_written;
    if (q == Quantity::theta) as_written = column.values;
    if (q == Quantity::theta || q == Quantity::phi) unwrap(column.values);
    std::vector<double> values = at_places(column.values, rows.place);
    if (const auto filled = fill_unmeasured(values, rows); !filled.empty()) {
      const bool compared = q != Quantity::f;
      r.notes.push_back(fmt::format(
          "{} has no value in {} of {} samples (empty, a word or a code such as 9999 or 1e308), the first at t = {:.4g} s{}.",
          column.name, filled.size(), values.size(), rows.t[filled.front()],
          compared ? ": their voltage is used, and they are not compared" : ""));
      if (compared) unmeasured.resize(values.size(), 0);
      for (const std::size_t k : filled)
        if (compared) unmeasured[k] = 1;
    }
    if (q == Quantity::theta && values.size() == as_written.size())
      r.theta_as_written = std::move(as_written);
    if (auto* to = channel(r, q))
      *to = std::move(values);
    else
      (q == Quantity::I ? current : angle) = std::move(values);
  }
  r.t = rows.t;
  for (std::size_t k = 0; k < rows.place.size(); ++k)
    if (!std::isfinite(rows.place[k])) {
      r.lost.resize(rows.place.size(), 0);
      r.lost[k] = 1;
    }
  if (r.P.empty() || r.Q.empty()) {
    r.P.clear();
    r.Q.clear();
    if (!current.empty() && !angle.empty() && !r.theta.empty()) power_from_current(r, current, angle);
  }
  if (r.theta_as_written.empty() || !r.lost.empty()) r.theta_as_written.clear();
  return unmeasured;
}

}  // namespace

void SampleFaults::shift(std::size_t first) {
  const Where where = std::move(where_);
  where_ = [where, first](std::size_t a, std::size_t b) { return where(a + first, b + first); };
  for (auto* faults : {&faults_, &missing_})
    for (Fault& f : *faults) {
      f.first -= std::min(f.first, first);
      f.last -= first;
    }
}

void SampleFaults::keep_rows(std::vector<std::size_t> rows) {
  const auto place = [&](std::size_t row) {
    return static_cast<std::size_t>(std::ranges::lower_bound(rows, row) - rows.begin());
  };
  for (auto* faults : {&faults_, &missing_}) {
    for (Fault& f : *faults) f.first = place(f.first), f.last = place(f.last + 1);
    std::erase_if(*faults, [](const Fault& f) { return f.first == f.last; });
    for (Fault& f : *faults) --f.last;
  }
  const Where where = std::move(where_);
  where_ = [where, rows = std::move(rows)](std::size_t a, std::size_t b) { return where(rows[a], rows[b]); };
}

void SampleFaults::add_to(std::vector<Fault>& faults, Fault fault) {
  // Faults of several columns may alternate, so this subject's last fault is searched among the recent ones.
  const std::size_t recent = std::min<std::size_t>(faults.size(), 2 * kQuantities);
  for (auto f = faults.rbegin(); f != faults.rbegin() + static_cast<std::ptrdiff_t>(recent); ++f)
    if (f->subject == fault.subject && f->why == fault.why && f->last + 1 == fault.first) {
      f->last = fault.first;
      return;
    }
  faults.push_back(std::move(fault));
}

void SampleFaults::add(const std::string& subject, std::string what, std::size_t sample, std::string why,
                       std::string remedy) {
  add_to(faults_, {subject, std::move(what), std::move(why), std::move(remedy), sample, sample});
}

void SampleFaults::lose(const std::string& subject, std::string what, std::size_t sample, std::string why,
                        std::string remedy) {
  add_to(missing_, {subject, std::move(what), std::move(why), std::move(remedy), sample, sample});
}

std::vector<char> SampleFaults::lost(std::size_t samples) const {
  std::vector<char> marks(missing_.empty() ? 0 : samples, 0);
  for (const Fault& f : missing_)
    for (std::size_t k = f.first; k <= f.last && k < marks.size(); ++k) marks[k] = 1;
  return marks;
}

void SampleFaults::report_missing() {
  std::ranges::move(missing_, std::back_inserter(faults_));
  missing_.clear();
}

void SampleFaults::keep(std::size_t first, std::size_t last) {
  for (auto* faults : {&faults_, &missing_})
    std::erase_if(*faults, [&](const Fault& f) { return f.last < first || f.first > last; });
}

void SampleFaults::report(Problems& problems, const std::string& file) const {
  constexpr std::size_t kShown = 50;
  for (std::size_t i = 0; i < std::min(kShown, faults_.size()); ++i) {
    const Fault& f = faults_[i];
    const std::size_t n = f.last - f.first + 1;
    problems.add(f.what, where_(f.first, f.last),
                 n > 1 ? fmt::format("{}; {} samples in a row", f.why, n) : f.why, f.remedy);
  }
  if (faults_.size() > kShown)
    problems.add(fmt::format("{} further faults", faults_.size() - kShown), file,
                 fmt::format("only the first {} faults are listed", kShown), "correct the ones above first");
}

Record build_record(RawRecord raw, const RecordBase& base, const ReadOptions& options, SampleFaults faults,
                    Problems problems, const std::string& file) {
  settle_clock(raw);
  combine_phases(raw, base, file);
  const bool per_unit_power = std::ranges::all_of(raw.columns, [](const RawColumn& c) {
    return (c.meaning.quantity != Quantity::P && c.meaning.quantity != Quantity::I) ||
           c.meaning.unit == Unit::pu;
  });
  convert(raw, base);
  drop_repeats(raw, faults);
  lose_zero_frames(raw, faults);
  Record r = std::move(raw.about);
  r.base = base;
  r.per_unit_power = per_unit_power;
  begin_at_zero(raw, r);
  cut_rows(raw, options, faults);
  if (!raw.uneven && check_clock(times_of(raw), time_column(raw).meaning, options, file, problems))
    problems.raise();
  const EvenRows rows = settle(raw, options, r, faults);
  faults.report(problems, file);
  if (rows.place.size() < kMinSamples)
    problems.add(fmt::format("only {} samples", rows.place.size()), file,
                 fmt::format("a record needs at least {} samples", kMinSamples), "give a longer record");
  else if (const double length = rows.t.back() - rows.t.front(); length > 0 && length < kShortestRecord)
    problems.add(fmt::format("{:.3g} s is too short", length), file,
                 fmt::format("the record is shorter than {:g} s, and the response to an event takes seconds",
                             kShortestRecord),
                 "export it from 1 s before to 5 s after the event (--from, --until)");
  problems.raise();
  const std::vector<char> unmeasured = fill_channels(raw, rows, r);
  if (options.component == Component::governor && r.V.empty() && !options.part) r.V.assign(r.t.size(), 1.0);
  bridge(r);
  r.lost.resize(unmeasured.empty() ? r.lost.size() : r.t.size(), 0);
  for (std::size_t k = 0; k < unmeasured.size(); ++k) r.lost[k] = r.lost[k] || unmeasured[k];
  r.component = options.component;
  if (options.part) return r;
  settle_angle(r, options);
  return r;
}

}  // namespace swingbank::validate::record
