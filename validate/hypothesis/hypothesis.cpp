#include "validate/hypothesis/hypothesis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "sim/library/variants.hpp"
#include "validate/fit/draws.hpp"
#include "validate/playin/can_run.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using sim::Slot;

constexpr std::uint64_t kGroupDraws = 32;  ///< number of draws of the parameters of a freed group
/// Prior standard deviation of ln(value) of freed parameters that are at their null values in the model.
constexpr double kGroupPriorSd = 2.0;
/// Prior standard deviation of ln(value) of an added effect's parameters (a factor of e).
constexpr double kAddedPriorSd = 1.0;
/// Prior standard deviation of factors near 1, such as a transformer's tap ratio.
constexpr double kFactorPriorSd = 0.1;

Side side_of(Slot slot) {
  switch (slot) {
    case Slot::governor:
    case Slot::shaft:
    case Slot::torque_control:
    case Slot::pitch_control:
    case Slot::aerodynamics:
    case Slot::drive_train:
      return Side::mechanical;
    case Slot::exciter:
    case Slot::stabiliser:
    case Slot::limiter:
    case Slot::compensator:
    case Slot::setpoint:
    case Slot::plant_control:
    case Slot::electrical_control:
      return Side::excitation;
    case Slot::measurement:
      return Side::measurement;
    case Slot::machine:
    case Slot::transformer:
    case Slot::load:
      break;
  }
  return Side::machine;
}

bool occupied(const sim::plant::Plant& plant, const sim::Effect& effect) {
  if (effect.slot == Slot::transformer) return plant.transformer.effect != nullptr;
  for (const auto* list : {&plant.controls, &plant.measurements})
    for (const sim::plant::Block& b : *list)
      if (b.effect == &effect || (b.effect->slot == effect.slot && !sim::is_shared(effect.slot))) return true;
  return false;
}

/// Returns whether a control of `plant` reads the output of an added effect. A stabiliser, for example, has
/// no influence without an exciter.
bool is_read(const sim::plant::Plant& plant, const sim::Effect& effect) {
  const auto reader = sim::reader_of(effect.slot);
  return !reader || std::ranges::any_of(plant.controls, [&](const sim::plant::Block& b) {
    return b.effect->slot == *reader;
  });
}

/// Sets the free parameters and start values of an instrument. Its errors are small, and the response is
/// linear in them.
void start_near_null(Hypothesis& h, int block) {
  const sim::Effect& effect = sim::plant::block_effect(h.plant, block);
  for (std::size_t i = 0; i < effect.parameters.size(); ++i)
    if (!effect.parameters[i].is_code()) h.free.push_back({{block, static_cast<int>(i)}, kAddedPriorSd});
  for (const double share : {0.002, -0.002}) {
    std::vector<double> values;
    for (const auto& f : h.free) {
      const auto& p = sim::plant::parameter_record(h.plant, f.id);
      values.push_back(std::clamp(p.null_value + share * (p.high - p.low), p.low, p.high));
    }
    h.starts.push_back(values);
  }
}

/// Returns the free parameters of an added effect. A parameter whose default value is its null value stays
/// fixed, unless this value is positive. The parameter is then a factor, such as the unknown ratio of an
/// undocumented transformer.
std::vector<fit::FreeParameter> free_of_added(const sim::plant::Plant& plant, int block) {
  std::vector<fit::FreeParameter> free = fit::free_parameters(plant, block, kAddedPriorSd);
  const auto& parameters = sim::plant::block_effect(plant, block).parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (const auto& p = parameters[i]; p.null_value == p.default_value && p.null_value > 0 && !p.is_code())
      free.push_back({{block, static_cast<int>(i)}, kFactorPriorSd});
  return free;
}

/// Frees these parameters of one block, with the plant's values as start values.
void free_about_values(Hypothesis& h, std::vector<fit::FreeParameter> free) {
  h.free = std::move(free);
  h.starts = {fit::values_of(h.plant, h.free)};
  h.added = true;
}

