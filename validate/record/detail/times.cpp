#include "validate/record/detail/times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>

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

/// "PM", "Z", "+02:00": only differences of times matter, so a zone that is the same for all changes nothing.
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
  if (s.take("Zz") || s.rest.empty()) {
    s.ok = s.ok && s.rest.empty();
    return;
  }
  s.expect("+-");
  s.integer(2);
  s.take(":");
  if (!s.rest.empty()) s.integer(2);
  s.ok = s.ok && s.rest.empty();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<double> steps_of(const std::vector<double>& t) {
  std::vector<double> steps(t.size() - 1);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) steps[k] = t[k + 1] - t[k];
  return steps;
}

/// Puts times that are rounded to `resolution` on an even grid if all of them fit one.
bool snap(std::vector<double>& t, double resolution, Record& about) {
  const auto last = static_cast<double>(t.size() - 1);
  double h = (t.back() - t.front()) / last;
  if (!(h > 0) || !(resolution <= 0.15 * h)) return false;
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

void settle_times(std::vector<double>& t, double resolution, Record& about, SampleFaults& faults) {
  if (t.size() < 2) return;
  const std::vector<double> steps = steps_of(t);
  std::vector<double> known;
  std::ranges::copy_if(steps, std::back_inserter(known), [](double s) { return std::isfinite(s); });
  if (known.empty()) return;
  const double usual = median(known);
  const auto even = [&](double s) { return std::abs(s - usual) <= 0.01 * usual; };
  if (usual > 0 && std::ranges::all_of(steps, even)) return;
  if (known.size() == steps.size() && snap(t, resolution, about)) return;
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

}  // namespace swingbank::validate::record
