#include "sim/network/tie.hpp"

#include <algorithm>

namespace swingbank::sim::network {

void raise_impedance(Network& network, double& r, double& x, const std::string& place) {
  if (!(std::abs(Complex(r, x)) <= kLeastImpedance) || (r == 0.0 && x == kLeastImpedance)) return;
  r = 0.0;
  x = kLeastImpedance;
  network.remark("zero-impedance branches (|Z| <= 1e-6 pu) are given X = 1e-6 pu", place);
}

bool is_tie(const Branch& branch) { return std::abs(Complex(branch.r, branch.x)) <= kTieImpedance; }

std::vector<Tie> ties(const Network& network, const Topology& topology) {
  std::vector<Tie> list;
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const Branch& b = network.branches[i];
    if (b.in_service && is_tie(b) && !std::ranges::binary_search(topology.open, static_cast<int>(i)))
      list.push_back({b.from, b.to, std::polar(b.tap, b.shift), Complex(b.r, b.x)});
  }
  return list;
}

}  // namespace swingbank::sim::network