/// Returns the hypothesis of an effect in a free slot.
Hypothesis added_to(const sim::plant::PlantUnderTest& tested, const sim::Effect& effect) {
  Hypothesis h = unchanged(tested);
  h.name = effect.name;
  h.what = fmt::format("{} {} ({})", sim::slot_name(effect.slot), effect.name, effect.title);
  h.side = side_of(effect.slot);
  if (!sim::is_shared(effect.slot)) h.slot = static_cast<int>(effect.slot);
  const int block = sim::plant::insert_block(h.plant, {&effect, effect.default_parameters()});
  if (effect.slot == Slot::measurement) {
    start_near_null(h, block);
  } else {
    free_about_values(h, free_of_added(h.plant, block));
  }
  return h;
}

void add_effects(const sim::plant::PlantUnderTest& tested, const sim::library::EffectLibrary& library,
                 const RecordContents& recorded, std::vector<Hypothesis>& all) {
  for (const sim::Effect* effect : library.all()) {
    const bool instrument = effect->slot == Slot::measurement;
    const bool fits = effect->slot == Slot::transformer || sim::is_control(effect->slot) || instrument;
    const bool tried = !sim::library::variant_of(*effect);  // the main effect covers alternative models
    if (!fits || !tried || effect->switching_times || occupied(tested.plant, *effect)) continue;
    if (!playin::belongs_to(recorded.component, effect->slot) || !is_read(tested.plant, *effect)) continue;
    if (!sim::slot_conflict(*tested.plant.machine.effect, *effect).empty()) continue;
    if (instrument &&
        !(playin::can_be_taken_back(*effect) && playin::changes_playback(*effect, recorded.integrated_angle)))
      continue;
    all.push_back(added_to(tested, *effect));
  }
}

/// Returns the name without its trailing number ("S10" -> "S"). Parameters that differ only in this number
/// describe one curve.
std::string_view stem(std::string_view name) {
  while (!name.empty() && std::isdigit(static_cast<unsigned char>(name.back()))) name.remove_suffix(1);
  return name;
}

/// Start values of a parameter group other than a dead band: distances from the null value, relative to the
/// range of the parameter on that side.
constexpr std::array kCurveStarts = {0.02, 0.1, 0.3, -0.02, -0.1};
/// Start values of a dead band's edges, relative to their range of 1 pu. A dead band is a few hundredths of 1
/// pu for voltage, and a thousandth of 1 pu for frequency. If the start value is wider than the signal, the
/// gradient of the cost is zero.
constexpr std::array kBandStarts = {3e-4, 1e-3, 4e-3, 0.015, 0.05};

/// Returns whether a group consists of the two edges of a dead band about a null value of 0.
bool is_band(const sim::Effect& effect, const std::vector<int>& group) {
  if (group.size() != 2) return false;
  const auto &lower = effect.parameters[static_cast<std::size_t>(group[0])],
             &upper = effect.parameters[static_cast<std::size_t>(group[1])];
  return lower.null_value == 0.0 && lower.low < 0.0 && lower.high == 0.0 && upper.null_value == 0.0 &&
         upper.low == 0.0 && upper.high > 0.0;
}

/// Returns a hypothesis for every group of parameters of a block that are at their null values.
std::vector<Hypothesis> null_groups(const sim::plant::PlantUnderTest& tested, int b) {
  std::vector<Hypothesis> all;
  const sim::plant::Block& block = sim::plant::block_at(tested.plant, b);
  const sim::Effect& effect = *block.effect;
  std::vector<std::vector<int>> groups;
  for (std::size_t i = 0; i < block.p.size(); ++i) {
    const auto& p = effect.parameters[i];
    if (p.is_code() || block.p[i] != p.null_value) continue;
    const bool joins =
        !groups.empty() &&
        stem(effect.parameters[static_cast<std::size_t>(groups.back().back())].name) == stem(p.name) &&
        stem(p.name) != p.name;
    if (joins)
      groups.back().push_back(static_cast<int>(i));
    else
      groups.push_back({static_cast<int>(i)});
  }
  for (const auto& group : groups) {
    Hypothesis h = unchanged(tested);
    std::string names, meanings;
    for (const int i : group) {
      const auto& p = effect.parameters[static_cast<std::size_t>(i)];
      names += (names.empty() ? "" : ",") + std::string(p.name);
      meanings += (meanings.empty() ? "" : ", ") + std::string(p.meaning);
    }
    h.name = fmt::format("{}:{}", effect.name, names);
    h.what = fmt::format("{} of {} ({})", names, effect.name, meanings);
    h.side = side_of(effect.slot);
    const bool band = is_band(effect, group);
    for (const double share : band ? kBandStarts : kCurveStarts) {
      std::vector<double> values;
      sim::plant::Block moved = block;
      for (std::size_t k = 0; k < group.size(); ++k) {
        const auto& p = effect.parameters[static_cast<std::size_t>(group[k])];
        const double range = share > 0 ? p.high - p.null_value : p.null_value - p.low;
        // later points of a curve lie above earlier ones
        const double curve = share * range * static_cast<double>(k + 1) * (k > 0 ? 2.0 : 1.0);
        const double v = p.null_value + (band ? share * (p.high > p.null_value ? p.high : p.low) : curve);
        values.push_back(v);
        moved.p[static_cast<std::size_t>(group[k])] = v;
      }
      const bool inside = std::ranges::all_of(values, [&](double v) { return v != 0.0; });
      if (!inside || !playin::can_run(moved)) continue;
      if (h.starts.empty())
        for (std::size_t k = 0; k < group.size(); ++k)
          sim::plant::parameter_value(h.plant, {b, group[k]}) = values[k];
      h.starts.push_back(values);
    }
    if (h.starts.empty()) continue;
    for (const int i : group) h.free.push_back({{b, i}, kGroupPriorSd});
    all.push_back(std::move(h));
  }
  return all;
}

