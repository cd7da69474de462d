#pragma once
// Which bus holds which voltage, and what becomes of it at a reactive limit. Used by powerflow.cpp only.
#include <functional>
#include <map>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// What a bus is to the power flow.
struct Role {
  enum Kind {
    out,     ///< isolated
    slack,   ///< angle and magnitude are given
    holds,   ///< the magnitude is given, by its own generators
    load,    ///< P and Q are given
    leads,   ///< Q is whatever holds the magnitude of `target`, another bus
    follows  ///< Q is to that of `leader` as the shares are
  };
  Kind kind = load;
  Complex generation{};  ///< P, and where it is given Q, of its generators [pu]
  double held = 0.0;     ///< magnitude it holds [pu]
  double share = 1.0;
  int target = -1, leader = -1;
};
using Roles = std::vector<Role>;

/// The roles of the buses, with those that reached a reactive limit as load buses.
class Regulation {
 public:
  explicit Regulation(const Network& network);
  [[nodiscard]] const Roles& roles() const { return roles_; }
  /// Per bus: MVA of the generators in service.
  [[nodiscard]] const std::vector<double>& supply() const { return supply_; }
  /// Moves buses to their limits or back, by the reactive power that the generators of a bus deliver and the
  /// voltages [pu]; false if nothing moved.
  bool limit(const std::function<double(int)>& reactive, const std::function<double(int)>& voltage);
  /// Buses that stand at a limit.
  [[nodiscard]] std::vector<int> at_limit() const;

 private:
  struct Source {  ///< the generators of one bus
    int bus, target;
    double held, share = 0.0, q_min = 0.0, q_max = 0.0;
    bool bounded = true;
    int side = 0;     ///< -1, +1: at the lower, upper limit
    int returns = 0;  ///< how often it came back from a limit
  };
  void assign();
  const Network& n_;
  Roles base_, roles_;
  std::vector<double> supply_;
  std::vector<Source> sources_;
};

}  // namespace swingbank::sim::network
