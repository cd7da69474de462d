// Derived quantities of a dataset config (samples of a record, bytes of a draw, number of databank samples),
// and its canonical text for hashing.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "mpi/draw/dataset_config.hpp"
#include "sim/grid/case_words.hpp"

namespace swingbank::mpi::draw {

std::size_t RecordConfig::samples() const {
  return static_cast<std::size_t>(std::floor(t_end * rate + 1e-9));
}

const sim::Effect& DatasetConfig::effect() const { return *library.find(model); }

const sim::Effect& DatasetConfig::effect_of(const Box& b) const {
  return b.effect == nullptr ? effect() : *b.effect;
}

const sim::Parameter& DatasetConfig::record_of(const Box& b) const {
  return effect_of(b).parameters[static_cast<std::size_t>(b.index)];
}

std::string DatasetConfig::name_of(const Box& b) const {
  const std::string effect(b.effect == nullptr ? "" : b.effect->name);
  return sim::plant::ParameterName{effect, std::string(record_of(b).name)}.text();
}

std::vector<const sim::Effect*> DatasetConfig::other_effects() const {
  std::vector<const sim::Effect*> all;
  for (const auto& b : box)
    if (b.effect != nullptr && std::ranges::find(all, b.effect) == all.end()) all.push_back(b.effect);
  return all;
}

std::uint64_t DatasetConfig::bytes_per_draw() const {
  const std::size_t values = record.samples() * record.channels.size();
  const auto has = [&](const char* name) {
    return std::ranges::find(record.channels, name) != record.channels.end();
  };
  std::size_t row = record.int16 ? 2 * values + 8 * record.channels.size() : 4 * values;
  if (has("theta") || has("frequency")) row += record.samples();  // angle_valid
  row += 8 * (box.size() + 9);                                    // parameters, ids, fault, spread, base
  return row * (vary == Vary::all ? generators.size() : 1) + 17;
}

std::uint64_t DatasetConfig::points() const {
  const std::uint64_t groups = (draws + fault.per_point - 1) / fault.per_point;
  return vary == Vary::all ? groups * generators.size() : groups;
}

namespace {
/// Returns an attachment as "30:SEXS:TAoverTB=0.1,TB=10,…" with every parameter, so that a changed default
/// changes the hash.
std::string written(const sim::plant::Attachment& a) {
  std::string text = a.plant + ":" + std::string(a.block.effect->name);
  for (std::size_t i = 0; i < a.block.p.size(); ++i)
    text += fmt::format("{}{}={}", i == 0 ? ":" : ",", a.block.effect->parameters[i].name, a.block.p[i]);
  return text;
}
}  // namespace

std::string DatasetConfig::canonical() const {
  std::string text;
  const auto line = [&](std::string_view key, const auto& value) {
    text += fmt::format("{} = {}\n", key, value);
  };
  // The keys of this group give no line at their default value, so that older configs keep their hash.
  const sim::grid::CaseOptions& o = grid_case;
  const auto choice = [&](std::string_view key, const std::vector<std::string>& words, auto chosen) {
    if (const auto at = static_cast<std::size_t>(chosen); at > 0) line(key, words[at]);
  };
  if (!o.dyr.ignore.empty()) line("ignore_models", o.dyr.ignore);
  for (const auto& [from, to] : o.dyr.map) line("map_models", from + "=" + to);
  if (o.raw.frequency_hz) line("frequency_hz", *o.raw.frequency_hz);
  if (o.raw.version != 0) line("raw_version", o.raw.version);
  if (o.net_generators) line("net_generators", true);
  if (widen_limits) line("widen_limits", true);
  if (o.start_from_file) line("start", "file");
  if (!o.flow.reactive_limits) line("q_limits", "ignore");
  if (o.drop_refused) line("drop_refused", true);
  choice("repeated", sim::grid::kRepeatedWords, o.raw.repeated);
  choice("complete_records", sim::grid::kLackingWords, o.complete_records);
  choice("devices", sim::grid::kDeviceWords, o.raw.devices);
  for (const auto& a : attachments) line("attach", written(a));
  line("convention", psse ? "psse" : "andes");
  line("draws", draws);
  line("draws_per_shard", draws_per_shard);
  line("seed", seed);
  line("vary.who", vary == Vary::all ? "all" : "one");
  line("vary.generators", generators);
  if (!ids.empty()) line("vary.ids", ids);
  line("vary.model", model);
  for (const auto& b : box)
    line((b.effect == nullptr ? "vary.box." : "vary.effects.") + name_of(b),
         std::vector<double>{b.low, b.high});
  line("databank.policy", databank.policy == Policy::literal ? "literal" : "physical");
  line("databank.distance", databank.distance);
  line("databank.scale", databank.scaled ? "scaled" : "raw");
  line("fault.buses", fault.buses);
  line("fault.except", fault.except);
  line("fault.start", fault.start);
  line("fault.duration", std::vector<double>{fault.shortest, fault.longest});
  line("fault.impedance", std::vector<double>{fault.r, fault.x});
  line("fault.per_point", fault.per_point);
  line("record.t_end", record.t_end);
  line("record.rate", record.rate);
  if (record.int16) line("record.storage", "int16");
  line("record.channels", fmt::format("{}", fmt::join(record.channels, ", ")));
  line("record.frequency", std::vector<double>{record.frequency.washout, record.frequency.filter});
  line("kernel.tolerance", tolerance);
  if (operating_point) {
    const OperatingPointConfig& p = *operating_point;
    line("operating_point.per_block", p.per_block);
    line("operating_point.loads", std::vector<double>{p.loads_low, p.loads_high});
    line("operating_point.load_spread", p.load_spread);
    line("operating_point.dispatch", std::vector<double>{p.dispatch_low, p.dispatch_high});
    line("operating_point.voltage", p.voltage);
    line("operating_point.loading", std::vector<double>{p.loading_low, p.loading_high});
    line("operating_point.oversized",
         std::vector<double>{p.oversized_share, p.oversized_low, p.oversized_high});
    line("operating_point.lines_out", std::vector<int>{p.lines_out_low, p.lines_out_high});
  }
  return text;
}

}  // namespace swingbank::mpi::draw
