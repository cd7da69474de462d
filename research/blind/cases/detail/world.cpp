#include "research/blind/cases/detail/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "research/blind/cases/detail/effects.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::research::blind::cases {
namespace {

constexpr int kBlockTries = 200;  ///< maximum number of draws of one block

constexpr const char* kKnownTransformer = "STEPUP:X=0.1";
constexpr const char* kKnownExciter = "SEXS:K=150";
constexpr const char* kKnownGovernor = "TGOV1:VMAX=1.2";

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw InputError({what, "blind case", why, "change the kinds in the config"});
}

/// Returns whether a parameter is a limit. Limits are not varied, because a ceiling below the operating point
/// would make the plant invalid.
bool is_limit(std::string_view name) {
  return name.find("MAX") != name.npos || name.find("MIN") != name.npos || name == "GMAX" || name == "GMIN";
}

bool has_slot(const std::vector<sim::plant::Block>& blocks, sim::Slot slot) {
  return std::ranges::any_of(blocks, [&](const sim::plant::Block& b) { return b.effect->slot == slot; });
}

sim::plant::Block block_of(const std::string& text) {
  Problems problems;
  sim::plant::Block block = blind_block(text, "blind config", problems);
  problems.raise();
  return block;
}

void put(sim::plant::Plant& plant, sim::plant::Block block) {
  const bool unlisted = sim::library::compiled().find(block.effect->name) != block.effect;
  if (unlisted) {  // an unlisted disturbance does not occupy its slot; it acts after the slot's effect
    plant.controls.push_back(std::move(block));
    std::ranges::stable_sort(plant.controls, {}, [](const sim::plant::Block& b) { return b.effect->slot; });
    return;
  }
  if (auto problem = sim::plant::place(plant, std::move(block), "blind case")) throw InputError(*problem);
}

/// Replaces the plant's machine. Parameters with equal names keep their values.
void take_machine(sim::plant::Plant& plant, sim::plant::Block machine) {
  for (std::size_t i = 0; i < machine.p.size(); ++i)
    if (const int k = plant.machine.effect->parameter_index(machine.effect->parameters[i].name); k >= 0)
      machine.p[i] = plant.machine.p[static_cast<std::size_t>(k)];
  plant.machine = std::move(machine);
}

double along(const BlindPath& path, double scale, bool logarithmic) {
  if (logarithmic) return path.null_value * std::pow(path.full / path.null_value, scale);
  return path.null_value + (path.full - path.null_value) * scale;
}

bool set(sim::plant::Block& block, const BlindPath& path, double value) {
  if (block.effect->name != path.target) return false;
  block.p[static_cast<std::size_t>(block.effect->parameter_index(path.parameter))] = value;
  return true;
}

/// Sets a path's parameter in the plant or its conventions.
void set_path(sim::plant::Plant& plant, sim::Conventions& conventions, const BlindPath& path, double value) {
  if (path.target == "conventions") {
    conventions.speed_voltage = value > 0.5;
    return;
  }
  if (path.target == "machine") {
    const int index = plant.machine.effect->parameter_index(path.parameter);
    if (index < 0) refuse(path.parameter, "the machine has no such parameter");
    plant.machine.p[static_cast<std::size_t>(index)] = value;
    return;
  }
  for (int block = sim::plant::kMachineBlock + 1; block < sim::plant::block_count(plant); ++block)
    if (set(sim::plant::block_at(plant, block), path, value)) return;
}

}  // namespace

void jitter(sim::plant::Block& block, double relative_range, BlindDraw& draw) {
  const sim::Effect& effect = *block.effect;
  const std::vector<double> middle = block.p;
  for (int k = 0; k < kBlockTries; ++k) {
    for (std::size_t i = 0; i < middle.size(); ++i) {
      const sim::Parameter& record = effect.parameters[i];
      const double factor = draw.uniform(1.0 - relative_range, 1.0 + relative_range);
      if (record.is_code() || is_limit(record.name)) continue;
      block.p[i] = std::clamp(middle[i] * factor, record.low, record.high);
    }
    Problems problems;
    effect.check(effect.user_model.get(), block.p.data(), "blind case", problems);
    if (problems.empty() && effect.unphysical(block.p.data()).empty()) return;
  }
  block.p = middle;
}

