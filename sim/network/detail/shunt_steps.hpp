#pragma once
// Steps of switched shunts between power-flow solutions. Used by powerflow.cpp only.
#include <functional>
#include <vector>

#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

class ShuntSteps {
 public:
  explicit ShuntSteps(const Network& network);
  /// Moves every shunt whose regulated voltage is outside its band by one step towards the band. `change`
  /// adds a susceptance [pu] at a bus. Returns false if none moved.
  bool step(const std::function<double(int)>& voltage, const std::function<void(int, double)>& change);
  /// Returns the shunts that were moved or whose regulated voltage is outside its band.
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
