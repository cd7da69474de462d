// COMTRADE channels as a record: phasors as they are, waveforms by way of phasors.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "base/constants.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/detail/phasor.hpp"
#include "validate/record/detail/times.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

constexpr double kFewestPerCycle = 8;  ///< samples of a waveform

/// 0, 1, 2 for phases a, b, c in their usual spellings; 3 for a voltage between two phases.
std::optional<std::size_t> phase_of(std::string_view text) {
  static const std::map<std::string, std::size_t, std::less<>> names = {
      {"a", 0},  {"an", 0}, {"ag", 0}, {"r", 0},   {"rn", 0},  {"l1", 0},  {"l1n", 0}, {"1", 0},  {"b", 1},
      {"bn", 1}, {"bg", 1}, {"s", 1},  {"sn", 1},  {"l2", 1},  {"l2n", 1}, {"2", 1},   {"c", 2},  {"cn", 2},
      {"cg", 2}, {"t", 2},  {"tn", 2}, {"l3", 2},  {"l3n", 2}, {"3", 2},   {"ab", 3},  {"bc", 3}, {"ca", 3},
      {"rs", 3}, {"st", 3}, {"tr", 3}, {"l12", 3}, {"l23", 3}, {"l31", 3}};
  const auto found = names.find(normalised(text));
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

struct Wave {
  const ComtradeChannel* channel;
  bool voltage;
  std::size_t phase;
  double scale;  ///< to kV or kA
};

/// A phase voltage or current of which the unit and the phase are known.
std::optional<Wave> wave_of(const ComtradeChannel& c) {
  const std::string unit = normalised(c.unit), id = normalised(c.id);
  const bool volt = unit == "v" || unit == "kv", ampere = unit == "a" || unit == "ka";
  if (!volt && !ampere) return std::nullopt;
  auto phase = phase_of(c.phase);
  if (!phase && id.size() > 1 && std::string_view(volt ? "vue" : "i").find(id[0]) != std::string_view::npos)
    phase = phase_of(std::string_view(id).substr(1));
  if (!phase) return std::nullopt;
  return Wave{&c, volt, *phase, unit[0] == 'k' ? 1.0 : 1e-3};
}

/// The three phases of a kind, or a problem.
class Choice {
 public:
  Choice(const std::vector<Wave>& waves, const Comtrade& comtrade, const ReadOptions& options,
         Problems& problems)
      : waves_(waves), file_(comtrade.file), options_(options), problems_(problems) {}

  std::array<const Wave*, 3> phases(bool voltage) {
    const char* const kind = voltage ? "voltage" : "current";
    std::array<const Wave*, 3> chosen{};
    std::set<std::string> components;
    bool twice = false;
    for (const Wave& w : waves_) {
      if (w.voltage != voltage || w.phase > 2) continue;
      components.insert(w.channel->component);
      if (!options_.terminal.empty() && w.channel->component != options_.terminal && several(voltage))
        continue;
      twice = twice || chosen[w.phase];
      chosen[w.phase] = &w;
    }
    std::string names;
    for (const auto& c : components) names += (names.empty() ? "" : ", ") + c;
    if (twice)
      problems_.add(fmt::format("several three-phase {}s", kind), file_, "their circuits are " + names,
                    "choose one: FILE#CIRCUIT");
    else if (!chosen[0] || !chosen[1] || !chosen[2])
      problems_.add(
          fmt::format("no three-phase {}", kind), file_,
          std::ranges::any_of(waves_, [&](const Wave& w) { return w.voltage == voltage && w.phase == 3; })
              ? "voltages between phases are not read"
              : fmt::format("waveforms need channels of phases A, B and C in {}",
                            voltage ? "V or kV" : "A or kA"),
          "export all three, from phase to neutral");
    return twice ? std::array<const Wave*, 3>{} : chosen;
  }

 private:
  /// More than one channel of a phase: then the circuit's name decides.
  [[nodiscard]] bool several(bool voltage) const {
    int count[3] = {};
    for (const Wave& w : waves_)
      if (w.voltage == voltage && w.phase < 3) ++count[w.phase];
    return *std::ranges::max_element(count) > 1;
  }
  const std::vector<Wave>& waves_;
  const std::string& file_;
  const ReadOptions& options_;
  Problems& problems_;
};

PhasorTrack phasors(const std::array<const Wave*, 3>& phases, const Comtrade& comtrade, double nominal,
                    double rate, SampleFaults& faults) {
  Waveforms w;
  w.rate = static_cast<double>(comtrade.t.size() - 1) / (comtrade.t.back() - comtrade.t.front());
  for (std::size_t p = 0; p < 3; ++p) {
    const ComtradeChannel& c = *phases[p]->channel;
    w.skew[p] = c.skew;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      if (!std::isfinite(c.values[k]))
        faults.add(c.id, c.id, k, "the value is marked missing",
                   "cut the record before it, or export it again");
      w.samples[p].push_back(c.values[k] * phases[p]->scale);
    }
  }
  PhasorTrack track = positive_sequence(w, nominal, rate);
  // Times and angles count from the record's first sample, which may be none of those that are used.
  const double begin = comtrade.t.front();
  for (double& t : track.t) t += begin;
  for (auto& x : track.x) x *= std::polar(1.0, -constants::turn * nominal * begin);
  return track;
}

