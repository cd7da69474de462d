#include "validate/plant/plant_model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "base/input_file.hpp"
#include "base/sha256.hpp"
#include "sim/grid/case_words.hpp"
#include "sim/plant/orderings.hpp"
#include "sim/plant/parameter_id.hpp"
#include "sim/plant/usual.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/plant/detail/plausible.hpp"
#include "validate/plant/detail/staged.hpp"
#include "validate/plant/unknown_keys.hpp"

namespace swingbank::validate::plant {
namespace {

namespace fs = std::filesystem;
using sim::Slot;

constexpr double kSmallest = 1e-9;     ///< lower bound of bases and frequencies
constexpr double kMostBuses = 999999;  ///< largest bus number of PSS/E

constexpr const char* kUserModels = "user_models";    ///< key of the files of user-defined models
constexpr std::string_view kConverter = "converter";  ///< section of a converter as the source

using sim::library::EffectLibrary;

/// Returns the member `text` of each effect of one slot; `section` selects machines or converters.
std::vector<std::string> texts_of(const EffectLibrary& library, Slot slot, std::string_view section,
                                  std::string_view sim::Effect::*text) {
  std::vector<std::string> texts;
  for (const auto* e : library.all())
    if (e->slot == slot && (slot != Slot::machine || e->converter == (section == kConverter)))
      texts.emplace_back(e->*text);
  return texts;
}
std::vector<std::string> effects_of(const EffectLibrary& library, Slot slot, std::string_view section = {}) {
  return texts_of(library, slot, section, &sim::Effect::name);
}

/// Adds a warning with its line for each unusual value of a section.
void warn_unusual(const Config& config, const std::string& section, const sim::plant::Block& block,
                  PlantModel& model) {
  for (const int i : sim::plant::unusual(block)) {
    const auto& name = block.effect->parameters[static_cast<std::size_t>(i)].name;
    model.warnings.push_back(Problem{sim::plant::value_text(block, i),
                                     config.where(fmt::format("{}.{}", section, name)),
                                     sim::plant::usual_text(*block.effect, i), "correct it if it is an error"}
                                 .sentence());
  }
}

/// Reads one section: the effect's name and all of its parameters. The parameters are checked for consistency
/// if all could be read. `section` is a slot's name, or "limiter[1]". Default parameters are added to
/// PlantModel::defaults, unusual values to PlantModel::warnings.
sim::plant::Block read_block(Config& config, PlantModel& model, Slot slot, const std::string& section) {
  const EffectLibrary& library = model.library;
  const Branch effects{.words = effects_of(library, slot, section),
                       .titles = texts_of(library, slot, section, &sim::Effect::title),
                       .opened_by = kUserModels};
  sim::plant::Block block{
      library.find(config.branch(section + ".effect", effects, {.meaning = "name of the effect"})), {}};
  if (!block.effect || block.effect->slot != slot) {
    config.ignore(section);  // its keys belong to the intended effect
    return {};
  }
  const bool sound = config.sound();
  const bool may_miss =
      config.optional<bool>(section + ".default_values", false,
                            {.meaning = "true: missing parameters have default values; reports list them"});
  const auto given = config.keys(section);
  for (const auto& p : block.effect->parameters) {
    const std::string key = fmt::format("{}.{}", section, p.name);
    const Range about{.unit = std::string(p.unit),
                      .meaning = fmt::format("{}; usually {:g} to {:g}", p.meaning, p.low, p.high)};
    block.p.push_back(may_miss ? config.optional<double>(key, p.default_value, about)
                               : config.require<double>(key, about));
    if (may_miss && !std::ranges::count(given, p.name))
      model.defaults.push_back(fmt::format("{}.{}", block.effect->name, p.name));
  }
  if (!sound || !config.sound()) return block;
  Problems problems;
  block.effect->check(block.effect->user_model.get(), block.p.data(), config.where(section), problems);
  for (const auto& p : problems.list()) config.problem(section, p.what, p.why, p.remedy);
  warn_unusual(config, section, block, model);
  return block;
}

/// Warns of violated orderings of a machine's parameters, each with its line.
void check_orderings(const Config& config, PlantModel& model) {
  const sim::plant::Block& machine = model.plant.machine;
  if (!machine.effect) return;
  for (const auto& o : sim::plant::violated(machine)) {
    const auto& name = machine.effect->parameters[static_cast<std::size_t>(o.greater)].name;
    model.warnings.push_back(
        Problem{sim::plant::violation_text(machine, o), config.where(fmt::format("machine.{}", name)),
                "in a machine the first is always larger than the second", "check both values"}
            .sentence());
  }
}

/// Reads every [[section]] of a slot with several effects.
std::vector<sim::plant::Block> read_several(Config& config, PlantModel& model, Slot slot) {
  const std::string name(sim::slot_name(slot));
  config.ignore(name);  // its keys are checked below
  std::vector<sim::plant::Block> blocks;
  for (int k = 0; config.has(fmt::format("{}[{}]", name, k)); ++k) {
    const std::string section = fmt::format("{}[{}]", name, k);
    const sim::plant::Block block = read_block(config, model, slot, section);
    if (!block.effect) continue;
    std::vector<std::string> known = {"effect", "default_values"};
    for (const auto& p : block.effect->parameters) known.emplace_back(p.name);
    refuse_unknown_keys(config, section, "[[" + name + "]]", known);
    blocks.push_back(block);
  }
  return blocks;
}

/// Reads the effects of one slot: one [section], or several [[section]] if their outputs add up.
void read_slot(Config& config, PlantModel& model, Slot slot, std::vector<sim::plant::Block>& into) {
  const std::string section(sim::slot_name(slot));
  if (!config.is_array(section)) {
    sim::plant::Block block = read_block(config, model, slot, section);
    if (block.effect) into.push_back(std::move(block));
    return;
  }
  if (!sim::is_shared(slot)) {
    config.ignore(section);
    return config.problem(section, "several [[" + section + "]]", "a plant has at most one",
                          "write one [" + section + "]");
  }
  std::ranges::move(read_several(config, model, slot), std::back_inserter(into));
}

/// Returns whether the grid's files already contain an effect of the slot.
bool filled(const sim::plant::Plant& plant, Slot slot) {
  if (sim::is_shared(slot)) return false;
  if (slot == Slot::transformer) return plant.transformer.effect != nullptr;
  return std::ranges::any_of(plant.controls, [&](const auto& b) { return b.effect->slot == slot; });
}
std::string_view name_in(const sim::plant::Plant& plant, Slot slot) {
  if (slot == Slot::transformer) return plant.transformer.effect->name;
  const auto at = std::ranges::find_if(plant.controls, [&](const auto& b) { return b.effect->slot == slot; });
  return at->effect->dyr_name;
}

/// Reads all sections except [machine] and [converter], and adds their effects to those of a grid's files.
void read_around(Config& config, PlantModel& model) {
  sim::plant::Plant& plant = model.plant;
  for (const Slot slot : sim::kSlots) {
    const std::string section(sim::slot_name(slot));
    if (slot == Slot::machine || slot == Slot::load || !config.has(section)) continue;
    if (effects_of(model.library, slot).empty()) {
      config.problem(section, "section [" + section + "]", "this build contains no effect for this section",
                     "remove it; the input is then constant at the operating point");
    } else if (filled(plant, slot)) {
      config.ignore(section);
      config.problem(section, fmt::format("[{}], and {} in the grid's files", section, name_in(plant, slot)),
                     "a plant has at most one",
                     slot == Slot::transformer
                         ? "remove it, or remove measured_at from [grid]"
                         : fmt::format("remove it, or write ignore_models = [\"{}\"] under [grid]",
                                       name_in(plant, slot)));
    } else if (slot == Slot::transformer) {
      plant.transformer = read_block(config, model, slot, section);
    } else {
      read_slot(config, model, slot, slot == Slot::measurement ? plant.measurements : plant.controls);
    }
  }
  std::ranges::stable_sort(plant.controls, {}, [](const auto& b) { return b.effect->slot; });
  if (!plant.machine.effect) return;
  for (const auto& control : plant.controls)
    if (const std::string why = sim::slot_conflict(*plant.machine.effect, *control.effect); !why.empty())
      config.problem(std::string(sim::slot_name(control.effect->slot)), std::string(control.effect->name),
                     why, "remove the section");
}

/// Returns the value of a parameter of a plant; nullptr if the plant has no such effect or parameter.
double* value_in(sim::plant::Plant& plant, const std::string& effect, const std::string& name) {
  for (int b = 0; b < sim::plant::first_measurement(plant); ++b) {
    sim::plant::Block& block = sim::plant::block_at(plant, b);
    const int i = block.effect && block.effect->name == effect ? block.effect->parameter_index(name) : -1;
    if (i >= 0) return &block.p.at(static_cast<std::size_t>(i));
  }
  return nullptr;
}

/// Reads the values from before a rejected calibration, by effect and parameter.
void read_submitted(Config& config, PlantModel& model) {
  if (!config.has("submitted")) return;
  sim::plant::Plant plant = model.plant;
  for (const auto& effect : config.keys("submitted"))
    for (const auto& name : config.keys("submitted." + effect)) {
      const std::string key = fmt::format("submitted.{}.{}", effect, name);
      const auto before =
          config.require<double>(key, {.meaning = "value from before a calibration that was not adequate"});
      if (double* value = value_in(plant, effect, name))
        *value = before;
      else
        config.problem(key, "unknown key " + key, "the plant has no such effect or parameter", "remove it");
    }
  model.submitted = std::move(plant);
  model.warnings.push_back(
      fmt::format("{} contains the result of an inadequate calibration: its parameters are biased",
                  config.name().string()));
}

/// Loads the files of user-defined models of the plant, and adds their effects to the library.
std::vector<fs::path> read_user_models(Config& config, EffectLibrary& library) {
  std::vector<fs::path> files;
  for (const auto& name : config.optional<std::vector<std::string>>(
           kUserModels, {},
           {.meaning = "files of user-defined models, relative to the folder of this file"})) {
    const fs::path file = (config.name().parent_path() / name).lexically_normal();
    try {
      sim::user_models::load_user_model(file, library);
      files.push_back(file);
    } catch (const InputError& error) {
      for (const auto& p : error.problems())
        config.problem(kUserModels, p.what + " in " + p.where, p.why, p.remedy);
    }
  }
  return files;
}

sim::Conventions read_conventions(Config& config, double hz) {
  const Range about{.meaning = "psse: the governor sets power; andes: it sets torque"};
  auto read = config.choice("plant.conventions", {"psse", "andes"}, about) == "andes"
                  ? sim::Conventions::andes(hz)
                  : sim::Conventions::psse(hz);
  read.speed_voltage =
      config.optional<bool>("plant.speed_voltage", read.speed_voltage,
                            {.meaning = "true: speed term in the stator voltage equations (voltage = "
                                        "speed times flux linkage)"});
  return read;
}

/// Adds all parameters of these effects to PlantModel::defaults, because the effects replace others of the
/// case and have default values.
void note_defaults(PlantModel& model, const std::vector<std::string>& effects) {
  for (const auto& name : effects)
    for (const auto& p : model.library.find(name)->parameters)
      model.defaults.push_back(fmt::format("{}.{}", name, p.name));
}

void read_from_grid(Config& config, PlantModel& model) {
  for (const char* twice : {"plant.base_mva", "machine", "converter"})
    config.exclude(twice, std::string(twice) + " together with [grid]", "the grid's files already contain it",
                   "remove one of them");
  sim::grid::UnitChoice choice{
      .raw = config.file(
          "grid.raw", {.meaning = "network (.raw, .rawx, .epc or .m), relative to the folder of this file"}),
      .dyr = config.file("grid.dyr",
                         {.meaning = "dynamic models (.dyr or .dyd), relative to the folder of this file"})};
  choice.bus = static_cast<int>(
      config.require<std::int64_t>("grid.bus", {1.0, kMostBuses, "", "bus number of the unit"}));
  choice.dyd = sim::formats::is_dyd(choice.dyr);
  choice.id =
      config.optional<std::string>("grid.id", "", {.meaning = "id of the unit, if its bus has several"});
  choice.models = sim::formats::read_dyr_options(config, "grid.");
  choice.complete_records =
      sim::grid::choose(config, "grid.complete_records", sim::grid::kLackingWords, choice.complete_records,
                        {.meaning = "completion of .dyr records with fewer values than their model has"});
  if (config.has("grid.measured_at"))
    choice.measured_at = static_cast<int>(config.require<std::int64_t>(
        "grid.measured_at", {1.0, kMostBuses, "",
                             "bus at which the records were measured, on the grid side of the unit's "
                             "transformer"}));
  if (!config.sound()) return;
  choice.frequency_hz = model.conventions.frequency;
  const sim::grid::Unit unit = sim::grid::read_unit(choice);
  if (unit.frequency != model.conventions.frequency)
    config.problem("plant.frequency_hz",
                   fmt::format("plant.frequency_hz = {:g} Hz", model.conventions.frequency),
                   fmt::format("the frequency in the grid's .raw is {:g} Hz", unit.frequency),
                   "use the same frequency in both files");
  model.plant = unit.plant;
  model.bus = unit.bus;
  model.id = unit.id;
  model.dispatch = unit.dispatch;
  note_defaults(model, unit.defaults);
  model.warnings = unit.notes;
}

/// Returns whether the first line that is not a comment consists of columns, as in a record. In a TOML file,
/// this line begins a table or contains '='.
bool is_columns(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto begin = line.find_first_not_of(" \t\r\xEF\xBB\xBF");
    if (begin == std::string_view::npos || line[begin] == '#') continue;
    if (line[begin] == '[' || line.find('=') != std::string_view::npos) return false;
    return std::ranges::count_if(line, [](char c) { return c == ',' || c == ';' || c == '\t'; }) >= 2;
  }
  return false;
}

PlantModel read_plant(Config& config, PlantModel model) {
  model.user_models = read_user_models(config, model.library);
  model.name =
      config.require<std::string>("plant.name", {.meaning = "name of the plant, printed in reports"});
  config.optional<std::string>("plant.origin", "", {.meaning = "source of the figures"});
  const auto hz = config.require<double>("plant.frequency_hz",
                                         {kSmallest, 1000.0, "Hz", "nominal frequency (50 or 60 Hz)"});
  model.conventions = read_conventions(config, hz);
  model.record_base.frequency = hz;
  model.record_base.mva = config.require<double>(
      "record.base_mva", {kSmallest, 1e9, "MVA", "base of P_pu and Q_pu of this plant's records"});
  model.record_base.kv = config.optional<double>(
      "record.base_kv", 0.0,
      {kSmallest, 1e9, "kV", "base of the voltage; needed if a record contains the voltage in kV"});
  model.record_base.efd = config.optional<double>(
      "record.efd_base", 0.0, {kSmallest, 1e9, "V or pu", "1 pu (air-gap line) of Efd in the records' unit"});
  model.record_base.ifd = config.optional<double>(
      "record.ifd_base", 0.0, {kSmallest, 1e9, "A or pu", "1 pu (air-gap line) of Ifd in the records' unit"});
  if (config.has("dispatch"))
    model.dispatch = {
        config.require<double>("dispatch.P_MW",
                               {.unit = "MW", .meaning = "active power of the unit in its case"}),
        config.require<double>("dispatch.Q_Mvar",
                               {.unit = "Mvar", .meaning = "reactive power of the unit in its case"}),
        config.require<double>("dispatch.V_pu",
                               {kSmallest, 10.0, "pu", "voltage at the measured bus in the case"})};
  model.nameplate = read_nameplate(config);
  model.reading.staged = read_staged_events(config);
  for (const auto& word : config.keys("record.columns"))
    model.reading.columns[word] = config.require<std::string>(
        "record.columns." + word,
        {.meaning = "column of the records, for example V = \"NORTH.BUS1.VPM [kV]\""});
  if (config.has("grid")) {
    read_from_grid(config, model);
  } else {
    model.plant.mva = config.require<double>(
        "plant.base_mva", {kSmallest, 1e9, "MVA", "machine base of all per-unit parameters in this file"});
    model.plant.name = model.name;
    model.bus = static_cast<int>(config.optional<std::int64_t>(
        "plant.bus", 0, {1.0, kMostBuses, "", "bus number of the unit, for its .dyr records"}));
    model.id = config.optional<std::string>("plant.id", model.id,
                                            {.meaning = "id of the unit, for its .dyr records"});
    const std::string source = config.has("machine") || !config.has("converter") ? "machine" : "converter";
    model.plant.machine = read_block(config, model, Slot::machine, source);
    if (const auto base = foreign_base(model.plant.machine, model.plant.mva))
      model.warnings.push_back(
          Problem{base->what, config.where("machine.H"), base->why, base->remedy}.sentence());
  }
  read_around(config, model);
  if (config.sound()) check_orderings(config, model);
  read_submitted(config, model);
  config.raise();
  return model;
}

}  // namespace

