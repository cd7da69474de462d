#include "mpi/draw/dataset_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/config.hpp"
#include "sim/grid/attach.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::mpi::draw {

namespace fs = std::filesystem;

namespace {

std::vector<int> numbers(const std::vector<std::int64_t>& v) { return {v.begin(), v.end()}; }
const Range kBusNumber{1, 999997, ""};
const Range kCount{1, 1e10, ""};  // 1e10 rows are 400 TB
const Range kShardDraws{1, 1e6, ""}, kSeed{0, 9e18, ""}, kRate{1.0, 1e5, "1/s"};
const Range kShardSize{0.001, 1e5, "MB"};
constexpr double kUsualShard = 64.0;  ///< default size of a shard [MB], about 1 s of core time

std::string parameter_list(const sim::Effect& e) {
  std::string all;
  for (const auto& p : e.parameters)
    if (!p.is_code()) all += (all.empty() ? "" : ", ") + std::string(p.name);
  return all.empty() ? "none" : all;
}

/// Reads a table of boxes: "name = [low, high]" is sampled, "name = value" is fixed. The parameters' records
/// give the allowed ranges. `owner`: the effect, nullptr for the machine.
void read_box(Config& c, const std::string& table, const sim::Effect& effect, const sim::Effect* owner,
              std::vector<Box>& box) {
  std::vector<Box> found;
  for (const auto& name : c.keys(table)) {
    const std::string key = table + "." + name;
    const int index = effect.parameter_index(name);
    if (index < 0 || effect.parameters[static_cast<std::size_t>(index)].is_code()) {
      c.problem(key, (index < 0 ? "unknown parameter " : "parameter ") + name,
                std::string(effect.name) +
                    (index < 0 ? " has no such parameter" : " takes it as a code, which is never sampled"),
                "use one of: " + parameter_list(effect));
      c.ignore(key);
      continue;
    }
    const auto& record = effect.parameters[static_cast<std::size_t>(index)];
    const Range possible{record.low, record.high, std::string(record.unit)};
    if (c.is_array(key)) {
      const auto [low, high] = c.interval(key, possible);
      found.push_back({index, low, high, owner});
    } else {
      const double value = c.require<double>(key, possible);
      found.push_back({index, value, value, owner});
    }
  }
  std::ranges::sort(found, {}, &Box::index);
  box.insert(box.end(), found.begin(), found.end());
}

/// Returns whether an effect is a machine with a rotor. Records contain rotor angles, which converters lack.
bool is_machine(const sim::Effect& effect) { return effect.slot == sim::Slot::machine && !effect.converter; }

std::string machines(const sim::library::EffectLibrary& library) {
  std::string names;
  for (const sim::Effect* e : library.all())
    if (is_machine(*e)) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return names;
}

/// Reads [vary.effects.NAME]: parameters of effects other than the machine.
void read_effect_boxes(Config& c, const sim::library::EffectLibrary& library, std::vector<Box>& box) {
  std::vector<std::pair<const sim::Effect*, std::string>> tables;
  for (const auto& name : c.keys("vary.effects")) {
    const std::string table = "vary.effects." + name;
    const sim::Effect* effect = library.find(name);
    const auto known = [&](const auto& t) { return t.first == effect; };
    std::string why;
    if (effect == nullptr)
      why = "there is no such effect; user-defined models are listed under `laws`";
    else if (effect->slot == sim::Slot::machine)
      why = "it is a machine, whose parameters are given in [vary.box]";
    else if (effect->slot != sim::Slot::transformer && !sim::is_control(effect->slot))
      why = "it is a " + std::string(sim::slot_name(effect->slot)) + ", no part of a plant's equations";
    else if (std::ranges::any_of(tables, known))
      why = "another table of this config names the same effect";
    else {
      tables.emplace_back(effect, table);
      continue;
    }
    c.problem(table, "effect " + name, why, "name an effect that the varied generators have");
    c.ignore(table);
  }
  std::ranges::sort(tables, {},
                    [](const auto& t) { return std::pair(t.first->slot, std::string(t.first->name)); });
  for (const auto& [effect, table] : tables) read_box(c, table, *effect, effect, box);
}

/// Reads `user_models` and `attach`. User-defined models come first, because they may be attached and varied.
void read_effects(Config& c, DatasetConfig& d) {
  for (const auto& text : c.optional<std::vector<std::string>>("laws", {})) {
    d.user_models.push_back((c.name().parent_path() / text).lexically_normal());
    try {
      sim::user_models::load_user_model(d.user_models.back(), d.library);
    } catch (const InputError& e) {
      for (const auto& p : e.problems()) c.problem("laws", p.what, p.where + ": " + p.why, p.remedy);
    }
  }
  Problems problems;
  for (const auto& text : c.optional<std::vector<std::string>>("attach", {})) {
    d.attachments.push_back(
        sim::plant::read_attachment(text, d.library, "attach = '" + text + "'", problems));
    const sim::Effect* effect = d.attachments.back().block.effect;
    if (effect != nullptr && effect->slot == sim::Slot::measurement)
      problems.add(std::string(effect->name), "attach = '" + text + "'",
                   "a dataset contains the plant's response, not an instrument's error", "leave it out");
  }
  for (const auto& p : problems.list()) c.problem("attach", p.what, p.where + ": " + p.why, p.remedy);
}

/// Returns the values that occur more than once in a list, each once.
template <class T>
std::vector<T> repeated(std::vector<T> list) {
  std::vector<T> found;
  std::ranges::sort(list);
  for (std::size_t i = 1; i < list.size(); ++i)
    if (list[i] == list[i - 1] && (found.empty() || found.back() != list[i])) found.push_back(list[i]);
  return found;
}

CaseConfig read_mend(Config& c) {
  CaseConfig mend;
  mend.raw_version = static_cast<int>(c.optional<std::int64_t>("raw_version", 0, {0.0, 35.0, ""}));
  mend.net_generators = c.optional<bool>("net_generators", false);
  mend.widen_limits = c.optional<bool>("widen_limits", false);
  mend.start_from_file = c.choice("start", {"solved", "file"}, "solved") == "file";
  mend.reactive_limits = c.choice("q_limits", {"enforce", "ignore"}, "enforce") == "enforce";
  mend.drop_refused = c.optional<bool>("drop_refused", false);
  mend.repeated = c.choice("repeated", {"refuse", "keep", "voltages"}, "refuse");
  mend.complete_records = c.choice("complete_records", {"no", "zero", "standard"}, "no");
  mend.devices = c.choice("devices", {"checked", "file", "none"}, "checked");
  return mend;
}

void read_vary(Config& c, DatasetConfig& d) {
  d.vary = c.choice("vary.who", {"one", "all"}) == "all" ? Vary::all : Vary::one;
  d.generators = numbers(c.require<std::vector<std::int64_t>>("vary.generators", kBusNumber));
  if (c.has("vary.generators") && d.generators.empty())
    c.problem("vary.generators", "no generator", "a dataset varies at least one",
              "list bus numbers of generators");
  d.ids = c.optional<std::vector<std::string>>("vary.ids", {});
  if (!d.ids.empty() && d.ids.size() != d.generators.size())
    c.problem("vary.ids", fmt::format("{} ids for {} generators", d.ids.size(), d.generators.size()),
              "each names the unit at the bus of the same place in vary.generators",
              "give one for each, \"\" where the bus has one unit");
  for (const int number : repeated(d.generators))
    c.problem("vary.generators", fmt::format("generator {} twice", number), "each varies once",
              "name it once");
  d.model = c.require<std::string>("vary.model");
  const sim::Effect* effect = d.library.find(d.model);
  if (effect == nullptr || !is_machine(*effect)) {
    if (!d.model.empty())
      c.problem("vary.model", "model " + d.model, "it is no machine model of this program",
                "use one of: " + machines(d.library));
    c.ignore("vary.box");  // cannot be checked without the model
    return;
  }
  d.model = effect->name;
  read_box(c, "vary.box", *effect, nullptr, d.box);
  read_effect_boxes(c, d.library, d.box);
  if (std::ranges::none_of(d.box, &Box::sampled))
    c.problem("vary.box", "no parameter varies", "no entry of [vary.box] or [vary.effects.…] is an interval",
              "write at least one as name = [low, high]");
}

void read_fault(Config& c, FaultConfig& f) {
  if (c.is_text("fault.buses"))
    c.choice("fault.buses", {"any"});
  else
    f.buses = numbers(c.require<std::vector<std::int64_t>>("fault.buses", kBusNumber));
  f.except = numbers(c.optional<std::vector<std::int64_t>>("fault.except", {}, kBusNumber));
  f.start = c.optional<double>("fault.start", f.start, {0.0, 1e4, "s"});
  std::tie(f.shortest, f.longest) = c.interval("fault.duration", {1e-4, 100.0, "s"});
  f.r = c.optional<double>("fault.r", 0.0, {0.0, 1e3, "pu"});
  f.x = c.optional<double>("fault.x", 0.0, {0.0, 1e3, "pu"});
  f.per_point = static_cast<std::uint64_t>(c.optional<std::int64_t>("fault.per_point", 1, kCount));
}

void read_record(Config& c, RecordConfig& r) {
  r.t_end = c.require<double>("record.t_end", {0.01, 1e4, "s"});
  r.rate = c.require<double>("record.rate", kRate);
  r.int16 = c.choice("record.storage", {"float32", "int16"}, "float32") == "int16";
  r.channels = c.require<std::vector<std::string>>("record.channels");
  std::vector<std::string> known;
  for (const auto& k : sim::kChannels) known.emplace_back(k.name);
  known.emplace_back("frequency");
  for (const auto& name : r.channels)
    if (std::ranges::find(known, name) == known.end())
      c.problem("record.channels", "channel '" + name + "'", "there is no such channel",
                fmt::format("use some of: {}", fmt::join(known, ", ")));
  if (c.has("record.channels") && r.channels.empty())
    c.problem("record.channels", "no channel", "a record holds at least one",
              fmt::format("use some of: {}", fmt::join(known, ", ")));
  for (const auto& name : repeated(r.channels))
    c.problem("record.channels", "channel '" + name + "' twice", "a record holds each once", "name it once");
  if (std::ranges::find(r.channels, "frequency") == r.channels.end()) return;
  r.frequency.washout = c.require<double>("record.frequency_washout", {1e-3, 100.0, "s"});
  r.frequency.filter = c.require<double>("record.frequency_filter", {1e-3, 100.0, "s"});
  if (r.frequency.washout == r.frequency.filter && r.frequency.filter > 0)
    c.problem("record.frequency_filter", "frequency_filter equal to frequency_washout",
              "the filter's two time constants must differ", "change one of them");
}

void read_databank(Config& c, DatabankConfig& b) {
  b.policy = c.choice("databank.policy", {"physical", "literal"}, "physical") == "literal" ? Policy::literal
                                                                                           : Policy::physical;
  b.distance = c.require<double>("databank.distance", {0.0, 1e6, ""});
  b.scaled = c.choice("databank.scale", {"raw", "scaled"}, "raw") == "scaled";
  b.candidates_per_point =
      c.optional<double>("databank.candidates_per_point", b.candidates_per_point, {1.0, 1e9, ""});
}

/// Reads [operating_point], if present.
void read_operating_point(Config& c, std::optional<OperatingPointConfig>& point) {
  if (!c.has("operating_point")) return;
  OperatingPointConfig p;
  const auto interval = [&](const char* key, double& low, double& high, const Range& range) {
    if (c.has(key)) std::tie(low, high) = c.interval(key, range);
  };
  p.per_block = static_cast<std::uint64_t>(c.optional<std::int64_t>("operating_point.per_block", 2, kCount));
  interval("operating_point.loads", p.loads_low, p.loads_high, {0.01, 10.0, ""});
  p.load_spread = c.optional<double>("operating_point.load_spread", 0.0, {0.0, 0.99, ""});
  interval("operating_point.dispatch", p.dispatch_low, p.dispatch_high, {0.01, 10.0, ""});
  p.voltage = c.optional<double>("operating_point.voltage", 0.0, {0.0, 0.2, "pu"});
  interval("operating_point.loading", p.loading_low, p.loading_high, {0.001, 2.0, ""});
  p.oversized_share = c.optional<double>("operating_point.oversized_share", 0.0, {0.0, 1.0, ""});
  interval("operating_point.oversized", p.oversized_low, p.oversized_high, {1.0, 1000.0, ""});
  double low = 0.0, high = 0.0;
  interval("operating_point.lines_out", low, high, {0.0, 100.0, ""});
  p.lines_out_low = static_cast<int>(low);
  p.lines_out_high = static_cast<int>(high);
  if (low != p.lines_out_low || high != p.lines_out_high)
    c.problem("operating_point.lines_out", "a part of a line", "lines are counted", "give whole numbers");
  if (!p.draws_bases() && p.oversized_share > 0.0)
    c.problem("operating_point.oversized_share", "oversized machines without loading",
              "a machine's base is drawn from its loading", "give loading = [low, high] too");
  point = p;
}

}  // namespace

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
/// value changes the hash.
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
  // Optional keys at their defaults give no line, so that older configs keep their hash.
  if (!models.ignore.empty()) line("ignore_models", models.ignore);
  for (const auto& [from, to] : models.map) line("map_models", from + "=" + to);
  if (frequency_hz) line("frequency_hz", *frequency_hz);
  if (mend.raw_version != 0) line("raw_version", mend.raw_version);
  if (mend.net_generators) line("net_generators", true);
  if (mend.widen_limits) line("widen_limits", true);
  if (mend.start_from_file) line("start", "file");
  if (!mend.reactive_limits) line("q_limits", "ignore");
  if (mend.drop_refused) line("drop_refused", true);
  if (mend.repeated != "refuse") line("repeated", mend.repeated);
  if (mend.complete_records != "no") line("complete_records", mend.complete_records);
  if (mend.devices != "checked") line("devices", mend.devices);
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