RawColumn column(std::string name, Quantity q, Unit u, std::vector<double> values) {
  return {std::move(name), {q, u, false, {}, false}, std::move(values)};
}

Record from_waveforms(const Comtrade& comtrade, const std::vector<Wave>& waves, Record about,
                      const RecordBase& base, const ReadOptions& options) {
  Problems problems;
  SampleFaults faults([&](std::size_t first, std::size_t last) { return comtrade.where(first, last); });
  Choice choice(waves, comtrade, options, problems);
  const auto v = choice.phases(true), i = choice.phases(false);
  if (!(base.kv > 0))
    problems.add("waveforms", comtrade.file, "the model names no base_kv for records",
                 "add base_kv (line to line) under [record] in the plant file");
  if (comtrade.nominal > 0 && std::abs(comtrade.nominal - base.frequency) > 0.5)
    problems.add(fmt::format("a record of a {:g} Hz grid", comtrade.nominal), comtrade.file,
                 fmt::format("the model is for {:g} Hz", base.frequency),
                 "set frequency_hz in the plant file, or take that plant's own record");
  // Evenly spaced, or the phasors mean nothing: a gap in waveforms is not bridged.
  const EvenRows even = settle_rows({.t = comtrade.t,
                                     .resolution = comtrade.resolution,
                                     .same = [](std::size_t, std::size_t) { return false; }},
                                    about, faults);
  const std::vector<double>& t = even.t;
  for (std::size_t k = 0; k < even.place.size(); ++k)
    if (even.place[k] != static_cast<double>(k)) {
      faults.add("step", "waveforms that are not evenly sampled", std::min(k, comtrade.t.size() - 1),
                 "samples are missing or repeated there",
                 "take the stretch before or after it (--until, --from)");
      break;
    }
  const double rate = options.phasor_rate > 0 ? options.phasor_rate : base.frequency;
  const double sampled = t.size() > 1 ? 1 / (t[1] - t[0]) : 0;
  if (t.size() > 1 && !(sampled >= kFewestPerCycle * base.frequency))
    problems.add(fmt::format("waveforms at {:.4g} samples per second", sampled), comtrade.file,
                 fmt::format("a cycle needs at least {:g} samples", kFewestPerCycle),
                 "export the record at a higher rate");
  faults.tell(problems, comtrade.file);
  problems.raise();
  const PhasorTrack voltage = phasors(v, comtrade, base.frequency, rate, faults);
  const PhasorTrack current = phasors(i, comtrade, base.frequency, rate, faults);
  RawRecord raw;
  std::vector<double> size, angle, p, q;
  for (std::size_t k = 0; k < voltage.t.size(); ++k) {
    const auto s = 3.0 * voltage.x[k] * std::conj(current.x[k]);  // MVA from kV to neutral and kA
    size.push_back(std::abs(voltage.x[k]));
    angle.push_back(std::arg(voltage.x[k]));
    p.push_back(s.real());
    q.push_back(s.imag());
  }
  raw.columns = {column("t", Quantity::time, Unit::second, voltage.t),
                 column("V", Quantity::V, Unit::kilovolt_ln, std::move(size)),
                 column("theta", Quantity::theta, Unit::radian, std::move(angle)),
                 column("P", Quantity::P, Unit::megawatt, std::move(p)),
                 column("Q", Quantity::Q, Unit::megavar, std::move(q))};
  about.notes.push_back(
      fmt::format("Waveforms at {:.6g} per second became positive-sequence phasors at {:g} per second: "
                  "window of one cycle of "
                  "{:g} Hz, stamped in its middle.",
                  sampled, rate, base.frequency));
  raw.about = std::move(about);
  return build_record(std::move(raw), base, options, std::move(faults), std::move(problems), comtrade.file);
}

