#pragma once
// Blocks identified against the input that the records ask for: each by itself, driven by what it sees, from
// many starts at once. The plant follows every trial in closed form (reduce.hpp), so that no trial runs the
// plant.
#include <cstdint>
#include <vector>

#include "validate/reduced/reduce.hpp"

namespace swingbank::validate::reduced {

/// What is tried: a plant with the block in it, at the values that beliefs are about, and its free
/// parameters.
struct Trial {
  sim::plant::Plant plant;
  std::vector<fit::FreeParameter> free;
  std::uint64_t stream = 0;  ///< of the draws: the same trial gets the same ones wherever it is made
};

/// An optimum that was found.
struct Optimum {
  std::vector<double> values;  ///< of the trial's free parameters
  Eigen::VectorXd plant;       ///< moves of the plant's numbers, on the inference's axes
  Eigen::VectorXd course;      ///< that the block makes beside the plant's own controls, at all knots [pu]
  double cost = 0;             ///< chi2 of the records, with what is believed of plant and block
  int starts = 0;              ///< how many ended within 1 of this cost
};

struct IdentifyOptions {
  int draws = 192;  ///< looked at
  int kept = 8;     ///< the best of them, which are fitted
  int steps = 12;   ///< of each
};

/// Different optima, best first; none where no draw can be run. `other`: course of the other input at all
/// knots, null: it stays free. `known`: values of the trial's free parameters to start from as well.
std::vector<Optimum> identify(const Reduction& reduction, event::InputKind input, const Trial& trial,
                              const Eigen::VectorXd* other, const IdentifyOptions& options = {},
                              const std::vector<std::vector<double>>& known = {});

/// Numbers of the inference's plant whose blocks a plant does not have.
std::vector<char> held_by(const Inference& inference, const sim::plant::Plant& plant);

/// The events' states with what a plant's controls add to those of another as its input, at every moment;
/// each is driven by what it sees in the first plant. The other input becomes zero. Throws InputError where
/// the plant cannot be run.
std::vector<event::EventState> with_course_of(const sim::plant::PlantUnderTest& tested,
                                              const sim::plant::Plant& without, event::InputKind input,
                                              const event::WhitenedEvents& events,
                                              std::vector<event::EventState> states);

}  // namespace swingbank::validate::reduced