namespace {
/// Throws InputError if an override is outside the range of its key in the config.
void require_in_range(const Overrides& o) {
  Problems problems;
  const auto check = [&](const std::optional<std::uint64_t>& value, const char* option, double high) {
    if (value && static_cast<double>(*value) > high)
      problems.add(std::to_string(*value), option, fmt::format("it must be at most {:.0f}", high),
                   "give a smaller number");
  };
  check(o.draws, "--draws", kCount.high);
  check(o.faults_per_point, "--faults-per-point", kCount.high);
  check(o.draws_per_shard, "--draws-per-shard", kShardDraws.high);
  check(o.seed, "--seed", kSeed.high);
  const auto within = [&](const std::optional<double>& value, const char* option, const Range& range) {
    if (value && !(*value >= range.low && *value <= range.high))
      problems.add(fmt::format("{:g}", *value), option,
                   fmt::format("it must lie between {:g} and {:g} {}", range.low, range.high, range.unit),
                   "give such a number");
  };
  within(o.shard_megabytes, "--shard-megabytes", kShardSize);
  within(o.rate, "--rate", kRate);
  if (o.shard_megabytes && o.draws_per_shard)
    problems.add("two sizes of a shard", "--shard-megabytes", "--draws-per-shard gives another", "give one");
  problems.raise();
}
}  // namespace

