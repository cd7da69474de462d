#include "sim/grid/detail/dyr_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>

#include "base/capitals.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::grid {
namespace {

constexpr std::array kEndings = {"BL", "OW", "ZN", "AR", "AL"};

/// Returns the effect with this name in a .dyr (case-insensitive), or nullptr.
const Effect* effect_named(std::string_view model) {
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty() &&
        (same_name(e.dyr_name, model) || (e.at_shunt && same_name(e.at_shunt->by_id, model))))
      return &e;
  return nullptr;
}
/// Alias of a model with the same equations. `order`: position of each of the effect's columns in the alias;
/// empty: same order.
struct OtherName {
  std::string_view name, known_as;
  std::span<const int> order = {};
};
constexpr int kPslfsSt5b[] = {0, 6, 7, 8, 9, 1, 4, 5, 2, 3, 14, 15, 16, 17, 10, 11, 12, 13};
constexpr OtherName kOtherNames[] = {
    {"REECD", "REECD1"},
    {"REPCTA1", "REPCA1"},           // variant for wind plants of type 3
    {"IEE2ST", "ST2CUT"},            // IEEE form with the same blocks (OpenIPSL, c80a6c4)
    {"ESST5B", "ST5B", kPslfsSt5b},  // order of PSLF (InterPSS, St5bExciterTest)
    {"EXDC1", "IEEEX1"},             // GridPACK's and PSLF's name for type DC1 of 1981
};

const OtherName* other_name(std::string_view model) {
  const auto at = std::ranges::find(kOtherNames, model, &OtherName::name);
  return at == std::end(kOtherNames) ? nullptr : at;
}

/// Returns the possible standard names of a user-written model. PSS/E's user-written names end with U1 or U
/// (REGCAU1 is REGCA1, HYG3U1 is HYG3, GENQECU is GENQEC).
std::vector<std::string> standard_names(std::string_view user_written) {
  if (user_written.ends_with("U1")) {
    const std::string base(user_written.substr(0, user_written.size() - 2));
    return {base + "1", base};
  }
  if (user_written.ends_with("U")) return {std::string(user_written.substr(0, user_written.size() - 1))};
  return {};
}
/// Returns the effect of a model that is user-written in some versions of PSS/E and standard in others
/// (GENTPJU1 is GENTPJ1), or nullptr.
const Effect* effect_since_default(const std::string& model) {
  for (const Effect& e : library::compiled_effects())
    for (const std::string& name : standard_names(e.dyr_name))
      if (name == model) return &e;
  return nullptr;
}

/// A model of a .dyr: its effect; for a load model, its scope; and the order of its columns if it differs
/// from the effect's.
struct Known {
  const Effect* effect = nullptr;
  Reach reach = Reach::load;
  std::span<const int> order = {};
};
/// Returns the model of a name, with aliases resolved: IEELAR is IEELBL for an area.
Known known_by(std::string model) {
  Known known;
  if (const OtherName* other = other_name(model)) {
    model = other->known_as;
    known.order = other->order;
  }
  known.effect = effect_named(model);
  if (!known.effect) known.effect = effect_since_default(model);
  for (std::size_t i = 1; i < kEndings.size() && !known.effect; ++i) {
    if (!model.ends_with(kEndings[i])) continue;
    const Effect* effect = effect_named(model.substr(0, model.size() - 2) + kEndings[0]);
    if (effect && effect->slot == Slot::load) known = {effect, static_cast<Reach>(i), known.order};
  }
  return known;
}
Known known_model(const formats::DyrRecord& record) {
  const std::string name = name_of(record);
  Known known = known_by(name);
  for (const std::string& standard : standard_names(name))
    if (!known.effect) known = known_by(standard);
  return known;
}

/// Returns the present effect that excludes `effect` from its slot, or nullptr. In a shared slot only
/// `effect` itself does.
const Effect* in_the_way(const plant::Plant& plant, const Effect& effect) {
  if (effect.slot == Slot::machine) return plant.machine.effect;
  if (effect.slot == Slot::transformer) return plant.transformer.effect;
  for (const plant::Block& other : plant.controls)
    if (other.effect == &effect || (other.effect->slot == effect.slot && !is_shared(effect.slot)))
      return other.effect;
  return nullptr;
}