/// Adds a hypothesis for each switch of a converter's controls: the switch in its other position.
void add_switches(const sim::plant::PlantUnderTest& tested, std::vector<Hypothesis>& all) {
  if (!tested.plant.machine.effect->converter) return;
  for (int b = 0; b < sim::plant::first_measurement(tested.plant); ++b) {
    const sim::plant::Block& block = sim::plant::block_at(tested.plant, b);
    for (std::size_t i = 0; i < block.p.size(); ++i) {
      const auto& p = block.effect->parameters[i];
      if (!p.is_code() || p.low != 0.0 || p.high != 1.0 || (block.p[i] != 0.0 && block.p[i] != 1.0)) continue;
      Hypothesis h = unchanged(tested);
      const double other = 1.0 - block.p[i];
      h.name = fmt::format("{}:{}={:g}", block.effect->name, p.name, other);
      h.what = fmt::format("{} of {} is {:g}, not {:g} ({})", p.name, block.effect->name, other, block.p[i],
                           p.meaning);
      h.side = side_of(block.effect->slot);
      sim::plant::parameter_value(h.plant, {b, static_cast<int>(i)}) = other;
      h.starts = {{}};
      if (playin::can_run(sim::plant::block_at(h.plant, b))) all.push_back(std::move(h));
    }
  }
}

void add_conventions(const sim::plant::PlantUnderTest& tested, std::vector<Hypothesis>& all) {
  Hypothesis h = unchanged(tested);
  h.name = "speed-voltage";
  h.side = Side::machine;
  h.conventions.speed_voltage = !tested.conventions.speed_voltage;
  h.what = fmt::format("stator voltage equations with{} the speed term (E″ = (1 + ω) ψ″)",
                       h.conventions.speed_voltage ? "" : "out");
  h.starts = {{}};
  all.push_back(std::move(h));
}

/// Returns whether a parameter may be 0 in `without`, where a group of parameters is at its null values, but
/// not in `with`, where it is not. Such a parameter acts only together with the group, as the time constant
/// of a rate feedback with its gain.
bool acts_only_beside(const sim::plant::Plant& without, const sim::plant::Plant& with,
                      sim::plant::ParameterId id) {
  const auto may_be_zero = [&](const sim::plant::Plant& plant) {
    sim::plant::Block block = sim::plant::block_at(plant, id.block);
    block.p[static_cast<std::size_t>(id.index)] = 0;
    return playin::can_run(block);
  };
  return may_be_zero(without) && !may_be_zero(with);
}

/// Returns sets of values of the free parameters of `h`: random draws of the parameters `freed`, and the
/// values of `fitted` for all others.
std::vector<std::vector<double>> draws_of(const Hypothesis& h, const std::vector<fit::FreeParameter>& freed,
                                          const sim::plant::Plant& fitted) {
  sim::plant::Plant plant = h.plant;
  for (const fit::FreeParameter& f : h.free)
    if (std::ranges::find(freed, f.id, &fit::FreeParameter::id) == freed.end())
      sim::plant::parameter_value(plant, f.id) = sim::plant::parameter_value(fitted, f.id);
  const fit::Draws draw(plant, freed, 0);
  std::vector<std::vector<double>> all;
  for (std::uint64_t number = 0; number < kGroupDraws; ++number) {
    const auto values = draw(number);
    if (!values) continue;
    all.push_back(fit::values_of(fit::with_values(plant, freed, *values), h.free));
  }
  return all;
}

}  // namespace