namespace {

/// Reads the size of a shard: `draws_per_shard`, or `shard_megabytes` (default kUsualShard), which is
/// returned [MB].
std::optional<double> read_shard_size(Config& c, DatasetConfig& d) {
  if (c.has("draws_per_shard")) {
    d.draws_per_shard = static_cast<std::uint64_t>(c.require<std::int64_t>("draws_per_shard", kShardDraws));
    if (!c.has("shard_megabytes")) return std::nullopt;
    c.problem("shard_megabytes", "two sizes of a shard", "draws_per_shard gives another", "leave one out");
  }
  return c.optional<double>("shard_megabytes", kUsualShard, kShardSize);
}

/// Keeps only the requested channels, in the config's order. Throws InputError for an unknown channel.
void keep_channels(RecordConfig& r, const std::vector<std::string>& asked, const fs::path& file) {
  if (asked.empty()) return;
  Problems problems;
  for (const auto& name : asked)
    if (std::ranges::find(r.channels, name) == r.channels.end())
      problems.add("channel '" + name + "'", "--channels", file.string() + " does not record it",
                   fmt::format("use some of: {}", fmt::join(r.channels, ", ")));
  problems.raise();
  std::erase_if(r.channels, [&](const auto& n) { return std::ranges::find(asked, n) == asked.end(); });
}

void override_with(DatasetConfig& d, const Overrides& o, std::optional<double> megabytes) {
  d.draws = o.draws.value_or(d.draws);
  d.seed = o.seed.value_or(d.seed);
  d.fault.per_point = o.faults_per_point.value_or(d.fault.per_point);
  d.record.rate = o.rate.value_or(d.record.rate);
  d.record.int16 = d.record.int16 || o.int16;
  keep_channels(d.record, o.channels, d.file);
  d.draws_per_shard = o.draws_per_shard.value_or(d.draws_per_shard);
  if (o.shard_megabytes) megabytes = o.shard_megabytes;
  if (o.draws_per_shard || !megabytes) return;
  const double draws = *megabytes * 1e6 / static_cast<double>(d.bytes_per_draw());
  d.draws_per_shard = static_cast<std::uint64_t>(std::clamp(draws, kShardDraws.low, kShardDraws.high));
}

}  // namespace

