#include "train/networks/network.hpp"

#include <ATen/ATen.h>

#include "base/problem.hpp"

namespace swingbank::train::networks {

at::Tensor Network::describe(const at::Tensor&) { return {}; }
at::Tensor Network::loss(const at::Tensor&, const at::Tensor&) { return {}; }

std::unique_ptr<Network> make_network(const std::string& name, const NetworkShape& shape) {
  std::string names;
  for (const auto& record : all_networks()) {
    if (record.name == name) return record.make(shape);
    names += (names.empty() ? "" : ", ") + std::string(record.name);
  }
  throw InputError({"no network called '" + name + "'", "kind of the network",
                    "this version has no such network", "choose one of: " + names});
}

std::int64_t parameter_count(Network& network) {
  std::int64_t count = 0;
  for (const auto& p : network.parameters()) count += p.numel();
  return count;
}

}  // namespace swingbank::train::networks