std::string compare_reactance(const plant::Plant& plant, const plant::Block& block, const RawGenerator& raw,
                              const std::string& where) {
  if (block.effect->raw_reactance >= 0 || block.effect->converter) return {};
  const double zx = raw.generator.zx;
  double r = 0.0, x = 0.0;
  block.effect->get<double>().machine.source_impedance(block.p.data(), r, x);
  constexpr double tolerance = 1e-4;  // [pu]: files round reactances to four or five digits
  if (zx == 0.0 || std::abs(zx - x) <= tolerance) return {};
  return fmt::format("{}: generator {} has ZX = {} pu in {} but {} pu in its {}; the value of {} is used",
                     where, plant.name, zx, raw.origin, x, block.effect->dyr_name, block.effect->dyr_name);
}

}  // namespace

std::pair<const Effect*, Reach> effect_of_dyr(const formats::DyrRecord& record) {
  const Known known = known_model(record);
  return {known.effect, known.reach};
}

void find_named_buses(std::vector<formats::DyrRecord>& records, const network::Network& network) {
  constexpr std::size_t name_width =
      12;                             // width of the name in an extended bus name, before the base voltage
  constexpr double rounding = 0.006;  // tolerance of a voltage with two decimals [kV]
  std::map<std::string, std::vector<const network::Bus*>> named;
  for (const network::Bus& bus : network.buses) named[bus.name].push_back(&bus);
  const auto trimmed = [](const std::string& text) { return text.substr(0, text.find_last_not_of(' ') + 1); };
  for (formats::DyrRecord& record : records) {
    const std::string& text = record.equipment;
    if (text.empty()) continue;
    std::vector<int> found;
    const auto blank = text.find_last_of(' ');
    for (const std::size_t cut : {name_width, blank == std::string::npos ? text.size() : blank}) {
      if (cut >= text.size() || !found.empty()) continue;
      const auto name = named.find(trimmed(text.substr(0, cut)));
      const auto kv = formats::psse::parse_number(text.substr(text.find_first_not_of(' ', cut)));
      if (name == named.end() || !kv) continue;
      for (const network::Bus* bus : name->second)
        if (std::abs(bus->kv - static_cast<double>(*kv)) < rounding) found.push_back(bus->number);
    }
    if (found.size() != 1) continue;
    record.bus = found[0];
    record.equipment.clear();
  }
}

std::string lacking_text(const std::string& dyr) {
  return "Swingbank has no such model; 'swingbank effects --coverage " + dyr +
         "' shows which models of the file are supported";
}
std::string machine_names() {
  std::string names;
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty() && e.slot == Slot::machine)
      names += (names.empty() ? "" : ", ") + std::string(e.dyr_name);
  return names;
}
std::string columns_text(const Effect& effect) {
  std::string text = std::to_string(effect.dyr_columns.size()) + ":";
  for (const int column : effect.dyr_columns)
    text += " " + std::string(effect.parameters[static_cast<std::size_t>(column)].symbol);
  if (effect.at_shunt)
    text += fmt::format(
        "; between the first {} of these and the others, a flag and an id for each of {} switched shunts",
        effect.at_shunt->columns, effect.at_shunt->beside);
  return text;
}

namespace {

/// Reduces a record of a switched shunt to the parameters of its model. Drops the fields of the further,
/// mechanically switched shunts, which are not modelled. A parameter (SVSMO1: Flag1) still shows whether the
/// record uses them.
void without_shunts_beside(formats::DyrRecord& record, const ShuntRecord& layout, std::size_t columns) {
  std::vector<double>& v = record.values;
  if (record.model == layout.of_first) {
    const auto bus = formats::psse::parse_number(record.id);
    if (!bus || v.size() + 1 != columns + layout.passed_over()) return;
    v.insert(v.begin(), static_cast<double>(*bus));
    record.id = kAnyShunt;
    for (formats::DyrRecord::Text& text : record.texts) ++text.at;
  }
  if (v.size() != columns + layout.passed_over()) return;
  const auto from = v.begin() + static_cast<std::ptrdiff_t>(layout.columns);
  v.erase(from, from + static_cast<std::ptrdiff_t>(layout.passed_over()));
  std::erase_if(record.texts, [&](const formats::DyrRecord::Text& text) {
    return text.at >= layout.columns && text.at < layout.columns + layout.passed_over();
  });
}

}  // namespace

int number_in(const plant::Block& block, int parameter) {
  if (parameter < 0) return 0;
  const auto at = static_cast<std::size_t>(parameter);
  const double value = block.p[at];
  // 0: none. A value outside the range is no bus number: SVSMO1's check() refuses it, other models ignore it.
  return value > 0.0 && value <= block.effect->parameters[at].high ? static_cast<int>(value) : 0;
}

