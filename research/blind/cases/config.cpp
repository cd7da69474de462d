#include "research/blind/cases/config.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "base/config.hpp"
#include "research/blind/cases/detail/effects.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::research::blind::cases {
namespace {

const std::vector<std::string> kSides = {"mechanical", "excitation", "machine", "measurement", "none"};

bool parse(std::string_view text, double& value) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc{} && read.ptr == text.data() + text.size();
}

/// Reads a path: "TARGET.PARAM=NULL_VALUE:FULL".
BlindPath read_path(Config& config, const std::string& key, const std::string& text) {
  const auto dot = text.find('.'), equal = text.find('=', dot), colon = text.find(':', equal);
  BlindPath path{};
  if (dot != text.npos && equal != text.npos && colon != text.npos) {
    path.target = text.substr(0, dot);
    path.parameter = text.substr(dot + 1, equal - dot - 1);
    if (parse(text.substr(equal + 1, colon - equal - 1), path.null_value) &&
        parse(text.substr(colon + 1), path.full))
      return path;
  }
  config.problem(key, "'" + text + "'", "a path is EFFECT.PARAM=NULL_VALUE:FULL",
                 "write it like machine.S10=0:0.12");
  return path;
}

void check_blocks(Config& config, const std::string& key, const std::vector<std::string>& texts) {
  for (const auto& text : texts) {
    Problems problems;
    blind_block(text, config.where(key), problems);
    for (const auto& p : problems.list()) config.problem(key, p.what, p.why, p.remedy);
  }
}

/// Checks that all blocks have the slot `slot`. Otherwise an effect of another slot would silently be placed
/// in this slot.
void check_slot(Config& config, const std::string& key, const std::vector<std::string>& texts,
                sim::Slot slot) {
  check_blocks(config, key, texts);
  for (const auto& text : texts)
    if (const sim::Effect* effect = blind_effect(text.substr(0, text.find(':')));
        effect && effect->slot != slot)
      config.problem(
          key, "'" + text + "'",
          fmt::format("its slot is {}, not {}", sim::slot_name(effect->slot), sim::slot_name(slot)),
          "choose an effect of that slot; swingbank effects lists them");
}

/// Checks that the controls are compatible with each machine that may be drawn.
void check_controls(Config& config, const BlindConditions& c) {
  check_blocks(config, "conditions.controls", c.controls);
  for (const auto& text : c.controls)
    for (const auto& machine : c.machines) {
      const sim::Effect *control = blind_effect(text.substr(0, text.find(':'))),
                        *source = blind_effect(machine.substr(0, machine.find(':')));
      if (!control || !source) continue;
      if (const std::string why = sim::slot_conflict(*source, *control); !why.empty())
        config.problem("conditions.controls", fmt::format("'{}' beside {}", text, source->name), why,
                       "choose controls that fit every machine of conditions.machines");
    }
}

void check_path(Config& config, const std::string& key, const BlindPath& path) {
  if (path.target == "conventions" && path.parameter == "speed_voltage") return;
  const sim::Effect* effect = blind_effect(path.target == "machine" ? "GENROU" : path.target);
  if (effect && effect->parameter_index(path.parameter) >= 0) return;
  config.problem(key, path.target + "." + path.parameter, "no effect has such a parameter",
                 "swingbank effects lists them; machine means GENROU");
}

std::vector<std::string> values_of(const BlindKind& kind) {
  std::vector<std::string> names;
  for (const BlindPath& path : kind.path) names.push_back(path.target + "." + path.parameter);
  return names;
}

BlindKind read_kind(Config& config, const std::string& name) {
  const std::string at = "kind." + name + ".";
  BlindKind kind;
  kind.name = name;
  kind.side = config.choice(at + "side", kSides);
  kind.listed = config.optional<bool>(at + "listed", true);
  kind.drawn = config.optional<bool>(at + "drawn", true);
  kind.value = config.optional<bool>(at + "value", false);
  kind.base = config.optional<std::vector<std::string>>(at + "base", {});
  kind.hidden = config.optional<std::vector<std::string>>(at + "hidden", {});
  kind.logarithmic = config.choice(at + "spacing", {"linear", "log"}, "linear") == "log";
  kind.limit = config.require<double>(at + "limit", {1e-3, 1e6, "noise"});
  check_blocks(config, at + "base", kind.base);
  check_blocks(config, at + "hidden", kind.hidden);
  for (const auto& text : config.require<std::vector<std::string>>(at + "path")) {
    kind.path.push_back(read_path(config, at + "path", text));
    check_path(config, at + "path", kind.path.back());
    if (kind.logarithmic && !(kind.path.back().null_value * kind.path.back().full > 0))
      config.problem(at + "path", "'" + text + "'", "a logarithmic path cannot pass through 0",
                     "give both ends the same sign, or spacing = \"linear\"");
  }
  kind.accepted_names = {name};
  if (kind.value) kind.accepted_names = values_of(kind);
  kind.accepted_names = config.optional<std::vector<std::string>>(at + "answers", kind.accepted_names);
  if (kind.value && !kind.hidden.empty())
    config.problem(at + "value", "value = true beside hidden effects",
                   "a case with a wrong value lacks no effect", "leave out hidden, or value");
  return kind;
}

