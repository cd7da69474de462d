#pragma once
// Interface of a network. A file networks/<name>.cpp defines make_network_<name>. CMake generates the list of
// all networks from the file names; a new file needs no other registration.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace at {
class Tensor;
}

namespace swingbank::train::networks {

/// Estimated parameter: raw value = output x unit + origin. `mean`: mean of its training targets [raw units].
struct Target {
  std::string name;
  double mean = 0, unit = 1, origin = 0;
};

/// Shape of a network. `outputs`: number of estimated parameters, which `targets` describes. `output_bias`:
/// initial bias of each output, the mean of its training targets in scaled units, so that every ReLU is
/// active at the first step.
struct NetworkShape {
  std::int64_t channels = 0, samples = 0, outputs = 0;
  std::vector<float> output_bias;
  std::vector<Target> targets = {};
};

/// Rows of a training step. A unit's dropout depends on the step's key and on the row's position in the
/// batch. Thus it does not depend on the number of ranks that share the batch.
struct StepRows {
  std::uint64_t key = 0;
  std::uint64_t first = 0, stride = 1;  ///< row i is at position first + i x stride
};

class Network {
 public:
  virtual ~Network() = default;
  /// Returns batch x outputs from x, batch x channels x samples. `training` enables dropout; null:
  /// evaluation. In training, a network with its own loss() may append columns for it.
  virtual at::Tensor forward(const at::Tensor& x, const StepRows* training) = 0;
  /// Returns auxiliary features of rows, batch x numbers, for a network that is built on this one. The last
  /// numbers are the outputs. Undefined tensor: the network has no auxiliary features.
  virtual at::Tensor describe(const at::Tensor& x);
  /// Returns the loss of the outputs of forward(x, &rows), a mean over the rows. `targets`: batch x outputs
  /// [scaled units]. Undefined tensor: the loss is the weighted squared error, and `training` affects only
  /// the dropout in forward().
  virtual at::Tensor loss(const at::Tensor& outputs, const at::Tensor& targets);
  /// Returns the trained tensors (leaves), in a fixed order.
  virtual std::vector<at::Tensor> parameters() = 0;
};

struct NetworkRecord {
  std::string_view name;
  std::unique_ptr<Network> (*make)(const NetworkShape&);
};
/// Returns all networks in order of name.
const std::vector<NetworkRecord>& all_networks();
/// Creates a network with weights from torch's generator, which must be seeded before. Throws InputError with
/// the known names for an unknown name, or if the series are too short for the network.
std::unique_ptr<Network> make_network(const std::string& name, const NetworkShape& shape);
/// Returns the number of weights.
std::int64_t parameter_count(Network& network);

}  // namespace swingbank::train::networks
