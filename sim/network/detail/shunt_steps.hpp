#pragma once
// Steps of switched shunts between solutions of the power flow. Used by powerflow.cpp only.
#include <functional>
#include <vector>

#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

class ShuntSteps {
 public:
  explicit ShuntSteps(const Network& network);
  /// Moves every shunt whose voltage lies outside its band by one step towards it; `change` adds a
  /// susceptance [pu] at a bus. False if none moved.
  bool step(const std::function<double(int)>& voltage, const std::function<void(int, double)>& change);
  /// Those that were moved or stand outside their bands.
  [[nodiscard]] std::vector<SteppedShunt> result(const std::function<double(int)>& voltage) const;

 private:
  struct Bank {
    double now;    ///< susceptance [pu]
    int last = 0;  ///< direction of the last step
  };
  const Network& n_;
  std::vector<Bank> banks_;
};

}  // namespace swingbank::sim::network
