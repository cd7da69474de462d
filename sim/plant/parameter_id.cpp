#include "sim/plant/parameter_id.hpp"

#include <algorithm>
#include <stdexcept>

namespace swingbank::sim::plant {
namespace {

template <class AnyPlant>
auto& block_of(AnyPlant& plant, int block) {
  if (block < 0) throw std::out_of_range("no such block");
  if (block == kMachineBlock) return plant.machine;
  if (block < first_control(plant)) return plant.transformer;
  const int measurement = block - first_measurement(plant);
  if (measurement < 0) return plant.controls[static_cast<std::size_t>(block - first_control(plant))];
  return plant.measurements.at(static_cast<std::size_t>(measurement));
}

}  // namespace

int first_control(const Plant& plant) { return kMachineBlock + (plant.transformer.effect ? 2 : 1); }
int first_measurement(const Plant& plant) {
  return first_control(plant) + static_cast<int>(plant.controls.size());
}
int block_count(const Plant& plant) {
  return first_measurement(plant) + static_cast<int>(plant.measurements.size());
}
Block& block_at(Plant& plant, int block) { return block_of(plant, block); }
const Block& block_at(const Plant& plant, int block) { return block_of(plant, block); }
const Effect& block_effect(const Plant& plant, int block) { return *block_at(plant, block).effect; }

std::optional<int> find_block(const Plant& plant, const Effect& effect) {
  for (int block = 0; block < block_count(plant); ++block)
    if (&block_effect(plant, block) == &effect) return block;
  return {};
}

int insert_block(Plant& plant, Block block) {
  const Slot slot = block.effect->slot;
  if (slot == Slot::transformer) {
    plant.transformer = std::move(block);
    return first_control(plant) - 1;
  }
  if (slot == Slot::measurement) {
    plant.measurements.push_back(std::move(block));
    return block_count(plant) - 1;
  }
  const auto at =
      std::ranges::upper_bound(plant.controls, slot, {}, [](const Block& b) { return b.effect->slot; });
  const auto index = static_cast<int>(at - plant.controls.begin());
  plant.controls.insert(at, std::move(block));
  return first_control(plant) + index;
}

std::vector<std::vector<double>> block_parameters(const Plant& plant) {
  std::vector<std::vector<double>> parameters;
  for (int block = 0; block < first_measurement(plant); ++block)
    parameters.push_back(block_at(plant, block).p);
  return parameters;
}

std::vector<ParameterId> parameters_of(const Plant& plant, int block) {
  std::vector<ParameterId> ids;
  const auto count = static_cast<int>(block_effect(plant, block).parameters.size());
  for (int index = 0; index < count; ++index) ids.push_back({block, index});
  return ids;
}
const Parameter& parameter_record(const Plant& plant, ParameterId id) {
  return block_effect(plant, id.block).parameters[static_cast<std::size_t>(id.index)];
}
double& parameter_value(Plant& plant, ParameterId id) {
  return block_at(plant, id.block).p[static_cast<std::size_t>(id.index)];
}
double parameter_value(const Plant& plant, ParameterId id) {
  return block_at(plant, id.block).p[static_cast<std::size_t>(id.index)];
}
std::optional<ParameterId> same_parameter(const Plant& other, const Plant& plant, ParameterId id) {
  const auto block = find_block(other, block_effect(plant, id.block));
  if (!block) return {};
  return ParameterId{*block, id.index};
}

std::string ParameterName::text() const { return effect.empty() ? parameter : effect + "." + parameter; }

ParameterName read_parameter_name(std::string_view text) {
  const auto dot = text.find('.');
  if (dot == text.npos) return {"", std::string(text)};
  return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}
ParameterName parameter_name(const Plant& plant, ParameterId id) {
  return {std::string(block_effect(plant, id.block).name), std::string(parameter_record(plant, id).name)};
}

std::vector<ParameterId> find_parameters(const Plant& plant, const std::vector<ParameterId>& among,
                                         const std::vector<std::string>& texts, const std::string& where,
                                         const std::string& why, Problems& problems) {
  std::vector<ParameterId> left = among, found;
  for (const auto& text : texts) {
    const auto meant = std::stable_partition(left.begin(), left.end(), [&](ParameterId id) {
      const ParameterName name = parameter_name(plant, id);
      return name.text() != text && name.parameter != text;
    });
    if (meant == left.end()) {
      std::string names;
      for (const ParameterId id : among)
        names += (names.empty() ? "" : ", ") + parameter_name(plant, id).text();
      problems.add("parameter '" + text + "'", where, why, "use one of " + names);
    }
    found.insert(found.end(), meant, left.end());
    left.erase(meant, left.end());
  }
  return found;
}

}  // namespace swingbank::sim::plant
