#include "sim/core/effect.hpp"

namespace swingbank::sim {

std::string_view slot_name(Slot slot) {
  constexpr std::array<std::string_view, kSlots.size()> names = {
      "machine",    "transformer", "compensator", "setpoint", "governor",   "shaft",
      "stabiliser", "limiter",     "exciter",     "load",     "measurement"};
  return names[static_cast<std::size_t>(slot)];
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

}  // namespace swingbank::sim
