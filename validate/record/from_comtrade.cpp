// Conversion of COMTRADE channels to a record: phasors directly, waveforms via their phasors.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "base/complex.hpp"
#include "base/constants.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/detail/phasor.hpp"
#include "validate/record/detail/times.hpp"
#include "validate/record/detail/waves.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

constexpr double kMinPerCycle = 8;  ///< minimum samples of a waveform per cycle

/// Positive sequence of three waveforms [kV to neutral, kA].
struct Sequence {
  std::vector<double> t;
  std::vector<Complex> x;
};

/// Returns a channel's values in kV or kA.
std::vector<double> samples_of(const Wave& wave, SampleFaults& faults) {
  std::vector<double> samples = wave.channel->values;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!std::isfinite(samples[k]))
      faults.add(wave.channel->id, wave.channel->id, k, "the value is marked missing",
                 "end the record before it, or export it again");
    samples[k] *= wave.scale * (wave.phase.reversed ? -1 : 1);
  }
  return samples;
}

/// Returns the positive sequence of a set of waveforms. The phasors of a phase that is not recorded are the
/// negative sum of the other two.
Sequence sequence_of(const WaveSet& set, const Comtrade& comtrade, double nominal, double rate,
                     SampleFaults& faults, Problems& problems) {
  Waveforms w;
  w.rate = static_cast<double>(comtrade.t.size() - 1) / (comtrade.t.back() - comtrade.t.front());
  std::array<std::string, 3> names;
  for (std::size_t p = 0; p < 3; ++p) {
    const Wave* wave = set.waves[p];
    w.skew[p] = wave ? wave->channel->skew : 0;
    names[p] = wave ? wave->channel->id : std::string("the computed phase");
    w.samples[p] = wave ? samples_of(*wave, faults) : std::vector<double>(comtrade.t.size(), 0.0);
  }
  PhasorTrack track = phase_phasors(w, nominal, rate);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t k = 0; k < track.t.size() && !set.waves[p]; ++k)
      track.x[p][k] = -(track.x[(p + 1) % 3][k] + track.x[(p + 2) % 3][k]);
  if (const auto fault = sequence_fault(track.x, names))
    problems.add(fault->what, comtrade.file, fault->why,
                 fault->remedy + " (the .cfg defines the channels' names and phases)");
  // t = 0 is the file's first sample. make_even may have removed it: the first remaining sample is at
  // `begin`, and the phasors are turned back by this time.
  const double begin = comtrade.t.front();
  Sequence sequence;
  for (std::size_t k = 0; k < track.t.size(); ++k) {
    sequence.t.push_back(track.t[k] + begin);
    sequence.x.push_back(positive_sequence({track.x[0][k], track.x[1][k], track.x[2][k]}, set.between) *
                         std::polar(1.0, -constants::turn * nominal * begin));
  }
  return sequence;
}

/// Adds notes to the record if a quantity is given line to line or by two channels only.
void note_set(const WaveSet& set, bool voltage, Record& about) {
  if (set.between)
    about.notes.emplace_back(
        "The voltages are line to line. Their positive sequence was divided by sqrt(3) and delayed by 30 "
        "degrees.");
  for (std::size_t p = 0; p < 3; ++p)
    if (!set.waves[p])
      about.notes.push_back(
          fmt::format("The {} {} is not recorded: it is the negative sum of the two others{}.",
                      voltage ? "voltage" : "current of phase",
                      voltage ? std::array{"AB", "BC", "CA"}[p] : std::array{"A", "B", "C"}[p],
                      voltage ? "" : ", which is valid only if no current flows to ground"));
}

RawColumn column(std::string name, Quantity q, Unit u, std::vector<double> values) {
  return {std::move(name), {q, u, false, {}, false}, std::move(values)};
}

/// Checks that the requested circuit exists in the file.
void check_terminal(const std::vector<Wave>& waves, const ReadOptions& options, const std::string& file,
                    Problems& problems) {
  std::set<std::string> circuits;
  for (const Wave& w : waves)
    if (!w.circuit.empty()) circuits.insert(w.circuit);
  const auto same = [&](const std::string& c) { return normalised(c) == normalised(options.terminal); };
  if (options.terminal.empty() || std::ranges::any_of(circuits, same)) return;
  problems.add(fmt::format("no circuit '{}'", options.terminal), file,
               circuits.empty() ? "neither the channels' circuits nor their names identify one"
                                : fmt::format("the file has {}", fmt::join(circuits, ", ")),
               circuits.empty() ? fmt::format("remove '#{}' from the file name", options.terminal)
                                : "choose one of them");
}

