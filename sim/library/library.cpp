#include "sim/library/library.hpp"

#include "base/capitals.hpp"

namespace swingbank::sim::library {

std::vector<const Effect*> EffectLibrary::all() const {
  std::vector<const Effect*> list;
  for (const Effect& e : compiled_effects()) list.push_back(&e);
  for (const auto& e : added_) list.push_back(e.get());
  return list;
}

const Effect* EffectLibrary::find(std::string_view name) const {
  for (const Effect* e : all())
    if (same_name(e->name, name)) return e;
  return nullptr;
}

const Effect& EffectLibrary::add(Effect effect) {
  if (find(effect.name))
    throw InputError({"a second effect '" + std::string(effect.name) + "'", std::string(effect.source),
                      "the name is taken", "choose another name"});
  return *added_.emplace_back(std::make_shared<const Effect>(std::move(effect)));
}

std::string EffectLibrary::names() const {
  std::string names;
  for (const Effect* e : all()) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return names;
}
std::string EffectLibrary::names(Slot slot) const {
  std::string names;
  for (const Effect* e : all())
    if (e->slot == slot) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return names;
}

const EffectLibrary& compiled() {
  static const EffectLibrary nothing_added;
  return nothing_added;
}

}  // namespace swingbank::sim::library
