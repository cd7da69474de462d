#pragma once
// Where a parameter stands in a plant: the order of the plant's blocks, and parameters by number and by name.
#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

// The blocks of a plant are numbered: machine, transformer if there is one, controls, measurements.
constexpr int kMachineBlock = 0;
int first_control(const Plant& plant);
int first_measurement(const Plant& plant);
int block_count(const Plant& plant);

/// Values of every block but the measurements: of all that has a part in the plant's equations.
std::vector<std::vector<double>> block_parameters(const Plant& plant);

/// Throws std::out_of_range where the plant has no such block.
Block& block_at(Plant& plant, int block);
const Block& block_at(const Plant& plant, int block);
const Effect& block_effect(const Plant& plant, int block);
/// The first block with that effect.
std::optional<int> find_block(const Plant& plant, const Effect& effect);
/// Puts a block where its slot's order asks for it, behind what stands in that slot; a transformer takes the
/// place of the one before. Returns the block's number.
int insert_block(Plant& plant, Block block);

/// One parameter of a plant.
struct ParameterId {
  int block = kMachineBlock;
  int index = 0;  ///< in the records of the block's effect
  friend auto operator<=>(const ParameterId&, const ParameterId&) = default;
};
/// Every parameter of a block, in the order of the effect's records.
std::vector<ParameterId> parameters_of(const Plant& plant, int block);
/// What is known of a parameter.
const Parameter& parameter_record(const Plant& plant, ParameterId id);
double& parameter_value(Plant& plant, ParameterId id);
double parameter_value(const Plant& plant, ParameterId id);
/// The same parameter in `other`, where it may stand in a block of another number: that of the first block
/// with the same effect.
std::optional<ParameterId> same_parameter(const Plant& other, const Plant& plant, ParameterId id);

/// A parameter as people write it: "SEXS.K", or "K" where the effect goes without saying.
struct ParameterName {
  std::string effect, parameter;  ///< effect: may be empty
  [[nodiscard]] std::string text() const;
};
ParameterName read_parameter_name(std::string_view text);
ParameterName parameter_name(const Plant& plant, ParameterId id);
/// The parameters of `among` that the texts mean: "SEXS.K", or "K" of whatever block. A text that means none,
/// or only those that a text before it means, is a problem at `where` that says `why` and lists the names of
/// all.
std::vector<ParameterId> find_parameters(const Plant& plant, const std::vector<ParameterId>& among,
                                         const std::vector<std::string>& texts, const std::string& where,
                                         const std::string& why, Problems& problems);

}  // namespace swingbank::sim::plant
