#include "sim/plant/block_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/nearest_word.hpp"

namespace swingbank::sim::plant {

void set_parameters(Block& block, const std::string& text, const std::string& where, Problems& problems) {
  for (std::size_t at = 0; at < text.size();) {
    const auto comma = std::min(text.find(',', at), text.size());
    const std::string one = text.substr(at, comma - at);
    at = comma + 1;
    const auto equal = one.find('=');
    const int index = block.effect->parameter_index(one.substr(0, equal));
    if (equal == one.npos || index < 0) {
      std::string names;
      for (const Parameter& p : block.effect->parameters)
        names += (names.empty() ? "" : ", ") + std::string(p.name);
      problems.add("'" + one + "'", where,
                   std::string(block.effect->name) + " has " + (names.empty() ? "no parameters" : names),
                   names.empty() ? "remove it" : "write PARAM=VALUE with one of these");
      continue;
    }
    double value = 0.0;
    const char* end = one.data() + one.size();
    const auto read = std::from_chars(one.data() + equal + 1, end, value);
    if (read.ec != std::errc{} || read.ptr != end || !std::isfinite(value))
      problems.add("'" + one + "'", where, "its value is not a number", "write it like Pp=0.4");
    block.p[static_cast<std::size_t>(index)] = value;
  }
}

std::optional<Problem> place(Plant& plant, Block block, const std::string& where) {
  const Effect& effect = *block.effect;
  const auto taken = [&](const Effect& other) {
    return Problem{"a second " + std::string(slot_name(effect.slot)) + ", " + std::string(effect.name) +
                       ", for plant " + plant.name,
                   where, "it already has " + std::string(other.name), "keep one of them"};
  };
  if (effect.slot == Slot::transformer) {
    if (plant.transformer.effect) return taken(*plant.transformer.effect);
    plant.transformer = std::move(block);
    return {};
  }
  if (!is_control(effect.slot) && effect.slot != Slot::measurement)
    return Problem{std::string(effect.name) + " for plant " + plant.name, where,
                   "it is a " + std::string(slot_name(effect.slot)) + ", which cannot be added to a plant",
                   effect.slot == Slot::load ? "use --load BUS:EFFECT" : "give it in the .dyr"};
  if (plant.machine.effect)
    if (const std::string why = slot_conflict(*plant.machine.effect, effect); !why.empty())
      return Problem{std::string(effect.name) + " for plant " + plant.name, where, why,
                     "leave it out, or attach it to another plant"};
  auto& list = effect.slot == Slot::measurement ? plant.measurements : plant.controls;
  for (const Block& other : list)
    if (other.effect == &effect || (other.effect->slot == effect.slot && !is_shared(effect.slot)))
      return taken(*other.effect);
  list.push_back(std::move(block));
  if (effect.slot != Slot::measurement) sort_controls(plant);
  return {};
}

Attachment read_attachment(const std::string& text, const library::EffectLibrary& library,
                           const std::string& where, Problems& problems) {
  const auto first = text.find(':'), second = first == text.npos ? text.npos : text.find(':', first + 1);
  if (first == text.npos) {
    problems.add("'" + text + "'", where, "an effect is attached by PLANT:EFFECT[:PARAM=VALUE,...]",
                 "write it like 30:FORCEDOSC:amplitude=0.01,frequency=0.5");
    return {};
  }
  Attachment a{text.substr(0, first), {}};
  const std::string name = text.substr(first + 1, second == text.npos ? text.npos : second - first - 1);
  const Effect* effect = library.find(name);
  if (!effect) {
    std::vector<std::string> names;
    for (const Effect* e : library.all()) names.emplace_back(e->name);
    problems.add(
        "unknown effect '" + name + "'", where, "the library has no effect of that name",
        suggestion(name, names, "use one of " + library.names() + ", or give its file with --user-model"));
    return {};
  }
  Block block{effect, effect->default_parameters()};
  Problems found;
  if (second != text.npos) set_parameters(block, text.substr(second + 1), where, found);
  if (found.empty()) effect->check(effect->user_model.get(), block.p.data(), where, found);
  problems.add(found);
  if (found.empty()) a.block = std::move(block);
  return a;
}

}  // namespace swingbank::sim::plant
