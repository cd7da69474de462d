// Selection of a plant's free parameters, and their values.
#include <algorithm>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

std::vector<double> values_of(const sim::plant::Plant& plant, const std::vector<FreeParameter>& free) {
  std::vector<double> values;
  for (const auto& f : free) values.push_back(parameter_value(plant, f.id));
  return values;
}
sim::plant::Plant with_values(sim::plant::Plant plant, const std::vector<FreeParameter>& free,
                              const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) parameter_value(plant, free[i].id) = values[i];
  return plant;
}

std::string bounds_text(const std::vector<FittedParameter>& parameters) {
  std::string names;
  for (const auto& p : parameters)
    if (p.at_bound)
      names += (names.empty() ? "" : ", ") + p.full_name() +
               (p.active_constraint.empty() ? "" : " (limited by " + p.active_constraint + ")");
  return names.empty() ? "" : names + ": at a bound; the 95 % interval is not valid.";
}

std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, int block, double prior_sd) {
  const sim::Effect& effect = block_effect(plant, block);
  const auto& values = block_at(plant, block).p;
  std::vector<double> switching_times;
  if (effect.switching_times)
    switching_times = effect.switching_times(effect.user_model.get(), values.data());
  std::vector<FreeParameter> free;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = effect.parameters[i];
    if (p.is_code() || values[i] == 0.0 || values[i] == p.null_value) continue;
    if (std::ranges::count(switching_times, values[i])) continue;
    free.push_back({{block, static_cast<int>(i)}, prior_sd});
  }
  return free;
}
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, double prior_sd) {
  std::vector<FreeParameter> all;
  for (int b = 0; b < sim::plant::first_measurement(plant); ++b) {
    const auto some = free_parameters(plant, b, prior_sd);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace swingbank::validate::fit
