#pragma once
// Approximate sensitivities of a response from the plant linearised along its trajectory, for a search that
// does not need their last digits.
#include <cstddef>
#include <span>
#include <vector>

#include "validate/playin/detail/playback_equations.hpp"

namespace swingbank::validate::playin {

/// Trajectory of a run without sensitivities: every step and sample, and both sides of every switching time
/// and of every discontinuity of the equations.
struct Trace {
  /// A guard function (zero at a discontinuity of the equations) that passes zero just after a node, with its
  /// rate [1/s].
  struct Passed {
    int guard = -1;
    double rate = 0;
  };
  struct Node {
    double t;  ///< [s]
    Side side;
    /// The last two kinds are the sides of a switching time or of a discontinuity.
    enum class Kind { sample, step, before, after } kind;
    int switching;  ///< index of a switching in the curve; -1: none
    Passed passed = {};
  };
  std::vector<Node> nodes;
  std::vector<double> x, dx;  ///< [node][state]: states and their derivatives
  std::vector<Complex> v;     ///< [node]: terminal voltage in the plant's frame [pu]
  std::size_t samples = 0;
};

/// Returns whether sensitivities of this run can be computed from its trajectory.
bool can_be_linear(const PlaybackRun& run);

/// Computes the sensitivities of a response from the run's trajectory. Between two nodes the state
/// sensitivities obey \f$S' = A S + B\f$, with A and B from finite differences (step 1e-6) at both nodes.
/// They are integrated by the two-derivative formula of order 3 whose stability function is the (1,2) Pade
/// approximation (B. L. Ehle, SIAM J. Math. Anal. 4 (1973) 671). The formula damps modes that are faster than
/// a step within that step. A step is halved if A changes within it, because a limit begins or ceases to act.
/// Returns false if the result is not finite.
bool add_linear_sensitivities(const PlaybackRun& run, std::span<const SensitivityParameter> parameters,
                              const Trace& trace, Response& response);

}  // namespace swingbank::validate::playin