/// Keeps the samples of the requested time range, and one cycle on both sides for its first and last phasors.
/// Faults outside it are thus ignored.
void keep_range(Comtrade& c, const ReadOptions& options, double cycle) {
  std::size_t first = 0, last = c.t.size();
  while (first < last && c.t[first] < options.from - cycle) ++first;
  while (last > first && c.t[last - 1] > options.until + cycle) --last;
  const auto keep = [&](auto& values) {
    values.resize(last);
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  if (last - first < 2) return;  // reported as a range without samples
  keep(c.t);
  keep(c.places);
  for (ComtradeChannel& channel : c.channels) keep(channel.values);
}

Record from_waveforms(const Comtrade& comtrade, const std::vector<Wave>& waves, Record about,
                      const RecordBase& base, const ReadOptions& options) {
  Problems problems;
  SampleFaults faults([&](std::size_t first, std::size_t last) { return comtrade.where(first, last); });
  check_terminal(waves, options, comtrade.file, problems);
  const auto v = choose_waves(waves, true, options, comtrade.file, problems);
  const auto i = choose_waves(waves, false, options, comtrade.file, problems);
  if (!(base.kv > 0))
    problems.add("waveforms without a base voltage", comtrade.file,
                 "the plant file has no base_kv under [record]",
                 "add base_kv (line to line) under [record] in the plant file");
  if (comtrade.nominal > 0 && std::abs(comtrade.nominal - base.frequency) > 0.5)
    problems.add(fmt::format("a record of a {:g} Hz grid", comtrade.nominal), comtrade.file,
                 fmt::format("the model is for {:g} Hz", base.frequency),
                 "set frequency_hz in the plant file, or use a record of this plant");
  // Phasors require evenly spaced samples, and a gap in waveforms is not interpolated.
  const EvenRows even = settle_rows({.t = comtrade.t,
                                     .resolution = comtrade.resolution,
                                     .same = [](std::size_t, std::size_t) { return false; }},
                                    about, faults);
  const std::vector<double>& t = even.t;
  for (std::size_t k = 0; k < even.place.size(); ++k)
    if (even.place[k] != static_cast<double>(k)) {
      faults.add("step", "waveforms that are not evenly sampled", std::min(k, comtrade.t.size() - 1),
                 "samples are missing or repeated at this time",
                 "take the section before or after it (--until, --from)");
      break;
    }
  const double rate = options.phasor_rate > 0 ? options.phasor_rate : base.frequency;
  const double sampled = t.size() > 1 ? 1 / (t[1] - t[0]) : 0;
  if (t.size() < 2)
    problems.add(fmt::format("waveforms of {} sample", t.size()), comtrade.file,
                 "a phasor requires the samples of one cycle", "export the section around the event");
  else if (!(sampled >= kMinPerCycle * base.frequency))
    problems.add(fmt::format("waveforms at {:.4g} samples per second", sampled), comtrade.file,
                 fmt::format("a cycle needs at least {:g} samples", kMinPerCycle),
                 "export the record at a higher rate");
  faults.report(problems, comtrade.file);
  problems.raise();
  about.terminal = v->circuit;
  note_set(*v, true, about);
  note_set(*i, false, about);
  const Sequence voltage = sequence_of(*v, comtrade, base.frequency, rate, faults, problems);
  const Sequence current = sequence_of(*i, comtrade, base.frequency, rate, faults, problems);
  faults.report(problems, comtrade.file);
  problems.raise();
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
  // Faults of a phasor are located at the middle of its window.
  const auto middle = [&](std::size_t row) {
    return static_cast<std::size_t>(std::lround((voltage.t[row] - comtrade.t.front()) * sampled));
  };
  SampleFaults of_phasors(
      [&](std::size_t first, std::size_t last) { return comtrade.where(middle(first), middle(last)); });
  return build_record(std::move(raw), base, options, std::move(of_phasors), std::move(problems),
                      comtrade.file);
}

Record from_phasors(const Comtrade& comtrade, Record about, const RecordBase& base,
                    const ReadOptions& options) {
  Problems problems;
  std::vector<Heading> headings;
  for (const auto& c : comtrade.channels) headings.push_back({c.id, column_meaning(c.id, c.unit), c.unit});
  // If a quantity occurs more than once, the circuits distinguish the terminals.
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
                    "fill the gap at the source, or end the record before it");
    if (c.skew != 0)
      about.notes.push_back(
          fmt::format("Channel {} has a skew of {:.3g} ms, which is not corrected.", c.id, 1e3 * c.skew));
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
  make_even(comtrade, waveforms ? kMinPerCycle * base.frequency : 0, problems);
  problems.raise();
  about.notes = comtrade.notes;
  if (!waveforms) return from_phasors(comtrade, std::move(about), base, options);
  keep_range(comtrade, options, 1 / base.frequency);
  std::vector<Wave> waves;
  for (const auto& c : comtrade.channels)
    if (const auto w = wave_of(c)) waves.push_back(*w);
  return from_waveforms(comtrade, waves, std::move(about), base, options);
}

}  // namespace swingbank::validate::record
