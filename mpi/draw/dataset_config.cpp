#include "mpi/draw/dataset_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "sim/grid/attach.hpp"
#include "sim/grid/case_words.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::mpi::draw {

namespace fs = std::filesystem;

namespace {

std::vector<int> numbers(const std::vector<std::int64_t>& v) { return {v.begin(), v.end()}; }
Range bus_number(std::string meaning) { return {1, 999997, "", std::move(meaning)}; }
Range count(std::string meaning) { return {1, 1e10, "", std::move(meaning)}; }  // 1e10 rows are 400 TB
const Range kShardDraws{1, 1e6, "", "events per shard, instead of shard_megabytes"},
    kSeed{0, 9e18, "", "seed of all random numbers"}, kRate{1.0, 1e5, "1/s", "sampling rate"};
const Range kShardSize{0.001, 1e5, "MB", "size of a shard"};
constexpr double kUsualShard = 64.0;  ///< default size of a shard [MB], simulated in about 1 s of core time

/// Returns the names of the parameters that can be sampled.
std::vector<std::string> parameter_names(const sim::Effect& e) {
  std::vector<std::string> names;
  for (const auto& p : e.parameters)
    if (!p.is_code()) names.emplace_back(p.name);
  return names;
}
std::string parameter_list(const sim::Effect& e) {
  const auto names = parameter_names(e);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// Reads a table of parameters: "name = [low, high]" is sampled, "name = value" is fixed. The effect's
/// parameter list gives the allowed ranges. `owner`: the effect; nullptr for the machine.
void read_box(Config& c, const std::string& table, const sim::Effect& effect, const sim::Effect* owner,
              std::vector<Box>& box) {
  std::vector<Box> found;
  for (const auto& name : c.keys(table, parameter_names(effect))) {
    const std::string key = table + "." + name;
    const int index = effect.parameter_index(name);
    if (index < 0 || effect.parameters[static_cast<std::size_t>(index)].is_code()) {
      c.problem(key, (index < 0 ? "unknown parameter " : "parameter ") + name,
                std::string(effect.name) +
                    (index < 0 ? " has no such parameter" : " uses it as a code; codes are not sampled"),
                "use one of: " + parameter_list(effect));
      c.ignore(key);
      continue;
    }
    const auto& record = effect.parameters[static_cast<std::size_t>(index)];
    const Range possible{record.low, record.high, std::string(record.unit), std::string(record.meaning)};
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

/// Returns whether an effect other than the machine may have sampled parameters.
bool is_varied(const sim::Effect& effect) {
  return effect.slot == sim::Slot::transformer || sim::is_control(effect.slot);
}

std::vector<std::string> names_of(const sim::library::EffectLibrary& library,
                                  bool (*chosen)(const sim::Effect&)) {
  std::vector<std::string> names;
  for (const sim::Effect* e : library.all())
    if (chosen(*e)) names.emplace_back(e->name);
  return names;
}

/// Reads [vary.effects.NAME]: parameters of effects other than the machine.
void read_effect_boxes(Config& c, const sim::library::EffectLibrary& library, std::vector<Box>& box) {
  std::vector<std::pair<const sim::Effect*, std::string>> tables;
  for (const auto& name : c.keys("vary.effects", names_of(library, is_varied), "user_models")) {
    const std::string table = "vary.effects." + name;
    const sim::Effect* effect = library.find(name);
    const auto known = [&](const auto& t) { return t.first == effect; };
    std::string why;
    if (effect == nullptr)
      why = "there is no such effect; user-defined models are listed under `user_models`";
    else if (effect->slot == sim::Slot::machine)
      why = "it is a machine, whose parameters are given in [vary.box]";
    else if (!is_varied(*effect))
      why = "it is a " + std::string(sim::slot_name(effect->slot)) +
            ", which is not part of a plant's equations";
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
  for (const auto& text : c.optional<std::vector<std::string>>(
           "user_models", {},
           {.meaning = "files of user-defined models, relative to the folder of this file"})) {
    d.user_models.push_back((c.name().parent_path() / text).lexically_normal());
    try {
      sim::user_models::load_user_model(d.user_models.back(), d.library);
    } catch (const InputError& e) {
      for (const auto& p : e.problems()) c.problem("user_models", p.what, p.where + ": " + p.why, p.remedy);
    }
  }
  Problems problems;
  for (const auto& text : c.optional<std::vector<std::string>>(
           "attach", {},
           {.meaning =
                "PLANT:EFFECT:PARAM=VALUE,...: effects that the .dyr lacks; PLANT = all: every plant"})) {
    d.attachments.push_back(
        sim::plant::read_attachment(text, d.library, "attach = '" + text + "'", problems));
    const sim::Effect* effect = d.attachments.back().block.effect;
    if (effect != nullptr && effect->slot == sim::Slot::measurement)
      problems.add(std::string(effect->name), "attach = '" + text + "'",
                   "a dataset contains the plant's response, not an instrument's error", "remove it");
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

void read_case(Config& c, DatasetConfig& d) {
  sim::grid::CaseOptions& o = d.grid_case;
  o.dyr = sim::formats::read_dyr_options(c, "");
  if (c.has("frequency_hz"))
    o.raw.frequency_hz = c.require<double>(
        "frequency_hz", {1.0, 1000.0, "Hz", "nominal frequency, for a network in .m or .epc"});
  o.raw.version = static_cast<int>(
      c.optional<std::int64_t>("raw_version", 0, {0.0, 35.0, "", "version of the .raw; 0: from its header"}));
  o.net_generators = c.optional<bool>(
      "net_generators", false, {.meaning = "generators without a machine model become negative loads"});
  d.widen_limits =
      c.optional<bool>("widen_limits", false,
                       {.meaning = "control limits that exclude the operating point are extended to it"});
  o.start_from_file = c.choice("start", {"solved", "file"}, "solved",
                               {.meaning = "operating point: power flow, or voltages of the file"}) == "file";
  o.flow.reactive_limits = c.choice("q_limits", {"enforce", "ignore"}, "enforce",
                                    {.meaning = "limits of reactive power in the power flow"}) == "enforce";
  o.drop_refused = o.raw.drop_refused = c.optional<bool>(
      "drop_refused", false,
      {.meaning = "ignore records of the .dyr with inadmissible parameter values, and network equipment "
                  "with a repeated id or at a missing bus"});
  o.raw.repeated = sim::grid::choose(
      c, "repeated", sim::grid::kRepeatedWords, o.raw.repeated,
      {.meaning =
           "network equipment with a repeated id: refuse it, keep it under a new id (keep), or only if "
           "this improves the power balance at the file's voltages (voltages)"});
  o.complete_records = sim::grid::choose(
      c, "complete_records", sim::grid::kLackingWords, o.complete_records,
      {.meaning = "completion of records of the .dyr that are shorter than their model: none, with zeros, "
                  "or with defaults (standard)"});
  o.raw.devices = sim::grid::choose(
      c, "devices", sim::grid::kDeviceWords, o.raw.devices,
      {.meaning = "power of dc lines, FACTS and GNE devices and induction machines: from the file's "
                  "voltages, if these are a solution (checked) or always (file), or zero (none)"});
}

void read_vary(Config& c, DatasetConfig& d) {
  d.vary =
      c.choice(
          "vary.who", {"one", "all"},
          Range{.meaning = "one: each event varies one generator, in turn; all: every listed generator"}) ==
              "all"
          ? Vary::all
          : Vary::one;
  d.generators = numbers(c.require<std::vector<std::int64_t>>(
      "vary.generators", bus_number("bus numbers of the varied generators")));
  if (c.has("vary.generators") && d.generators.empty())
    c.problem("vary.generators", "no generator", "a dataset varies at least one",
              "list bus numbers of generators");
  d.ids = c.optional<std::vector<std::string>>(
      "vary.ids", {}, {.meaning = "ids of the varied units, in the order of vary.generators"});
  if (!d.ids.empty() && d.ids.size() != d.generators.size())
    c.problem("vary.ids", fmt::format("{} ids for {} generators", d.ids.size(), d.generators.size()),
              "entry i names the unit at entry i of vary.generators",
              "give one entry for each, \"\" where the bus has one unit");
  for (const int number : repeated(d.generators))
    c.problem("vary.generators", fmt::format("generator {} twice", number), "a bus may appear once",
              "name it once");
  std::vector<Box> others;
  read_effect_boxes(c, d.library, others);
  d.model = c.branch("vary.model", {.words = names_of(d.library, is_machine), .any_case = true},
                     {.meaning = "machine model of the varied generators"});
  const sim::Effect* effect = d.library.find(d.model);
  if (effect == nullptr || !is_machine(*effect)) {
    c.ignore("vary.box");  // cannot be checked without the model
    return;
  }
  d.model = effect->name;
  read_box(c, "vary.box", *effect, nullptr, d.box);
  d.box.insert(d.box.end(), others.begin(), others.end());
  if (std::ranges::none_of(d.box, &Box::sampled))
    c.problem("vary.box", "no parameter varies", "no entry of [vary.box] or [vary.effects.…] is an interval",
              "write at least one as name = [low, high]");
}

void read_fault(Config& c, FaultConfig& f) {
  if (c.is_text("fault.buses"))
    c.choice("fault.buses", {"any"}, Range{.meaning = "any bus"});
  else
    f.buses = numbers(c.require<std::vector<std::int64_t>>("fault.buses", bus_number("bus numbers")));
  f.except = numbers(c.optional<std::vector<std::int64_t>>(
      "fault.except", {}, bus_number("numbers of the buses that are never faulted")));
  f.start = c.optional<double>("fault.start", f.start, {0.0, 1e4, "s", "start of the fault"});
  std::tie(f.shortest, f.longest) =
      c.interval("fault.duration", {1e-4, 100.0, "s", "[shortest, longest] duration"});
  f.r = c.optional<double>("fault.r", 0.0, {0.0, 1e3, "pu", "fault resistance, on the network's base"});
  f.x = c.optional<double>("fault.x", 0.0, {0.0, 1e3, "pu", "fault reactance, on the network's base"});
  f.per_point = static_cast<std::uint64_t>(
      c.optional<std::int64_t>("fault.per_point", 1, count("faults for each databank sample")));
}

/// Reads a time constant of the frequency filter. Records a problem if it is given but the channel frequency
/// is not recorded.
void read_time_constant(Config& c, const std::string& key, bool frequency, double& value) {
  if (!frequency && !c.has(key)) return;
  value = c.require<double>(key, {1e-3, 100.0, "s", "time constant of the filter of the channel frequency"});
  if (!frequency)
    c.problem(key, key, "no channel frequency is recorded",
              "leave it out, or add frequency to record.channels");
}

void read_record(Config& c, RecordConfig& r) {
  r.t_end = c.require<double>("record.t_end", {0.01, 1e4, "s", "duration of a record"});
  r.rate = c.require<double>("record.rate", kRate);
  r.int16 = c.choice("record.storage", {"float32", "int16"}, "float32",
                     {.meaning = "number format of a recorded value"}) == "int16";
  std::vector<std::string> known;
  for (const auto& k : sim::kChannels) known.emplace_back(k.name);
  known.emplace_back("frequency");
  r.channels = c.require<std::vector<std::string>>(
      "record.channels", {.meaning = fmt::format("recorded channels, some of: {}", fmt::join(known, ", "))});
  for (const auto& name : r.channels)
    if (std::ranges::find(known, name) == known.end())
      c.problem("record.channels", "channel '" + name + "'", "there is no such channel",
                fmt::format("use some of: {}", fmt::join(known, ", ")));
  if (c.has("record.channels") && r.channels.empty())
    c.problem("record.channels", "no channel", "a record contains at least one",
              fmt::format("use some of: {}", fmt::join(known, ", ")));
  for (const auto& name : repeated(r.channels))
    c.problem("record.channels", "channel '" + name + "' twice", "a record contains each channel once",
              "list it once");
  const bool frequency = std::ranges::find(r.channels, "frequency") != r.channels.end();
  read_time_constant(c, "record.frequency_washout", frequency, r.frequency.washout);
  read_time_constant(c, "record.frequency_filter", frequency, r.frequency.filter);
  if (frequency && r.frequency.washout == r.frequency.filter && r.frequency.filter > 0)
    c.problem("record.frequency_filter", "frequency_filter equal to frequency_washout",
              "the filter's two time constants must differ", "change one of them");
}

void read_databank(Config& c, DatabankConfig& b) {
  b.policy =
      c.choice(
          "databank.policy", {"physical", "literal"}, "physical",
          {.meaning =
               "physical: rejects implausible values such as Xd <= Xdp; literal: rejects singular equations only"}) ==
              "literal"
          ? Policy::literal
          : Policy::physical;
  b.distance =
      c.require<double>("databank.distance",
                        {0.0, 1e6, "", "minimum Euclidean distance of two databank samples; 0: no minimum"});
  b.scaled =
      c.choice("databank.scale", {"raw", "scaled"}, "raw",
               {.meaning =
                    "raw: distance in the parameters' units; scaled: relative to the parameter intervals"}) ==
      "scaled";
  b.candidates_per_point =
      c.optional<double>("databank.candidates_per_point", b.candidates_per_point,
                         {1.0, 1e9, "", "maximum number of admissible candidates per databank sample"});
}

/// Reads [operating_point], if present.
void read_operating_point(Config& c, std::optional<OperatingPointConfig>& point) {
  if (!c.has("operating_point")) return;
  OperatingPointConfig p;
  const auto interval = [&](const char* key, double& low, double& high, const Range& range) {
    if (c.has(key)) std::tie(low, high) = c.interval(key, range);
  };
  p.per_block = static_cast<std::uint64_t>(c.optional<std::int64_t>(
      "operating_point.per_block", 2, count("draws that share one operating point")));
  interval("operating_point.loads", p.loads_low, p.loads_high,
           {0.01, 10.0, "", "[low, high] common factor of all loads and of the P of all generators"});
  p.load_spread = c.optional<double>(
      "operating_point.load_spread", 0.0,
      {0.0, 0.99, "", "s: each load is multiplied by an independent factor between 1 - s and 1 + s"});
  interval("operating_point.dispatch", p.dispatch_low, p.dispatch_high,
           {0.01, 10.0, "", "[low, high] individual factor of each generator's P"});
  p.voltage = c.optional<double>("operating_point.voltage", 0.0,
                                 {0.0, 0.2, "pu", "largest deviation of each voltage setpoint, up or down"});
  interval("operating_point.loading", p.loading_low, p.loading_high,
           {0.001, 2.0, "", "[low, high] apparent power of a machine / its base"});
  p.oversized_share = c.optional<double>("operating_point.oversized_share", 0.0,
                                         {0.0, 1.0, "", "share of oversized machines"});
  interval("operating_point.oversized", p.oversized_low, p.oversized_high,
           {1.0, 1000.0, "", "[low, high] factor of the base of an oversized machine"});
  double low = 0.0, high = 0.0;
  interval("operating_point.lines_out", low, high,
           {0.0, 100.0, "", "[low, high] number of lines out of service"});
  p.lines_out_low = static_cast<int>(low);
  p.lines_out_high = static_cast<int>(high);
  if (low != p.lines_out_low || high != p.lines_out_high)
    c.problem("operating_point.lines_out", "a fractional number of lines", "lines are counted",
              "give whole numbers");
  if (!p.draws_bases() && p.oversized_share > 0.0)
    c.problem("operating_point.oversized_share", "oversized machines without loading",
              "a machine's base is drawn from its loading", "give loading = [low, high] too");
  point = p;
}

}  // namespace

namespace {
/// Throws InputError if an override is outside the range of its key in the config.
void require_in_range(const Overrides& o) {
  Problems problems;
  const auto check = [&](const std::optional<std::uint64_t>& value, const char* option, double high) {
    if (value && static_cast<double>(*value) > high)
      problems.add(std::to_string(*value), option, fmt::format("it must be at most {:.0f}", high),
                   "give a smaller number");
  };
  check(o.draws, "--draws", count("").high);
  check(o.faults_per_point, "--faults-per-point", count("").high);
  check(o.draws_per_shard, "--draws-per-shard", kShardDraws.high);
  check(o.seed, "--seed", kSeed.high);
  const auto within = [&](const std::optional<double>& value, const char* option, const Range& range) {
    if (value && !(*value >= range.low && *value <= range.high))
      problems.add(fmt::format("{:g}", *value), option,
                   fmt::format("it must lie between {:g} and {:g} {}", range.low, range.high, range.unit),
                   "correct the number");
  };
  within(o.shard_megabytes, "--shard-megabytes", kShardSize);
  within(o.rate, "--rate", kRate);
  if (o.shard_megabytes && o.draws_per_shard)
    problems.add("shard size given twice", "--shard-megabytes", "--draws-per-shard also gives it",
                 "give one");
  problems.raise();
}
}  // namespace

namespace {

/// Reads the size of a shard: `draws_per_shard`, or `shard_megabytes` (default kUsualShard), which is
/// returned [MB].
std::optional<double> read_shard_size(Config& c, DatasetConfig& d) {
  if (c.has("draws_per_shard")) {
    d.draws_per_shard = static_cast<std::uint64_t>(c.require<std::int64_t>("draws_per_shard", kShardDraws));
    c.exclude("shard_megabytes", "shard size given twice", "draws_per_shard also gives it", "leave one out");
    return std::nullopt;
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

namespace {
/// Reads all values; `megabytes`: size of a shard [MB], none if `draws_per_shard` is given.
DatasetConfig read_values(Config& c, std::optional<double>& megabytes) {
  DatasetConfig d;
  d.file = c.name();
  d.raw = c.file("raw", {.meaning = "network (.raw, .m or .epc), relative to the folder of this file"});
  d.dyr = c.file("dyr", {.meaning = "dynamic models (.dyr or .dyd), relative to the folder of this file"});
  read_case(c, d);
  d.psse = c.choice("convention", {"psse", "andes"},
                    Range{.meaning = "psse: governors determine mechanical power; andes: torque"}) != "andes";
  d.draws = static_cast<std::uint64_t>(c.require<std::int64_t>("draws", count("events to simulate")));
  megabytes = read_shard_size(c, d);
  d.seed = static_cast<std::uint64_t>(c.optional<std::int64_t>("seed", 1, kSeed));
  read_effects(c, d);
  read_vary(c, d);
  read_databank(c, d.databank);
  read_fault(c, d.fault);
  read_record(c, d.record);
  read_operating_point(c, d.operating_point);
  d.tolerance = c.optional<double>("kernel.tolerance", 1e-6,
                                   {1e-12, 1e-2, "", "tolerance of the integrator, per step"});
  d.lanes = static_cast<int>(c.optional<std::int64_t>(
      "kernel.lanes", 0, {0, 16, "", "SIMD width; 0: the widest of the build in double precision"}));
  if (d.fault.start + d.fault.longest >= d.record.t_end && d.record.t_end > 0)
    c.problem("fault.start", fmt::format("a fault until {} s", d.fault.start + d.fault.longest),
              fmt::format("the record ends at {} s", d.record.t_end),
              "let the fault end before the record does");
  c.raise();
  return d;
}
}  // namespace

std::string dataset_schema() {
  return describe_keys("Dataset of Swingbank", [](Config& c) {
    std::optional<double> megabytes;
    read_values(c, megabytes);
  });
}

DatasetConfig read_dataset_config(const fs::path& file, const Overrides& overrides) {
  Config c(file);
  std::optional<double> megabytes;
  DatasetConfig d = read_values(c, megabytes);
  require_in_range(overrides);
  d.overrides = overrides;
  override_with(d, overrides, megabytes);
  return d;
}

}  // namespace swingbank::mpi::draw
