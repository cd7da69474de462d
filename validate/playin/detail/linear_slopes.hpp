#pragma once
// Slopes of a driven plant's answer from the plant as it is linear about the ends of each step: for a search,
// which needs no last digits of them.
#include <array>
#include <span>
#include <vector>

#include "validate/playin/detail/driven_equations.hpp"

namespace swingbank::validate::playin {

/// Where a run without slopes went: every step and sample, and both sides of every instant.
struct Trace {
  /// A guard of the equations that passes zero just behind a node, its rate [1/s] and its value there.
  struct Passed {
    int guard = -1;
    double rate = 0, value = 0;
  };
  struct Node {
    double t;  ///< [s]
    Side side;
    enum class Kind { sample, step, before, after } kind;  ///< the last two: of an instant
    int switching;                                         ///< at an instant: of the curve; -1: of an effect
    Passed passed = {};
  };
  std::vector<Node> nodes;
  std::vector<double> x, dx;                    ///< [node][state]: states and their derivatives
  std::vector<Complex> v;                       ///< [node]: terminal voltage in the plant's frame [pu]
  std::vector<std::array<double, kOutputs>> y;  ///< [sample]: outputs, speed in the plant's frame
};

/// Whether slopes of this run can be had from its trace.
bool can_be_linear(const Drive& run);

/// Fills in the slopes of an answer from the run's trace. Between two nodes the slopes S of the states obey
/// S' = A S + B, with A and B differences over 1e-6 at both, and are carried on by the two-derivative formula
/// of order 3 whose stability function is the (1,2) Pade approximation (B. L. Ehle, SIAM J. Math. Anal. 4
/// (1973) 671): what is faster than a step dies out at once. False where the slopes are not finite.
bool add_linear_slopes(const Drive& run, std::span<const Direction> directions, const Trace& trace,
                       Response& answer);

}  // namespace swingbank::validate::playin