std::string subject(const PlantModel& model) {
  if (model.reading.component == record::Component::plant)
    return std::string(model.plant.machine.effect->name);
  return std::string(record::component_name(model.reading.component)) + " alone";
}

std::string plant_schema() {
  return describe_keys("Plant file of Swingbank", [](Config& config) { read_plant(config, {}); });
}

PlantModel parse_plant_model(const std::string& text, const fs::path& file,
                             const std::vector<fs::path>& user_models) {
  if (is_columns(text))
    throw InputError({"the file is a record", file.string(), "a plant file is required",
                      "give the plant file (.toml) as --model, and the record as --records"});
  Config config(text, file);
  PlantModel model;
  for (const auto& user_model : user_models) sim::user_models::load_user_model(user_model, model.library);
  model.origin = file.string();
  model.sha256 = sha256(text);
  return read_plant(config, std::move(model));
}

PlantModel load_plant_model(const fs::path& file, const std::vector<fs::path>& user_models) {
  return parse_plant_model(read_input(file, "cannot read the plant file", "give the path of a plant .toml"),
                           file, user_models);
}

PlantModel as_submitted(PlantModel model) {
  if (model.submitted) model.plant = *model.submitted;
  return model;
}

PlantModel model_of_unit(const sim::grid::Unit& unit, sim::Conventions conventions, std::string files) {
  PlantModel model;
  model.origin = std::move(files);
  const std::string bus = fmt::format("bus {}", unit.bus);
  const bool named = !unit.bus_name.empty() && unit.bus_name != fmt::format("BUS {}", unit.bus);
  model.name = named ? unit.bus_name + ", " + bus : bus;
  model.plant = unit.plant;
  model.plant.name = model.name;
  model.bus = unit.bus;
  model.id = unit.id;
  model.dispatch = unit.dispatch;
  model.conventions = conventions;
  model.conventions.frequency = unit.frequency;
  model.record_base.frequency = unit.frequency;
  model.record_base.mva = unit.system_mva;
  // In per-unit cases, every bus has 1 kV or no voltage. The rated voltage of a plant is higher.
  constexpr double kPerUnitCase = 1.0;
  if (unit.kv > kPerUnitCase) model.record_base.kv = unit.kv;
  note_defaults(model, unit.defaults);
  if (const auto base = foreign_base(model.plant.machine, model.plant.mva))
    model.warnings.push_back(fmt::format("{}: {}; {}", base->what, base->why, base->remedy));
  for (const auto& o : sim::plant::violated(model.plant.machine))
    model.warnings.push_back(sim::plant::violation_text(model.plant.machine, o) + ": check both values");
  return model;
}

}  // namespace swingbank::validate::plant