BlindConditions read_conditions(Config& config) {
  BlindConditions c;
  const auto share = [&](const char* name) {
    return config.optional<double>(std::string("conditions.") + name, 0.0, {0.0, 1.0});
  };
  // the interval is required if its share is above 0
  const auto between = [&](const char* name, double how_often, const Range& range) {
    const std::string key = std::string("conditions.") + name;
    return how_often > 0 || config.has(key) ? config.interval(key, range) : std::pair(0.0, 0.0);
  };
  const auto numbers = [&](const char* name, const Range& range) {
    return config.optional<std::vector<double>>(std::string("conditions.") + name, {}, range);
  };
  const auto texts = [&](const char* name) {
    return config.optional<std::vector<std::string>>(std::string("conditions.") + name, {});
  };
  c.rates = numbers("rates", {10.0, 240.0, "1/s"});
  c.voltage_noise = numbers("voltage_noise", {0.0, 10.0, "of noise"});
  c.class_m_share = share("class_m_share");
  c.class_m_rates = numbers("class_m_rates", {10.0, 120.0, "1/s"});
  if (c.class_m_share > 0 && c.class_m_rates.empty())
    config.problem("conditions.class_m_share", fmt::format("class_m_share = {:g}", c.class_m_share),
                   "class_m_rates lists no rate at which the filter is defined",
                   "give class_m_rates, or a share of 0");
  c.short_share = share("short_share");
  c.lead = config.optional<double>("conditions.lead", c.lead, {0.05, 1.5, "s"});
  c.ambient_share = share("ambient_share");
  c.ambient = between("ambient", c.ambient_share, {0.0, 0.1, "of a load"});
  c.drift_share = share("drift_share");
  c.drift = between("drift", c.drift_share, {0.0, 0.5, "of the load per minute"});
  c.wander_share = share("wander_share");
  c.wander = between("wander", c.wander_share, {0.0, 1.0, "rad"});
  c.long_share = share("long_share");
  c.dip_share = share("dip_share");
  c.transformer_share = share("transformer_share");
  c.second_unit_share = share("second_unit_share");
  c.machines = texts("machines");
  c.controls = texts("controls");
  c.exciters = texts("exciters");
  c.governors = texts("governors");
  check_slot(config, "conditions.machines", c.machines, sim::Slot::machine);
  check_controls(config, c);
  check_slot(config, "conditions.exciters", c.exciters, sim::Slot::exciter);
  check_slot(config, "conditions.governors", c.governors, sim::Slot::governor);
  return c;
}

}  // namespace

const BlindKind* BlindConfig::kind(const std::string& name) const {
  const auto at = std::ranges::find(kinds, name, &BlindKind::name);
  return at == kinds.end() ? nullptr : &*at;
}

BlindConfig load_blind_config(const std::filesystem::path& file) {
  Config config(file);
  BlindConfig b;
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  b.hash = XXH64(text.str().data(), text.str().size(), 0);
  b.noise = config.require<std::vector<double>>("record.noise", {0.0, 0.1, "of machine MVA"});
  b.voltage_noise = config.require<double>("record.voltage_noise", {0.0, 10.0, "of noise"});
  b.speed_noise = config.require<double>("record.speed_noise", {0.0, 0.1, "pu"});
  b.seconds = config.require<double>("record.seconds", {4.0, 120.0, "s"});
  b.rate = config.require<double>("record.rate", {10.0, 240.0, "1/s"});
  b.fine_rate = config.require<double>("record.fine_rate", {60.0, 7680.0, "1/s"});
  b.faults = static_cast<int>(config.require<std::int64_t>("events.faults", {0, 50}));
  b.frequency_events = static_cast<int>(config.require<std::int64_t>("events.frequency", {0, 50}));
  b.wrong = config.interval("model.wrong", {0.0, 0.5});
  b.size = config.interval("size", {0.1, 1e4, "detection limits"});
  b.relative_range = config.require<double>("model.spread", {0.0, 0.5});
  b.filter_share = config.require<double>("record.filter_share", {0.0, 1.0});
  b.channels_share = config.require<double>("record.channels_share", {0.0, 1.0});
  b.controlled_share = config.require<double>("events.controlled_share", {0.0, 1.0});
  b.conditions = read_conditions(config);
  for (const auto& name : config.keys("grid"))
    b.grids.push_back({config.file("grid." + name + ".raw"), config.file("grid." + name + ".dyr"),
                       config.require<std::vector<std::int64_t>>("grid." + name + ".buses", {1.0})});
  for (const auto& name : config.keys("kind")) b.kinds.push_back(read_kind(config, name));
  if (b.grids.empty())
    config.problem("grid", "no [grid.NAME]", "cases are simulated on a grid", "give at least one grid");
  std::vector<double> rates = b.conditions.rates;
  rates.push_back(b.rate);
  for (const double rate : rates)
    if (std::abs(b.fine_rate / rate - std::round(b.fine_rate / rate)) > 1e-9)
      config.problem("record.fine_rate", fmt::format("fine_rate = {:g} 1/s", b.fine_rate),
                     fmt::format("it is not a multiple of rate = {:g} 1/s", rate), "choose a multiple");
  config.raise();
  return b;
}

}  // namespace swingbank::research::blind::cases