bool mislead(sim::plant::Block& machine, std::pair<double, double> wrong, BlindDraw& draw) {
  const sim::Effect& effect = *machine.effect;
  const std::vector<double> right = machine.p;
  for (int i = 0; i < 10'000; ++i) {
    bool inside = true;
    for (std::size_t k = 0; k < right.size(); ++k) {
      const double off = draw.uniform(wrong.first, wrong.second);
      machine.p[k] = right[k] * (draw.coin() ? 1.0 + off : 1.0 - off);
      if (effect.parameters[k].is_code()) machine.p[k] = right[k];
      inside =
          inside && machine.p[k] >= effect.parameters[k].low && machine.p[k] <= effect.parameters[k].high;
    }
    Problems problems;
    effect.check(effect.user_model.get(), machine.p.data(), "blind case", problems);
    if (inside && problems.empty() && effect.unphysical(machine.p.data()).empty()) return true;
  }
  return false;
}

BlindWorld::BlindWorld(const BlindConfig& config, const std::vector<const BlindKind*>& hidden,
                       BlindDraw& draw)
    : hidden_(hidden) {
  const BlindGrid& files = config.grids[draw.below(config.grids.size())];
  grid_ = sim::grid::load_grid(files.raw, files.dyr, sim::Conventions::psse());
  name_ = files.raw.stem().string();
  const std::string bus = std::to_string(files.buses[draw.below(files.buses.size())]);
  const auto at = std::ranges::find(grid_.plants, bus, &sim::plant::Plant::name);
  if (at == grid_.plants.end()) refuse("no plant " + bus, name_ + " has none");
  plant_ = static_cast<int>(at - grid_.plants.begin());
  if (const auto& machines = config.conditions.machines; !machines.empty())
    take_machine(grid_.plants[static_cast<std::size_t>(plant_)],
                 block_of(machines[draw.below(machines.size())]));
  draw_machines(config.relative_range, draw);
  recorded_ = {plant_};
  draw_target(config.conditions, draw);
  split_target(config, draw);
  controlled_ = draw.coin(config.controlled_share);
  if (controlled_) draw_others(draw);
}

void BlindWorld::draw_machines(double relative_range, BlindDraw& draw) {
  const bool saturated = draw.coin(), damped = draw.coin();
  for (std::size_t i = 0; i < grid_.plants.size(); ++i) {
    sim::plant::Block& machine = grid_.plants[i].machine;
    jitter(machine, relative_range, draw);
    if (static_cast<int>(i) != plant_) continue;
    const auto zero = [&](const char* name) {
      if (const int k = machine.effect->parameter_index(name); k >= 0)
        machine.p[static_cast<std::size_t>(k)] = 0.0;
    };
    if (!saturated) zero("S10"), zero("S12");
    if (!damped) zero("D");
    zero("Ra");
  }
}

