#pragma once
// Identification of a plant's parameters by block and index, and by name.
#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

// The blocks of a plant are numbered: machine, transformer if there is one, controls, measurements.
constexpr int kMachineBlock = 0;  ///< number of the machine's block
/// Returns the number of the first control.
int first_control(const Plant& plant);
/// Returns the number of the first measurement.
int first_measurement(const Plant& plant);
/// Returns the number of blocks.
int block_count(const Plant& plant);

/// Returns the parameter values of every block except the measurements, which the equations do not use.
std::vector<std::vector<double>> block_parameters(const Plant& plant);

/// Returns the block. Throws std::out_of_range if the plant has no such block.
Block& block_at(Plant& plant, int block);
/// The same, read only.
const Block& block_at(const Plant& plant, int block);
/// Returns the effect of a block.
const Effect& block_effect(const Plant& plant, int block);
/// Returns the first block with that effect.
std::optional<int> find_block(const Plant& plant, const Effect& effect);
/// Inserts a block in the order of slots, after the blocks of its slot. A transformer replaces the present
/// one. Returns the block's number.
int insert_block(Plant& plant, Block block);

/// One parameter of a plant.
struct ParameterId {
  int block = kMachineBlock;  ///< number of the block
  int index = 0;              ///< index of its record in the block's effect
  /// Compares block, then index.
  friend auto operator<=>(const ParameterId&, const ParameterId&) = default;
};
/// Returns every parameter of a block, in the order of the effect's records.
std::vector<ParameterId> parameters_of(const Plant& plant, int block);
/// Returns the parameter's record: name, unit, default, range.
const Parameter& parameter_record(const Plant& plant, ParameterId id);
/// Returns a reference to the parameter's value [unit of its record].
double& parameter_value(Plant& plant, ParameterId id);
/// Returns the parameter's value [unit of its record].
double parameter_value(const Plant& plant, ParameterId id);
/// Returns the same parameter in `other`, in the first block with the same effect. Its block number may
/// differ.
std::optional<ParameterId> same_parameter(const Plant& other, const Plant& plant, ParameterId id);

/// A parameter's name: "SEXS.K", or "K" where the effect is unambiguous.
struct ParameterName {
  std::string effect, parameter;  ///< effect may be empty
  /// Returns the name as text.
  [[nodiscard]] std::string text() const;
};
/// Splits a text "SEXS.K" or "K".
ParameterName read_parameter_name(std::string_view text);
/// Returns the name of a plant's parameter.
ParameterName parameter_name(const Plant& plant, ParameterId id);
/// Returns the parameters of `among` that match the texts: "SEXS.K", or "K" of any block. A text that matches
/// no parameter, or only parameters of an earlier text, is a problem at `where` that states `why` and lists
/// all names.
std::vector<ParameterId> find_parameters(const Plant& plant, const std::vector<ParameterId>& among,
                                         const std::vector<std::string>& texts, const std::string& where,
                                         const std::string& why, Problems& problems);

}  // namespace swingbank::sim::plant
