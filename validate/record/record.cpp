#include "validate/record/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/constants.hpp"
#include "base/input_file.hpp"
#include "base/sha256.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/formats.hpp"
#include "validate/record/staged.hpp"

namespace swingbank::validate::record {
namespace {

/// Splits "run.h5#G2" at the last '#' into file and terminal, unless it is part of the file's name.
std::filesystem::path split_terminal(const std::filesystem::path& file, ReadOptions& options) {
  const std::string text = file.string();
  const auto at = text.rfind('#');
  if (at == std::string::npos || at == 0 || std::filesystem::exists(file)) return file;
  options.terminal = text.substr(at + 1);
  return text.substr(0, at);
}

std::string extension(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  std::ranges::transform(e, e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

/// Returns the other file of a pair, preferably with an extension in the same case.
std::filesystem::path partner(std::filesystem::path file, const char* lower, const char* upper) {
  const std::string e = file.extension().string();
  const bool capitals = e.size() > 1 && std::isupper(static_cast<unsigned char>(e[1])) != 0;
  const std::filesystem::path same = file.replace_extension(capitals ? upper : lower);
  if (std::filesystem::exists(same)) return same;
  const std::filesystem::path other = file.replace_extension(capitals ? lower : upper);
  return std::filesystem::exists(other) ? other : same;
}

Record read_comtrade(const std::filesystem::path& file, const RecordBase& base, const ReadOptions& options) {
  const std::string e = extension(file), name = file.filename().string();
  std::string bytes;
  Record record;
  if (e == ".cff") {
    bytes = read_bytes(file);
    record = record_of_comtrade(parse_cff(bytes, file.string()), name, base, options);
  } else {
    const auto cfg = e == ".cfg" ? file : partner(file, ".cfg", ".CFG");
    const auto dat = e == ".dat" ? file : partner(file, ".dat", ".DAT");
    bytes = read_bytes(cfg);
    const std::size_t split = bytes.size();
    bytes += read_bytes(dat);
    const std::string_view all = bytes;
    record = record_of_comtrade(
        parse_comtrade(all.substr(0, split), all.substr(split), cfg.string(), dat.string()), name, base,
        options);
  }
  record.sha256 = sha256(bytes);
  return record;
}

/// Splits "event.plb+meter.csv" into the files of one event, unless it is one file's name.
std::vector<std::filesystem::path> parts_of(const std::filesystem::path& named) {
  if (std::filesystem::exists(named)) return {named};
  std::vector<std::filesystem::path> parts;
  const std::string text = named.string();
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    if (end > at) parts.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

Record read_parts(const std::vector<std::filesystem::path>& files, const RecordBase& base,
                  const ReadOptions& options, const std::string& names) {
  ReadOptions part = options;
  part.part = true;
  std::vector<Record> records;
  std::string bytes;
  Problems problems;
  for (const auto& file : files) {
    try {
      records.push_back(read_record(file, base, part));
      bytes += records.back().sha256;
    } catch (const InputError& error) {
      for (const auto& p : error.problems()) problems.add(p.what, p.where, p.why, p.remedy);
    }
  }
  problems.raise();
  Record all = join_records(std::move(records), options, names);
  all.name = names;
  all.sha256 = sha256(bytes);
  return all;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  return read_input(file, "no readable record", "give the path of a record");
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

bool belongs_to(const StagedEvent& e, const std::filesystem::path& file) {
  const std::string named = file.string(), path = named.substr(0, named.rfind('#'));
  return e.record.empty() || e.record == std::filesystem::path(path).filename().string() ||
         e.record == file.filename().string();
}

Record read_staged(const std::filesystem::path& file, const RecordBase& base, ReadOptions options) {
  std::vector<StagedEvent> staged;
  std::ranges::copy_if(options.staged, std::back_inserter(staged),
                       [&](const StagedEvent& e) { return belongs_to(e, file); });
  const bool open = std::ranges::any_of(
      staged, [](const StagedEvent& e) { return e.kind == StagedEvent::Kind::open_circuit; });
  if (open) {
    options.power = false;
    std::erase_if(options.needed, [](const auto& any) {
      return any.front() == "P" || any.front() == "Q" || any.front() == "theta";
    });
  }
  Record r = read_record(file, base, options);
  r.staged = std::move(staged);
  if (!r.breaker()) return r;
  for (auto* power : {&r.P, &r.Q})
    if (power->empty()) power->assign(r.t.size(), 0.0);
  if (r.speed.empty() && !r.f.empty()) {
    r.speed = r.f;
    r.notes.emplace_back("The frequency is used as the speed, because no grid is connected to the machine.");
  }
  if (r.angle != AngleSource::measured)
    std::erase_if(r.notes, [](const std::string& note) { return note.starts_with("The record has n"); });
  return r;
}

Record stretch(Record r, double from, double until) {
  const double slack = 1e-4 * r.step();
  const auto first = static_cast<std::size_t>(std::ranges::lower_bound(r.t, from - slack) - r.t.begin());
  const auto last = static_cast<std::size_t>(std::ranges::upper_bound(r.t, until + slack) - r.t.begin());
  if (first == 0 && last == r.t.size()) return r;
  const std::size_t kept = last > first ? last - first : 0;
  if (kept < kMinSamples)
    throw InputError({fmt::format("{} samples", kept), r.name,
                      fmt::format("the selected time range contains fewer than {}", kMinSamples),
                      "give an earlier --from or a later --until"});
  if (const double length = r.t[last - 1] - r.t[first]; length < kShortestRecord)
    throw InputError({fmt::format("{:.3g} s is too short", length), r.name,
                      "the response to an event takes seconds", "give an earlier --from or a later --until"});
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

/// Returns the mean of f over the interval before sample k: of the cubic through four samples if evenly
/// spaced, else linear. At 30 samples/s the errors for a swing of 1.5 Hz are 1.5e-4 and 0.8 %.
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
                      "record one of them, or play in P and Q: swingbank compare --drive pq"});
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
  return record.start.empty() ? std::string() : record.start + " (as written; its zone is not known)";
}

std::string record_name(const std::filesystem::path& named) {
  std::string names;
  for (const auto& part : parts_of(named)) names += (names.empty() ? "" : "+") + part.filename().string();
  return names;
}

Record read_record(const std::filesystem::path& named, const RecordBase& base, const ReadOptions& given) {
  if (const auto parts = parts_of(named); parts.size() > 1)
    return read_parts(parts, base, given, record_name(named));
  ReadOptions options = given;
  const std::filesystem::path file = split_terminal(named, options);
  const std::string e = extension(file);
  const bool comtrade = e == ".cfg" || e == ".dat" || e == ".cff";
  Record record = comtrade                     ? read_comtrade(file, base, options)
                  : e == ".h5" || e == ".hdf5" ? read_hdf5_record(file, base, options)
                  : e == ".mat"                ? read_mat_record(file, base, options)
                                               : parse_record(read_bytes(file), file.string(), base, options);
  record.name = record_name(named);  // includes the terminal: two of a file must differ
  return record;
}

}  // namespace swingbank::validate::record
