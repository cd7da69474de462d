#include "sim/library/library.hpp"

#include <algorithm>
#include <cctype>
#include <deque>

namespace swingbank::sim::library {
namespace {
bool same_name(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::toupper(x) == std::toupper(y); });
}
std::deque<Effect>& added() {
  static std::deque<Effect> list;  // a deque: effects are known by address
  return list;
}
}  // namespace

std::vector<const Effect*> every_effect() {
  std::vector<const Effect*> list;
  for (const Effect& e : all_effects()) list.push_back(&e);
  for (const Effect& e : added()) list.push_back(&e);
  return list;
}

const Effect* find_effect(std::string_view name) {
  for (const Effect* e : every_effect())
    if (same_name(e->name, name)) return e;
  return nullptr;
}

const Effect& add_effect(Effect effect) {
  if (find_effect(effect.name))
    throw InputError({"a second effect '" + std::string(effect.name) + "'", std::string(effect.source),
                      "the name is taken", "choose another name"});
  return added().emplace_back(std::move(effect));
}

std::string effect_names() {
  std::string names;
  for (const Effect* e : every_effect()) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return names;
}
std::string effect_names(Slot slot) {
  std::string names;
  for (const Effect* e : every_effect())
    if (e->slot == slot) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return names;
}

}  // namespace swingbank::sim::library
