#pragma once
// Voltage regulation by generators, and reactive limits. Used by powerflow.cpp only.
#include <functional>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Role of a bus in the power flow.
struct Role {
  enum Kind {
    out,        ///< isolated
    slack,      ///< angle and magnitude are given
    regulated,  ///< magnitude is given; the bus's own generators regulate it
    load,       ///< P and Q are given
    leads,      ///< Q is unknown; it sets the magnitude at another bus, `target`
    follows     ///< Q is that of bus `leader` times the ratio of their shares
  };
  Kind kind = load;
  Complex generation{};   ///< power of its generators: P, and Q if it is given [pu]
  double setpoint = 0.0;  ///< regulated magnitude [pu]
  double share = 1.0;
  int target = -1, leader = -1;
};
using Roles = std::vector<Role>;

/// Roles of all buses; buses at a reactive limit are load buses.
class Regulation {
 public:
  explicit Regulation(const Network& network);
  [[nodiscard]] const Roles& roles() const { return roles_; }
  /// Returns the sum of the machine bases in service at each bus [MVA].
  [[nodiscard]] const std::vector<double>& supply() const { return supply_; }
  /// Moves buses to a reactive limit, or from a limit back to regulation. `reactive`: reactive power of a
  /// bus's generators [pu]; `voltage`: magnitude at a bus [pu]. Returns false if nothing changed.
  bool limit(const std::function<double(int)>& reactive, const std::function<double(int)>& voltage);
  /// Returns the buses that are at a limit.
  [[nodiscard]] std::vector<int> at_limit() const;

 private:
  struct Source {  ///< the generators of one bus
    int bus, target;
    double setpoint, share = 0.0, q_min = 0.0, q_max = 0.0;
    bool bounded = true;
    int side = 0;     ///< -1, +1: at the lower, upper limit
    int returns = 0;  ///< number of returns from a limit
  };
  void assign();
  const Network& n_;
  Roles base_, roles_;
  std::vector<double> supply_;
  std::vector<Source> sources_;
};

}  // namespace swingbank::sim::network
