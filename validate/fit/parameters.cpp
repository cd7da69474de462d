// Which parameters of a plant are free, and the way to their values.
#include <algorithm>
#include <stdexcept>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

namespace {

/// Machine, transformer if there is one, controls, instruments.
template <class Plant>
auto& block_of(Plant& plant, int block) {
  if (block < 0) throw std::out_of_range("no such block");
  if (block == 0) return plant.machine;
  int left = block - (plant.transformer.effect ? 2 : 1);
  if (left < 0) return plant.transformer;
  const auto controls = static_cast<int>(plant.controls.size());
  if (left < controls) return plant.controls[static_cast<std::size_t>(left)];
  return plant.measurements.at(static_cast<std::size_t>(left - controls));
}

}  // namespace

const sim::plant::Block& block_at(const sim::plant::Plant& plant, int block) {
  return block_of(plant, block);
}
const sim::Effect& block_effect(const sim::plant::Plant& plant, int block) {
  return *block_of(plant, block).effect;
}
const sim::Parameter& parameter_record(const sim::plant::Plant& plant, int block, int index) {
  return block_effect(plant, block).parameters[static_cast<std::size_t>(index)];
}
double& parameter_value(sim::plant::Plant& plant, int block, int index) {
  return block_of(plant, block).p[static_cast<std::size_t>(index)];
}
double parameter_value(const sim::plant::Plant& plant, int block, int index) {
  return block_of(plant, block).p[static_cast<std::size_t>(index)];
}
std::vector<double> values_of(const sim::plant::Plant& plant, const std::vector<FreeParameter>& free) {
  std::vector<double> values;
  for (const auto& f : free) values.push_back(parameter_value(plant, f.block, f.index));
  return values;
}
int block_count(const sim::plant::Plant& plant) {
  return static_cast<int>(1 + (plant.transformer.effect ? 1 : 0) + plant.controls.size() +
                          plant.measurements.size());
}
int find_block(const sim::plant::Plant& plant, const sim::Effect& effect) {
  for (int block = 0; block < block_count(plant); ++block)
    if (&block_effect(plant, block) == &effect) return block;
  return -1;
}

std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, int block, double spread) {
  const sim::Effect& effect = block_effect(plant, block);
  const auto& values = block_of(plant, block).p;
  std::vector<double> instants;
  if (effect.instants) instants = effect.instants(effect.law.get(), values.data());
  std::vector<FreeParameter> free;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = effect.parameters[i];
    if (p.is_code() || values[i] == 0.0 || values[i] == p.neutral) continue;
    if (std::ranges::count(instants, values[i])) continue;
    free.push_back({block, static_cast<int>(i), spread});
  }
  return free;
}
std::vector<FreeParameter> free_parameters(const sim::plant::Plant& plant, double spread) {
  std::vector<FreeParameter> all;
  const auto blocks = static_cast<int>(sim::plant::block_parameters(plant).size());
  for (int b = 0; b < blocks; ++b) {
    const auto some = free_parameters(plant, b, spread);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace swingbank::validate::fit
