#include "sim/grid/detail/dyr_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "sim/library/library.hpp"

namespace swingbank::sim::grid {
namespace {

constexpr std::array kEndings = {"BL", "OW", "ZN", "AR", "AL"};

/// The effect with this name in a .dyr (case matters not), or nullptr.
const Effect* effect_named(std::string_view model) {
  const auto same = [](unsigned char a, unsigned char b) { return std::toupper(a) == std::toupper(b); };
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty() && std::ranges::equal(e.dyr_name, model, same)) return &e;
  return nullptr;
}
/// Other names of a model whose equations are the same, and where its columns stand in theirs; none: in the
/// same order.
struct OtherName {
  std::string_view name, known_as;
  std::span<const int> order = {};
};
constexpr int kPslfsSt5b[] = {0, 6, 7, 8, 9, 1, 4, 5, 2, 3, 14, 15, 16, 17, 10, 11, 12, 13};
constexpr OtherName kOtherNames[] = {
    {"GENTPJ1", "GENTPJU1"},  // its name since PSS/E 34
    {"REECCU1", "REECC1"},    // as a user-written model
    {"REECD", "REECD1"},
    {"REECDU1", "REECD1"},           // as a user-written model
    {"REGCBU1", "REGCB1"},           // likewise
    {"REPCTA1", "REPCA1"},           // of a wind plant of type 3
    {"HYG3U1", "HYG3"},              // as a user-written model
    {"IEE2ST", "ST2CUT"},            // its IEEE form: the same blocks (OpenIPSL, c80a6c4)
    {"ESST5B", "ST5B", kPslfsSt5b},  // PSLF's (InterPSS, St5bExciterTest)
    {"EXDC1", "IEEEX1"},             // GridPACK's and PSLF's name of the type DC1 of 1981
};

const OtherName* other_name(std::string_view model) {
  const auto at = std::ranges::find(kOtherNames, model, &OtherName::name);
  return at == std::end(kOtherNames) ? nullptr : at;
}

/// The same, with the names that stand for it too: IEELAR is IEELBL for an area.
std::pair<const Effect*, Reach> effect_of_model(std::string model) {
  if (const OtherName* other = other_name(model)) model = other->known_as;
  if (const Effect* own = effect_named(model)) return {own, Reach::load};
  for (std::size_t i = 1; i < kEndings.size(); ++i) {
    if (!model.ends_with(kEndings[i])) continue;
    const Effect* effect = effect_named(model.substr(0, model.size() - 2) + kEndings[0]);
    if (effect && effect->slot == Slot::load) return {effect, static_cast<Reach>(i)};
  }
  return {nullptr, Reach::load};
}

/// Names of the effects with a .dyr form, of one slot or of all.
std::string names_of(const Slot* slot) {
  std::string names;
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty() && (!slot || e.slot == *slot))
      names += (names.empty() ? "" : ", ") + std::string(e.dyr_name);
  return names;
}

/// What stands already where the effect belongs, or nullptr.
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
  return fmt::format("{}: generator {} has ZX = {} pu in {} but {} pu in its {}; the latter is used", where,
                     plant.name, zx, raw.origin, x, block.effect->dyr_name);
}

}  // namespace

std::pair<const Effect*, Reach> effect_of_dyr(const formats::DyrRecord& record) {
  if (!record.equipment.empty()) return {nullptr, Reach::load};
  return effect_of_model(record.user.empty() ? record.model : record.user);
}

std::string dyr_names() { return names_of(nullptr); }
std::string machine_names() {
  constexpr Slot machine = Slot::machine;
  return names_of(&machine);
}
std::string columns_text(const Effect& effect) {
  std::string text = std::to_string(effect.dyr_columns.size()) + ":";
  for (const int column : effect.dyr_columns)
    text += " " + std::string(effect.parameters[static_cast<std::size_t>(column)].symbol);
  return text;
}

formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect) {
  constexpr std::size_t before = 6, icons = 2, cons = 3;
  const std::size_t columns = effect.dyr_columns.size();
  if (!record.user.empty()) {
    if (record.values.size() == columns + before &&
        record.values[icons] + record.values[cons] == static_cast<double>(columns))
      record.values.erase(record.values.begin(), record.values.begin() + before);
    record.model = record.user;
  }
  const OtherName* other = other_name(record.model);
  if (other && other->order.size() == record.values.size()) {
    const std::vector<double> theirs = record.values;
    for (std::size_t i = 0; i < theirs.size(); ++i)
      record.values[i] = theirs[static_cast<std::size_t>(other->order[i])];
  }
  return record;
}
bool complete(const Effect& effect, const formats::DyrRecord& record, const std::string& where,
              Problems& problems, const std::string& or_else) {
  if (record.values.size() == effect.dyr_columns.size()) return true;
  problems.add(record.model + " with " + std::to_string(record.values.size()) + " parameters", where,
               "it takes " + columns_text(effect), "give every parameter, in this order" + or_else);
  return false;
}
plant::Block values_of(const Effect& effect, const formats::DyrRecord& record) {
  plant::Block block{&effect, effect.standard_parameters()};
  for (std::size_t i = 0; i < record.values.size(); ++i)
    block.p[static_cast<std::size_t>(effect.dyr_columns[i])] = record.values[i];
  return block;
}

std::string fault_of(const Effect& effect, formats::DyrRecord record, const network::Generator* g,
                     const std::string& where) {
  record = plain(std::move(record), effect);
  Problems problems = record.faults;
  if (problems.empty() && complete(effect, record, where, problems)) {
    plant::Block block = values_of(effect, record);
    if (g) take_from_raw(block, *g);
    effect.check(effect.law.get(), block.p.data(), where, problems);
  }
  return problems.empty() ? "" : problems.list()[0].sentence();
}

plant::Block transformer_of(const network::Generator& g) {
  if (g.rt == 0.0 && g.xt == 0.0) return {};
  plant::Block block{library::compiled().find("STEPUP"), {}};
  block.p = block.effect->standard_parameters();
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
  effect.check(effect.law.get(), block.p.data(), where, found);
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
void sort_controls(plant::Plant& plant) {
  std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
}
std::string remark_on(const plant::Block& block, const std::string& where, const std::string& plant) {
  const std::string left_out = block.effect->remark ? block.effect->remark(block.p.data()) : std::string();
  return left_out.empty()
             ? left_out
             : fmt::format("{}: {} of generator {}: {}", where, block.effect->name, plant, left_out);
}
void check_fit(const plant::Plant& plant, const std::string& where, Problems& problems) {
  if (!plant.machine.effect) return;
  for (const plant::Block& block : plant.controls)
    if (const std::string why = misfit(*plant.machine.effect, *block.effect); !why.empty())
      problems.add(fmt::format("{} for generator {}", block.effect->name, plant.name), where, why,
                   "remove the record, or correct the source's");
}

}  // namespace swingbank::sim::grid