int regulated_bus(const plant::Block& block) {
  return block.effect->at_shunt ? number_in(block, block.effect->at_shunt->regulated) : 0;
}

int regulated_index(const network::Network& network, const plant::Block& block, const std::string& where,
                    Problems& problems) {
  const int number = regulated_bus(block), index = number == 0 ? -1 : network.bus_index(number);
  if (number != 0 && index < 0)
    problems.add(fmt::format("{} regulates bus {}", block.effect->name, number), where,
                 network.origin + " has no such bus", "correct the bus number");
  return index;
}

formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect) {
  if (effect.at_shunt) without_shunts_beside(record, *effect.at_shunt, effect.dyr_columns.size());
  for (const formats::DyrRecord::Text& text : record.texts) record.faults.add(text.fault);
  record.texts.clear();
  const std::span<const int> order = known_model(record).order;
  constexpr std::size_t icons = 2, cons = 3;  // codes NI, NC: number of integers and constants that follow
  std::vector<double>& v = record.values;
  if (record.codes > 0 && v.size() >= record.codes &&
      v[icons] + v[cons] == static_cast<double>(v.size() - record.codes)) {
    v.erase(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(record.codes));
    const int codes = static_cast<int>(record.codes);
    std::erase_if(record.empty, [codes](int i) { return i <= codes; });
    for (int& i : record.empty) i -= codes;
  }
  record.codes = 0;
  if (!record.user.empty()) record.model = record.user;
  if (order.size() == v.size()) {
    const std::vector<double> theirs = v;
    for (std::size_t i = 0; i < theirs.size(); ++i) v[i] = theirs[static_cast<std::size_t>(order[i])];
  }
  return record;
}
namespace {

std::string_view symbol_of_column(const Effect& effect, std::size_t column) {
  return effect.parameters[static_cast<std::size_t>(effect.dyr_columns[column])].symbol;
}
/// Appends the missing values at the end. Returns them as text.
std::string fill(const Effect& effect, std::vector<double>& values, Lacking lacking) {
  const std::vector<double> standard = effect.default_parameters();
  std::string text;
  for (std::size_t i = values.size(); i < effect.dyr_columns.size(); ++i) {
    values.push_back(lacking == Lacking::zero ? 0.0
                                              : standard[static_cast<std::size_t>(effect.dyr_columns[i])]);
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", symbol_of_column(effect, i), values.back());
  }
  return text;
}

}  // namespace

Completion complete(const Effect& effect, formats::DyrRecord& record, Lacking lacking,
                    const std::string& where, Problems& problems) {
  const std::size_t has = record.values.size(), takes = effect.dyr_columns.size();
  if (has == takes) return {true, {}, {}};
  if (lacking == Lacking::refused) {
    const bool cut = record.unended && has < takes;
    problems.add(record.model + " with " + std::to_string(has) + " parameters", where,
                 "it takes " + columns_text(effect) +
                     (cut ? "; no '/' ends the record: the file may be truncated there" : ""),
                 (cut ? "restore the file, or give" : "give") +
                     std::string(" every parameter, in this order, or let --complete-records do it"));
    return {};
  }
  const std::string name = fmt::format("{} of '{}' at bus {}", record.model, record.id, record.bus);
  if (has < takes)
    return {true, "missing values at the end of records are set to zero or to defaults (--complete-records)",
            fmt::format("{} has {} of {} values: {} ({})", name, has, takes,
                        fill(effect, record.values, lacking), where)};
  const std::vector<double> surplus(record.values.begin() + static_cast<std::ptrdiff_t>(takes),
                                    record.values.end());
  record.values.resize(takes);
  return {true, "surplus values at the end of records are ignored (--complete-records)",
          fmt::format("{} has {} values instead of {}; ignored: {} ({})", name, has, takes,
                      fmt::join(surplus, ", "), where)};
}
plant::Block values_of(const Effect& effect, const formats::DyrRecord& record) {
  plant::Block block{&effect, effect.default_parameters()};
  for (std::size_t i = 0; i < record.values.size(); ++i)
    block.p[static_cast<std::size_t>(effect.dyr_columns[i])] = record.values[i];
  return block;
}