Record from_phasors(const Comtrade& comtrade, Record about, const RecordBase& base,
                    const ReadOptions& options) {
  Problems problems;
  std::vector<Heading> headings;
  for (const auto& c : comtrade.channels) headings.push_back({c.id, column_meaning(c.id, c.unit), c.unit});
  // Where a quantity comes more than once, the circuits tell the terminals apart.
  std::map<std::pair<Quantity, std::string>, int> seen;
  bool twice = false;
  for (const auto& h : headings)
    if (h.meaning) twice = ++seen[{h.meaning->quantity, h.meaning->terminal}] > 1 || twice;
  for (std::size_t c = 0; c < headings.size(); ++c)
    if (twice && headings[c].meaning && headings[c].meaning->terminal.empty())
      headings[c].meaning->terminal = comtrade.channels[c].component;
  headings.push_back({"t_s", ColumnMeaning{Quantity::time, Unit::second, false, {}, false}});
  const auto chosen = choose_columns(headings, options, base, comtrade.file, about, problems);
  problems.raise();
  SampleFaults faults([&](std::size_t first, std::size_t last) { return comtrade.where(first, last); });
  RawRecord raw;
  for (const auto i : chosen) {
    const bool time = i + 1 == headings.size();
    raw.columns.push_back(
        {headings[i].name, *headings[i].meaning, time ? comtrade.t : comtrade.channels[i].values});
    if (time) continue;
    const ComtradeChannel& c = comtrade.channels[i];
    for (std::size_t k = 0; k < c.values.size(); ++k)
      if (!std::isfinite(c.values[k]))
        faults.lose(c.id, c.id, k, "the value is marked missing",
                    "fill it at the source, or cut the record before it");
    if (c.skew != 0)
      about.notes.push_back(
          fmt::format("Channel {} has a skew of {:.3g} ms, which was left as it is.", c.id, 1e3 * c.skew));
  }
  raw.time_resolution = comtrade.resolution;
  raw.about = std::move(about);
  return build_record(std::move(raw), base, options, std::move(faults), std::move(problems), comtrade.file);
}

}  // namespace

Record record_of_comtrade(const Comtrade& given, const std::string& name, const RecordBase& base,
                          const ReadOptions& options) {
  Comtrade comtrade = given;
  Record about;
  about.name = name;
  about.format = fmt::format("COMTRADE {} {}", comtrade.revision, comtrade.kind);
  about.start = comtrade.start;
  bool voltage = false, current = false;
  for (const auto& c : comtrade.channels)
    if (const auto w = wave_of(c)) (w->voltage ? voltage : current) = true;
  const bool waveforms = voltage && current && options.columns.empty();
  Problems problems;
  make_even(comtrade, waveforms ? kFewestPerCycle * base.frequency : 0, problems);
  problems.raise();
  about.notes = comtrade.notes;
  if (!waveforms) return from_phasors(comtrade, std::move(about), base, options);
  std::vector<Wave> waves;
  for (const auto& c : comtrade.channels)
    if (const auto w = wave_of(c)) waves.push_back(*w);
  return from_waveforms(comtrade, waves, std::move(about), base, options);
}

}  // namespace swingbank::validate::record