std::string_view side_name(Side side) {
  constexpr std::array<std::string_view, 5> names = {"none", "mechanical", "excitation", "machine",
                                                     "measurement"};
  return names[static_cast<std::size_t>(side)];
}

std::vector<Hypothesis> all_hypotheses(const sim::plant::PlantUnderTest& tested,
                                       const sim::library::EffectLibrary& library,
                                       const RecordContents& recorded) {
  const record::Component component = recorded.component;
  std::vector<Hypothesis> all;
  add_effects(tested, library, recorded, all);
  for (int b = 0; b < sim::plant::first_measurement(tested.plant); ++b)
    std::ranges::move(null_groups(tested, b), std::back_inserter(all));
  if (playin::belongs_to(component, Slot::machine) && !tested.plant.machine.effect->converter)
    add_conventions(tested, all);
  if (component == record::Component::plant) add_switches(tested, all);
  return all;
}

std::vector<Hypothesis> all_replacements(const sim::plant::PlantUnderTest& tested,
                                         const sim::library::EffectLibrary& library) {
  std::vector<Hypothesis> all;
  for (std::size_t c = 0; c < tested.plant.controls.size(); ++c) {
    const sim::Effect& there = *tested.plant.controls[c].effect;
    if (sim::is_shared(there.slot)) continue;
    sim::plant::Plant without = tested.plant;
    without.controls.erase(without.controls.begin() + static_cast<std::ptrdiff_t>(c));
    for (const sim::Effect* effect : library.all()) {
      if (effect->slot != there.slot || effect == &there || effect->switching_times) continue;
      if (sim::library::variant_of(*effect)) continue;
      Hypothesis h = added_to({without, tested.conventions}, *effect);
      h.name += fmt::format(" in place of {}", there.name);
      h.what += fmt::format(" in place of {}", there.name);
      h.replaces = true;
      all.push_back(std::move(h));
    }
  }
  return all;
}

std::vector<Hypothesis> with_left_off(const Hypothesis& h, const sim::plant::Plant& fitted) {
  std::vector<Hypothesis> all;
  if (!h.added || h.free.empty()) return all;
  const auto is_free = [&](const fit::FreeParameter& part) {
    return std::ranges::find(h.free, part.id, &fit::FreeParameter::id) != h.free.end();
  };
  for (const Hypothesis& group : null_groups(h.under_test(), h.free.front().id.block)) {
    if (std::ranges::any_of(group.free, is_free)) continue;
    const std::string names = group.name.substr(group.name.find(':') + 1);
    for (const bool positive : {true, false}) {
      const auto start = std::ranges::find_if(
          group.starts, [&](const std::vector<double>& values) { return (values.back() > 0) == positive; });
      if (start == group.starts.end()) continue;
      Hypothesis with = h;
      with.name += fmt::format(" with {}{}", names, positive ? "" : " < 0");
      with.plant = started(group, *start);
      std::vector<fit::FreeParameter> free = h.free, freed = group.free;
      for (fit::FreeParameter& f : free)
        if (acts_only_beside(h.plant, with.plant, f.id)) {
          f.prior_sd = kGroupPriorSd;
          freed.push_back(f);
        }
      free.insert(free.end(), group.free.begin(), group.free.end());
      free_about_values(with, std::move(free));
      with.further = draws_of(with, freed, fitted);
      all.push_back(std::move(with));
    }
  }
  return all;
}

std::string full_name(const Hypothesis& h) { return h.with.empty() ? h.name : h.with + " + " + h.name; }

Hypothesis unchanged(const sim::plant::PlantUnderTest& tested) {
  Hypothesis h;
  h.plant = tested.plant;
  h.conventions = tested.conventions;
  return h;
}

sim::plant::Plant started(const Hypothesis& h, const std::vector<double>& start) {
  return fit::with_values(h.plant, h.free, start);
}

}  // namespace swingbank::validate::hypothesis