std::string fault_of(const Effect& effect, formats::DyrRecord record, const network::Generator* g,
                     const std::string& where) {
  record = plain(std::move(record), effect);
  Problems problems = record.faults;
  if (problems.empty() && complete(effect, record, Lacking::refused, where, problems).sound) {
    plant::Block block = values_of(effect, record);
    if (g) take_from_raw(block, *g);
    effect.check(effect.user_model.get(), block.p.data(), where, problems);
  }
  return problems.empty() ? "" : problems.list()[0].sentence();
}

plant::Block transformer_of(const network::Generator& g) {
  if (g.rt == 0.0 && g.xt == 0.0) return {};
  plant::Block block{library::compiled().find("STEPUP"), {}};
  block.p = block.effect->default_parameters();
  block.p[static_cast<std::size_t>(block.effect->parameter_index("R"))] = g.rt;
  block.p[static_cast<std::size_t>(block.effect->parameter_index("X"))] = g.xt;
  return block;
}
void take_from_raw(plant::Block& block, const network::Generator& g) {
  const Effect& effect = *block.effect;
  if (effect.raw_resistance >= 0) block.p[static_cast<std::size_t>(effect.raw_resistance)] = g.zr;
  if (effect.raw_reactance >= 0) block.p[static_cast<std::size_t>(effect.raw_reactance)] = g.zx;
}

std::string place(plant::Plant& plant, plant::Block block, const RawGenerator& raw, const std::string& where,
                  Problems& problems) {
  const Effect& effect = *block.effect;
  Problems found;
  effect.check(effect.user_model.get(), block.p.data(), where, found);
  problems.add(found);
  if (const Effect* other = in_the_way(plant, effect)) {
    problems.add("a second " + std::string(slot_name(effect.slot)) + " model, " +
                     std::string(effect.dyr_name) + ", for generator " + plant.name,
                 where, "it already has " + std::string(other->dyr_name), "keep one of them");
    return {};
  }
  if (effect.slot == Slot::transformer) {
    plant.transformer = std::move(block);
    return {};
  }
  if (effect.slot != Slot::machine) {
    plant.controls.push_back(std::move(block));
    return {};
  }
  std::string warning = found.empty() ? compare_reactance(plant, block, raw, where) : "";
  plant.machine = std::move(block);
  return warning;
}
std::string remark_on(const plant::Block& block, const std::string& where, const std::string& plant) {
  const std::string left_out = block.effect->remark ? block.effect->remark(block.p.data()) : std::string();
  return left_out.empty()
             ? left_out
             : fmt::format("{}: {} of generator {}: {}", where, block.effect->name, plant, left_out);
}
bool reads_field_voltage(const Effect& machine) {
  const auto& ops = machine.get<double>();
  const auto p = machine.default_parameters();
  std::vector<double> c(static_cast<std::size_t>(machine.coefficients)), x(machine.states.size()),
      m(static_cast<std::size_t>(machine.scratch)), before(x.size()), after(x.size());
  ops.prepare(p.data(), Conventions::psse(), c.data());
  double er = 0.0, ei = 0.0;
  Signals<double> s;
  ops.machine.emf(c.data(), x.data(), m.data(), er, ei);
  ops.machine.electrical(c.data(), x.data(), m.data(), s);
  s.Efd = 1.0;
  ops.machine.derivative(c.data(), x.data(), m.data(), s, before.data());
  s.Efd = 2.0;
  ops.machine.derivative(c.data(), x.data(), m.data(), s, after.data());
  return before != after;
}
bool acts_on_field(Slot slot) {
  return slot == Slot::compensator || slot == Slot::stabiliser || slot == Slot::limiter ||
         slot == Slot::exciter;
}
std::vector<std::string> idle_controls(const plant::Plant& plant) {
  std::vector<std::string> list;
  const Effect* machine = plant.machine.effect;
  if (!machine || machine->converter || reads_field_voltage(*machine)) return list;
  for (const plant::Block& block : plant.controls)
    if (acts_on_field(block.effect->slot))
      list.push_back(fmt::format("{} of generator {}: {} has no field winding", block.effect->dyr_name,
                                 plant.name, machine->name));
  return list;
}
void check_fit(const plant::Plant& plant, const std::string& where, Problems& problems) {
  if (!plant.machine.effect) return;
  for (const plant::Block& block : plant.controls)
    if (const std::string why = slot_conflict(*plant.machine.effect, *block.effect); !why.empty())
      problems.add(fmt::format("{} for generator {}", block.effect->name, plant.name), where, why,
                   "remove this record, or correct that of the machine or converter");
}

}  // namespace swingbank::sim::grid
