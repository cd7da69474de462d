#pragma once
// What a network of this folder is. A file networks/<name>.cpp defines make_network_<name>; the list of all
// of them is generated from the file names by CMake, so that a new file is the whole registration.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace at {
class Tensor;
}

namespace swingbank::train::networks {

/// outputs is the number of parameters estimated; output_bias (one each) is where the output layer starts, in
/// the scaled units of Features: the mean of the training targets, so that no ReLU is dead at the first step.
struct NetworkShape {
  std::int64_t channels = 0, samples = 0, outputs = 0;
  std::vector<float> output_bias;
};

class Network {
 public:
  virtual ~Network() = default;
  /// x: batch x channels x samples; returns batch x outputs. `training` switches dropout on.
  virtual at::Tensor forward(const at::Tensor& x, bool training) = 0;
  /// What the network knows of a row, for whoever builds on it: batch x numbers, of which the last are its
  /// outputs. Undefined: it has nothing more to tell than these.
  virtual at::Tensor describe(const at::Tensor& x);
  /// Leaves to be trained, in a fixed order.
  virtual std::vector<at::Tensor> parameters() = 0;
};

struct NetworkRecord {
  std::string_view name;
  std::unique_ptr<Network> (*make)(const NetworkShape&);
};
/// All networks in order of name.
const std::vector<NetworkRecord>& all_networks();
/// Weights come from torch's generator: seed it first. Throws InputError that lists the names if there is
/// none such, and if the shape is too short for the network.
std::unique_ptr<Network> make_network(const std::string& name, const NetworkShape& shape);
/// Number of weights.
std::int64_t parameter_count(Network& network);

}  // namespace swingbank::train::networks
