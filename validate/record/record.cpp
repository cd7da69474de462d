#include "validate/record/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/constants.hpp"
#include "base/input_file.hpp"
#include "base/sha256.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

Record read_comtrade(const SourceFile& source, const RecordBase& base, const ReadOptions& options) {
  const bool pair = !source.data.empty();
  std::string bytes = read_bytes(pair ? source.config : source.path);
  const std::size_t split = bytes.size();
  if (pair) bytes += read_bytes(source.data);
  const std::string_view all = bytes;
  Record record = record_of_comtrade(pair ? parse_comtrade(all.substr(0, split), all.substr(split),
                                                           source.config.string(), source.data.string())
                                          : parse_cff(bytes, source.path.string()),
                                     source.path.filename().string(), base, options);
  record.sha256 = sha256(bytes);
  return record;
}

Record read_file(const SourceFile& file, const RecordBase& base, ReadOptions options) {
  if (!file.terminal.empty()) options.terminal = file.terminal;
  using Format = SourceFile::Format;
  Record record = file.format == Format::comtrade ? read_comtrade(file, base, options)
                  : file.format == Format::hdf5   ? read_hdf5_record(file.path, base, options)
                  : file.format == Format::pscad  ? read_pscad_record(file, base, options)
                  : file.format == Format::matlab
                      ? read_mat_record(file.path, base, options)
                      : parse_record(read_bytes(file.path), file.path.string(), base, options);
  record.name = file.name;  // includes the terminal, so that two records of one file differ
  return record;
}

Record read_parts(const Source& source, const RecordBase& base, const ReadOptions& options) {
  ReadOptions part = options;
  part.part = true;
  std::vector<Record> records;
  std::string bytes;
  Problems problems;
  for (const SourceFile& file : source.files) {
    try {
      records.push_back(read_file(file, base, part));
      bytes += records.back().sha256;
    } catch (const InputError& error) {
      problems.add(error);
    }
  }
  problems.raise();
  Record all = join_records(std::move(records), options, source.name);
  all.name = source.name;
  all.sha256 = sha256(bytes);
  return all;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  return read_input(file, "cannot read the record", "give the path of a record");
}

void check_files(const Source& source, Problems& problems) {
  for (const SourceFile& part : source.files)
    for (const auto& file : part.all_files()) {
      try {
        read_bytes(file);
      } catch (const InputError& error) {
        problems.add(error);
      }
    }
}

std::string_view component_name(Component component) {
  constexpr std::array<std::string_view, 4> names = {"plant", "exciter", "governor", "machine"};
  return names[static_cast<std::size_t>(component)];
}

std::string_view staged_name(StagedEvent::Kind kind) {
  constexpr std::array<std::string_view, kStagedKinds> names = {"vref_step", "pref_step", "efd_step",
                                                                "open_circuit", "load_rejection"};
  return names[static_cast<std::size_t>(kind)];
}

const StagedEvent* Record::breaker() const {
  if (component == Component::exciter || component == Component::governor) return nullptr;
  const auto at = std::ranges::find_if(staged, &StagedEvent::opens_breaker);
  return at == staged.end() ? nullptr : &*at;
}

double Record::first_staged() const {
  double first = std::numeric_limits<double>::infinity();
  for (const StagedEvent& e : staged)
    if (e.kind != StagedEvent::Kind::open_circuit) first = std::min(first, e.time);
  return first;
}

Record read_staged(const Source& source, const RecordBase& base, ReadOptions options) {
  std::vector<StagedEvent> staged;
  std::ranges::copy_if(options.staged, std::back_inserter(staged),
                       [&](const StagedEvent& e) { return e.applies_to(source); });
  const bool open = std::ranges::any_of(
      staged, [](const StagedEvent& e) { return e.kind == StagedEvent::Kind::open_circuit; });
  options.breaker_opens = options.component != Component::exciter &&
                          options.component != Component::governor &&
                          std::ranges::any_of(staged, &StagedEvent::opens_breaker);
  if (open) {
    options.power = false;
    std::erase_if(options.needed, [](const auto& any) {
      return any.front() == "P" || any.front() == "Q" || any.front() == "theta";
    });
  }
  Record r = read_record(source, base, options);
  r.staged = std::move(staged);
  if (!r.breaker()) return r;
  for (auto* power : {&r.P, &r.Q})
    if (power->empty()) power->assign(r.t.size(), 0.0);
  if (r.speed.empty() && !r.f.empty()) {
    r.speed = r.f;
    r.notes.emplace_back(
        "The frequency is used as the speed: no speed is recorded, and the breaker is open or "
        "opens.");
  }
  return r;
}

