#include "sim/core/effect.hpp"

namespace swingbank::sim {

std::string_view slot_name(Slot slot) {
  constexpr std::array<std::string_view, kSlots.size()> names = {
      "machine",        "transformer",   "compensator",  "setpoint",    "governor",
      "shaft",          "stabiliser",    "limiter",      "exciter",     "plant_control",
      "torque_control", "pitch_control", "aerodynamics", "drive_train", "electrical_control",
      "load",           "measurement"};
  return names[static_cast<std::size_t>(slot)];
}

std::string_view kind_name(const Effect& effect) {
  return effect.converter ? "converter" : slot_name(effect.slot);
}

std::string slot_conflict(const Effect& source, const Effect& control) {
  if (!is_control(control.slot) || control.slot == Slot::setpoint) return {};
  if (is_of_converter(control.slot) == source.converter) {
    if (!source.converter || source.takes_commands) return {};
    return std::string(source.name) + " takes no commands: its equations contain the control";
  }
  return std::string(slot_name(control.slot)) + " belongs to a " +
         (source.converter ? "synchronous machine" : "converter") + ", but " + std::string(source.name) +
         " is a " + (source.converter ? "converter" : "synchronous machine");
}

int Effect::parameter_index(std::string_view parameter) const {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == parameter || parameters[i].symbol == parameter) return static_cast<int>(i);
  return -1;
}

std::vector<double> Effect::default_parameters() const {
  std::vector<double> p;
  for (const auto& record : parameters) p.push_back(record.default_value);
  return p;
}

}  // namespace swingbank::sim
