#include "sim/core/effect.hpp"

#include <algorithm>
#include <cctype>

namespace swingbank::sim {

std::string_view slot_name(Slot slot) {
  switch (slot) {
    case Slot::machine:
      return "machine";
    case Slot::stabiliser:
      return "stabiliser";
    case Slot::limiter:
      return "limiter";
    case Slot::exciter:
      return "exciter";
    case Slot::governor:
      return "governor";
  }
  return "unknown";
}

int Effect::parameter_index(std::string_view parameter) const {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == parameter || parameters[i].symbol == parameter) return static_cast<int>(i);
  return -1;
}

std::vector<double> Effect::standard_parameters() const {
  std::vector<double> p;
  for (const auto& record : parameters) p.push_back(record.standard);
  return p;
}

const Effect* find_effect(std::string_view name) {
  const auto same = [](char a, char b) {
    return std::toupper(static_cast<unsigned char>(a)) == std::toupper(static_cast<unsigned char>(b));
  };
  for (const auto& e : all_effects())
    if (std::ranges::equal(e.name, name, same)) return &e;
  return nullptr;
}

std::string effect_names() {
  std::string names;
  for (const auto& e : all_effects()) names += (names.empty() ? "" : ", ") + std::string(e.name);
  return names;
}

}  // namespace swingbank::sim
