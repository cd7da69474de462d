#include "validate/record/detail/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "base/constants.hpp"
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {
namespace {

using Present = std::array<bool, kQuantities>;

/// Quantities that a comparison cannot do without. P and Q, where they are needed, may also come from the
/// current.
std::vector<Quantity> missing(const Present& present, bool power) {
  const auto has = [&](Quantity q) { return present[static_cast<std::size_t>(q)]; };
  std::vector<Quantity> all;
  for (const auto q : {Quantity::time, Quantity::V, Quantity::theta})
    if (!has(q)) all.push_back(q);
  if (!power || (has(Quantity::I) && has(Quantity::phi))) return all;
  for (const auto q : {Quantity::P, Quantity::Q})
    if (!has(q)) all.push_back(q);
  return all;
}

Present present_in(const std::vector<Heading>& headings, const std::string& terminal) {
  Present present{};
  for (const auto& h : headings)
    if (h.meaning && (h.meaning->terminal.empty() || h.meaning->terminal == terminal))
      present[static_cast<std::size_t>(h.meaning->quantity)] = true;
  return present;
}

std::string listed(const std::set<std::string>& names) {
  std::string all;
  for (const auto& n : names) all += (all.empty() ? "" : ", ") + n;
  return all;
}

/// The terminal to read: the one asked for, the nameless one, or the only complete one.
std::string choose_terminal(const std::vector<Heading>& headings, const ReadOptions& options,
                            const std::string& where, Problems& problems) {
  const std::string& asked = options.terminal;
  std::set<std::string> all, complete;
  for (const auto& h : headings)
    if (h.meaning && !h.meaning->terminal.empty()) all.insert(h.meaning->terminal);
  if (!asked.empty()) {
    if (!all.contains(asked))
      problems.add("no terminal '" + asked + "'", where,
                   all.empty() ? "the file names no terminals" : "the file has " + listed(all),
                   all.empty() ? "leave '#" + asked + "' off the file's name" : "choose one of them");
    return asked;
  }
  if (all.empty() || missing(present_in(headings, {}), options.power).empty()) return {};
  for (const auto& t : all)
    if (missing(present_in(headings, t), options.power).empty()) complete.insert(t);
  if (complete.size() > 1)
    problems.add("several terminals", where, "the file has " + listed(complete),
                 "choose one: FILE#" + *complete.begin());
  if (!complete.empty()) return *complete.begin();
  if (all.size() > 1)
    problems.add("no complete terminal", where,
                 "of " + listed(all) + " none has voltage, angle" +
                     (options.power ? ", P and Q (or current and its angle)" : " and time"),
                 "export all of them for one terminal");
  return *all.begin();
}

void check_missing(const Present& present, bool power, const std::string& where, const Record& about,
                   Problems& problems) {
  std::string others;
  for (const auto& name : about.ignored) others += (others.empty() ? "" : ", ") + name;
  for (const auto q : missing(present, power))
    problems.add("no column " + names_of(q), where,
                 std::string(power ? "play-in needs time, voltage, angle, P and Q"
                                   : "a comparison needs time, voltage and angle") +
                     (others.empty() ? "" : "; not understood: " + others.substr(0, 200)),
                 "add the column, named with its unit");
}

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
    case Quantity::I:
    case Quantity::phi:
      return nullptr;
  }
  return nullptr;
}

/// P + jQ = V conj(I), all per unit on the record's base.
void power_from_current(Record& r, const std::vector<double>& current, const std::vector<double>& angle) {
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double s = r.V[k] * current[k], between = r.theta[k] - angle[k];
    r.P.push_back(s * std::cos(between));
    r.Q.push_back(s * std::sin(between));
  }
  r.notes.emplace_back("P and Q were computed from the voltage and current phasors.");
}

/// Angles are known up to turns; a continuous one is kept, so that plots and differences make sense.
void unwrap(std::vector<double>& angle) {
  for (std::size_t k = 1; k < angle.size(); ++k)
    angle[k] -= constants::turn * std::round((angle[k] - angle[k - 1]) / constants::turn);
}

void check_magnitudes(const Record& r, SampleFaults& faults) {
  for (std::size_t k = 0; k < r.V.size(); ++k)
    if (r.V[k] < 0)
      faults.add("V < 0", fmt::format("V = {:.6g} pu", r.V[k]), k, "a magnitude cannot be negative",
                 "give V as a magnitude and theta as its angle; are their columns swapped?");
}

}  // namespace