DatasetConfig read_dataset_config(const fs::path& file, const Overrides& overrides) {
  Config c(file);
  DatasetConfig d;
  d.file = file;
  d.raw = c.file("raw");
  d.dyr = c.file("dyr");
  d.models = sim::formats::read_dyr_options(c, "");
  if (c.has("frequency_hz")) d.frequency_hz = c.require<double>("frequency_hz", {1.0, 1000.0, "Hz"});
  d.mend = read_mend(c);
  d.psse = c.choice("convention", {"psse", "andes"}) != "andes";
  d.draws = static_cast<std::uint64_t>(c.require<std::int64_t>("draws", kCount));
  const auto megabytes = read_shard_size(c, d);
  d.seed = static_cast<std::uint64_t>(c.optional<std::int64_t>("seed", 1, kSeed));
  read_effects(c, d);
  read_vary(c, d);
  read_databank(c, d.databank);
  read_fault(c, d.fault);
  read_record(c, d.record);
  read_operating_point(c, d.operating_point);
  d.tolerance = c.optional<double>("kernel.tolerance", 1e-6, {1e-12, 1e-2, ""});
  d.lanes = static_cast<int>(c.optional<std::int64_t>("kernel.lanes", 0, {0, 16, ""}));
  if (d.fault.start + d.fault.longest >= d.record.t_end && d.record.t_end > 0)
    c.problem("fault.start", fmt::format("a fault until {} s", d.fault.start + d.fault.longest),
              fmt::format("the record ends at {} s", d.record.t_end),
              "let the fault end before the record does");
  c.raise();
  require_in_range(overrides);
  d.overrides = overrides;
  override_with(d, overrides, megabytes);
  return d;
}

}  // namespace swingbank::mpi::draw