void BlindWorld::draw_target(const BlindConditions& conditions, BlindDraw& draw) {
  sim::plant::Plant& plant = grid_.plants[static_cast<std::size_t>(plant_)];
  std::vector<sim::plant::Block> known, all;
  blocks_.resize(hidden_.size());
  for (std::size_t k = 0; k < hidden_.size(); ++k) {
    for (const auto& text : hidden_[k]->base) {
      const sim::plant::Block block = block_of(text);
      if (std::ranges::none_of(known, [&](const sim::plant::Block& b) { return b.effect == block.effect; }))
        known.push_back(block);
    }
    for (const auto& text : hidden_[k]->hidden) {
      blocks_[k].push_back(block_of(text));
      jitter(blocks_[k].back(), 0.1, draw);
      all.push_back(blocks_[k].back());
    }
  }
  all.insert(all.end(), known.begin(), known.end());
  for (const std::string& text : conditions.controls)
    if (const sim::plant::Block block = block_of(text); !has_slot(all, block.effect->slot)) {
      known.push_back(block);
      all.push_back(block);
    }
  const bool exciter = draw.coin() && !converter(), governor = draw.coin() && !converter();
  const auto one_of = [&](const std::vector<std::string>& list, const char* otherwise) {
    return block_of(list.empty() ? otherwise : list[draw.below(list.size())]);
  };
  if (exciter && !has_slot(all, sim::Slot::exciter))
    known.push_back(one_of(conditions.exciters, kKnownExciter));
  if (governor && !has_slot(all, sim::Slot::governor))
    known.push_back(one_of(conditions.governors, kKnownGovernor));
  transformed_ = conditions.transformer_share > 0 && draw.coin(conditions.transformer_share) &&
                 !has_slot(all, sim::Slot::transformer);
  if (transformed_) known.push_back(block_of(kKnownTransformer));
  for (sim::plant::Block& block : known) {
    jitter(block, 0.15, draw);
    put(plant, block);
  }
  // A path through a block that the model contains starts at its null value.
  for (const BlindKind* kind : hidden_)
    for (const BlindPath& path : kind->path)
      set_path(plant, grid_.conventions, path, along(path, 0.0, kind->logarithmic));
}

/// Splits off a part of the plant as a second unit at the same bus, with its own values and controls. Cases
/// with a hidden instrument error are not split. The instrument would measure the sum of both units, and no
/// hypothesis about a single unit covers that error.
void BlindWorld::split_target(const BlindConfig& config, BlindDraw& draw) {
  const double share = config.conditions.second_unit_share;
  if (!(share > 0 && draw.coin(share)) || std::ranges::any_of(hidden_, &BlindKind::of_instrument)) return;
  const double part = draw.uniform(0.3, 0.7);
  sim::plant::Plant& plant = grid_.plants[static_cast<std::size_t>(plant_)];
  sim::plant::Plant other = plant;
  other.name = plant.name + "/2";
  other.controls.clear();
  jitter(other.machine, config.relative_range, draw);
  std::vector<std::string> controls = config.conditions.controls;
  if (!converter()) controls = {kKnownExciter, kKnownGovernor};
  for (const std::string& text : controls) {
    sim::plant::Block block = block_of(text);
    jitter(block, 0.15, draw);
    put(other, block);
  }
  other.mva *= part, other.generation *= part;
  plant.mva *= 1 - part, plant.generation *= 1 - part;
  other.generator = static_cast<int>(grid_.network.generators.size());
  grid_.network.generators.push_back(grid_.network.generators[static_cast<std::size_t>(plant.generator)]);
  recorded_.push_back(static_cast<int>(grid_.plants.size()));
  grid_.plants.push_back(std::move(other));
}

void BlindWorld::draw_others(BlindDraw& draw) {
  for (std::size_t i = 0; i < grid_.plants.size(); ++i) {
    if (std::ranges::count(recorded_, static_cast<int>(i))) continue;
    sim::plant::Block exciter = block_of("SEXS:K=50,TE=0.1,EMAX=6,EMIN=-5"),
                      governor = block_of("TGOV1:VMAX=1.5");
    jitter(exciter, 0.3, draw);
    jitter(governor, 0.3, draw);
    put(grid_.plants[i], exciter);
    put(grid_.plants[i], governor);
  }
}

void BlindWorld::apply(const BlindKind& kind, double scale, sim::grid::Grid& grid) const {
  sim::plant::Plant& plant = grid.plants[static_cast<std::size_t>(plant_)];
  for (const BlindPath& path : kind.path)
    set_path(plant, grid.conventions, path, along(path, scale, kind.logarithmic));
}

sim::grid::Grid BlindWorld::grid(std::span<const std::optional<double>> scale) const {
  sim::grid::Grid grid = grid_;
  for (std::size_t k = 0; k < hidden_.size(); ++k) {
    if (!scale[k]) continue;
    for (const sim::plant::Block& block : blocks_[k])
      put(grid.plants[static_cast<std::size_t>(plant_)], block);
    apply(*hidden_[k], *scale[k], grid);
  }
  return grid;
}

}  // namespace swingbank::research::blind::cases