void SampleFaults::add(const std::string& subject, std::string what, std::size_t sample, std::string why,
                       std::string remedy) {
  // Several columns may run in step: look for this subject's last fault among the recent ones.
  const std::size_t recent = std::min<std::size_t>(faults_.size(), 2 * kQuantities);
  for (auto f = faults_.rbegin(); f != faults_.rbegin() + static_cast<std::ptrdiff_t>(recent); ++f)
    if (f->subject == subject && f->why == why && f->last + 1 == sample) {
      f->last = sample;
      return;
    }
  faults_.push_back({subject, std::move(what), std::move(why), std::move(remedy), sample, sample});
}

void SampleFaults::tell(Problems& problems, const std::string& file) const {
  constexpr std::size_t kShown = 50;
  for (std::size_t i = 0; i < std::min(kShown, faults_.size()); ++i) {
    const Fault& f = faults_[i];
    const std::size_t n = f.last - f.first + 1;
    problems.add(f.what, where_(f.first, f.last),
                 n > 1 ? fmt::format("{}; {} samples in a row", f.why, n) : f.why, f.remedy);
  }
  if (faults_.size() > kShown)
    problems.add(fmt::format("{} further faults", faults_.size() - kShown), file, "the list is cut here",
                 "mend the ones above first");
}

std::vector<std::size_t> choose_columns(const std::vector<Heading>& headings, const ReadOptions& options,
                                        const RecordBase& base, const std::string& where, Record& about,
                                        Problems& problems) {
  about.terminal = choose_terminal(headings, options, where, problems);
  std::vector<std::size_t> chosen;
  std::set<std::string> others;
  Present used{};
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const auto& [name, meaning] = headings[i];
    if (!meaning) {
      if (!name.empty()) about.ignored.push_back(name);
      continue;
    }
    if (!meaning->terminal.empty() && meaning->terminal != about.terminal) {
      others.insert(meaning->terminal);
      continue;
    }
    const auto q = static_cast<std::size_t>(meaning->quantity);
    if (!meaning->unit)
      problems.add(fmt::format("column '{}'", name), where, "its unit is missing or not known",
                   "name it one of " + names_of(meaning->quantity));
    else if (needs_kv(*meaning->unit) && !(base.kv > 0))
      problems.add(fmt::format("column '{}'", name), where, "the model names no base_kv for records",
                   "add base_kv under [record] in the plant file, or give per-unit values");
    if (std::exchange(used[q], true))
      problems.add(fmt::format("column '{}'", name), where, "another column gives the same quantity",
                   "leave one of " + names_of(meaning->quantity));
    chosen.push_back(i);
  }
  check_missing(used, options.power, where, about, problems);
  if (!others.empty()) about.notes.push_back("Other terminals in the file: " + listed(others) + ".");
  return chosen;
}

Record build_record(RawRecord raw, const RecordBase& base, SampleFaults faults, Problems problems,
                    const std::string& file) {
  Record r = std::move(raw.about);
  r.base = base;
  std::vector<double> current, angle;
  for (auto& column : raw.columns) {
    for (double& v : column.values) v = to_record_units(column.meaning, v, base);
    if (auto* to = channel(r, column.meaning.quantity))
      *to = std::move(column.values);
    else
      (column.meaning.quantity == Quantity::I ? current : angle) = std::move(column.values);
    if (column.meaning.quantity == Quantity::time)
      raw.time_resolution = to_record_units(column.meaning, raw.time_resolution, base);
  }
  check_magnitudes(r, faults);
  settle_times(r.t, raw.time_resolution, r, faults);
  faults.tell(problems, file);
  if (r.samples() < kFewestSamples)
    problems.add(fmt::format("{} samples", r.samples()), file,
                 fmt::format("a record needs at least {}", kFewestSamples), "give a longer record");
  problems.raise();
  if (r.P.empty() || r.Q.empty()) {
    r.P.clear();
    r.Q.clear();
    if (!current.empty() && !angle.empty()) power_from_current(r, current, angle);
  }
  if (std::abs(r.t.front()) > 1e6) {  // seconds since an epoch: reports could not show them
    r.start = fmt::format("{:.6f} s", r.t.front());
    for (std::size_t k = r.t.size(); k-- > 0;) r.t[k] -= r.t.front();
  }
  r.theta_as_written = r.theta;
  unwrap(r.theta);
  return r;
}

}  // namespace swingbank::validate::record