Record stretch(Record r, double from, double until) {
  const double slack = r.time_slack();
  const auto first = static_cast<std::size_t>(std::ranges::lower_bound(r.t, from - slack) - r.t.begin());
  const auto last = static_cast<std::size_t>(std::ranges::upper_bound(r.t, until + slack) - r.t.begin());
  if (first == 0 && last == r.t.size()) return r;
  const std::size_t kept = last > first ? last - first : 0;
  if (kept < kMinSamples)
    throw InputError({fmt::format("only {} samples", kept), r.name,
                      fmt::format("the selected time range contains fewer than {} samples", kMinSamples),
                      "give an earlier --from or a later --until"});
  if (const double length = r.t[last - 1] - r.t[first]; length < kShortestRecord)
    throw InputError(
        {fmt::format("{:.3g} s is too short", length), r.name,
         fmt::format("the record is shorter than {:g} s, and the response to an event takes seconds",
                     kShortestRecord),
         "give an earlier --from or a later --until"});
  const auto cut = [&](auto& values) {
    if (values.empty()) return;
    values.resize(last);
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  for (auto* channel : {&r.t, &r.V, &r.theta, &r.P, &r.Q, &r.f, &r.speed, &r.Efd, &r.Ifd, &r.Vs, &r.Vref,
                        &r.Pm, &r.Pref, &r.gate, &r.theta_as_written})
    cut(*channel);
  cut(r.lost);
  return r;
}

double quantum(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  if (sorted.size() < 3 || !(sorted.back() > sorted.front())) return 0;
  const double same = 1e-9 * std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  std::vector<double> steps;
  for (std::size_t k = 0; k + 1 < sorted.size(); ++k)
    if (sorted[k + 1] - sorted[k] > same) steps.push_back(sorted[k + 1] - sorted[k]);
  if (steps.empty() || 3 * (steps.size() + 1) > sorted.size()) return 0;
  const double least = std::ranges::min(steps);
  const bool grid = std::ranges::all_of(
      steps, [&](double s) { return std::abs(s / least - std::round(s / least)) < 0.02; });
  return grid ? least : 0;
}

namespace {

/// Returns the mean of f over the interval before sample k. It integrates the cubic through four samples if
/// they are evenly spaced, otherwise a straight line. At 30 samples/s, the errors for a swing of 1.5 Hz are
/// 0.015 % and 0.8 %.
double mean_before(const std::vector<double>& t, const std::vector<double>& f, std::size_t k) {
  const double step = t[k] - t[k - 1];
  const auto even = [&](std::size_t i) { return std::abs(t[i] - t[i - 1] - step) < 1e-3 * step; };
  if (k < 2 || k + 1 >= t.size() || !even(k - 1) || !even(k + 1)) return (f[k - 1] + f[k]) / 2;
  return (13 * (f[k - 1] + f[k]) - f[k - 2] - f[k + 1]) / 24;
}

}  // namespace

std::vector<double> angle_of_frequency(const Record& r) {
  std::vector<double> theta(r.t.size(), 0.0);
  const double scale = constants::turn * r.base.frequency;
  for (std::size_t k = 1; k < theta.size(); ++k)
    theta[k] = theta[k - 1] + scale * (r.t[k] - r.t[k - 1]) * mean_before(r.t, r.f, k);
  return theta;
}

void require_angle(const Record& record) {
  if (record.angle == AngleSource::none)
    throw InputError({"no angle and no frequency", record.name, "playback needs the angle of the voltage",
                      "record one of them, or play in P and Q: swingbank compare --playback pq"});
}

std::string utc_text(double epoch) {
  const auto micros = static_cast<std::int64_t>(std::llround(epoch * 1e6));
  const std::chrono::sys_time<std::chrono::microseconds> at{std::chrono::microseconds{micros}};
  const auto day = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{at - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

void unwrap(std::vector<double>& angle) {
  double last = kNoValue;
  for (double& a : angle) {
    if (!std::isfinite(a)) continue;
    if (std::isfinite(last)) a -= constants::turn * std::round((a - last) / constants::turn);
    last = a;
  }
}

std::string beginning(const Record& record) {
  if (record.epoch) return utc_text(*record.epoch);
  return record.start.empty() ? std::string() : record.start + " (time zone unknown)";
}

Record read_record(const Source& source, const RecordBase& base, const ReadOptions& options) {
  return source.files.size() > 1 ? read_parts(source, base, options)
                                 : read_file(source.files.front(), base, options);
}

}  // namespace swingbank::validate::record
