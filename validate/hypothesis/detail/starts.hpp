#pragma once
// Where a hypothesis starts beside a structure: draws in order of what they leave, or, beside a structure
// that nearly fits, as small as the score test would make them. For search.cpp only.
#include <optional>

#include "validate/fit/rao_score.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {

/// So many starts are fitted.
constexpr std::size_t kTries = 4;

/// A hypothesis with its starts: its standard values, then draws in order of the misfit that they leave
/// before any fit. A draw that leaves the least misfit may be one that hardly acts.
struct Candidate {
  Hypothesis hypothesis;
  std::vector<sim::plant::Plant> starts;
  /// For each start beside the fitted stage, its misfit and the values of all free parameters. The standard
  /// start comes first, and the others follow as they suit the stage.
  std::vector<std::pair<double, std::vector<double>>> nested = {};
  /// Values of its standard start beside the fitted stage, but with the blocks that the fit has bent as the
  /// model has them. A missing effect bends what stands nearest to it, and a short fit does not lead back.
  /// Empty if no block is bent.
  std::vector<double> unbent = {};
  double promise = 0;  ///< by how much chi2 would fall, by the score test
};

/// The plant at its prior mean: the hypothesis at its first start, and the parameters of earlier stages at
/// their prior means.
sim::plant::Plant prior_mean(const Stage& stage, const Hypothesis& h);

class StartFinder {
 public:
  explicit StartFinder(const Stage& stage);
  /// Whether the stage nearly fits; the score test chooses the starts then.
  [[nodiscard]] bool near() const { return score_.has_value(); }
  /// The hypothesis with its starts; it has none where it does not act.
  [[nodiscard]] Candidate of(Hypothesis h) const;
  /// Candidate::unbent.
  [[nodiscard]] std::vector<double> unbent(const Hypothesis& h) const;

 private:
  /// A limiter may wait for more than its standard values let it meet in these records. Then draws that act
  /// become its starts. Returns false where the starts stay as they were.
  bool provoke(Hypothesis& h) const;
  void screen(const Hypothesis& h, Candidate& c) const;
  /// Values of all free parameters, with this start beside the fitted stage.
  [[nodiscard]] std::vector<double> beside_fit(const Hypothesis& h, const std::vector<double>& start) const;
  [[nodiscard]] static sim::plant::Plant with_values(const Hypothesis& h,
                                                     const std::vector<fit::FreeParameter>& free,
                                                     const std::vector<double>& values);
  /// Fills in starts beside the fitted stage, the standard one first and then as they suit the stage.
  void nest(const Hypothesis& h, Candidate& c) const;
  /// Parameters that switch the effect off at their neutral value, by their index in the free parameters.
  [[nodiscard]] std::vector<std::size_t> amplitudes(const Hypothesis& h,
                                                    const std::vector<double>& standard) const;
  /// The plant with this start beside the fitted stage.
  [[nodiscard]] sim::plant::Plant beside(const Hypothesis& h, const std::vector<double>& start) const;
  /// Squared change of an event's answer by this start, in units of noise: of the first event in which it
  /// acts, else of the event that it changes most. NaN where it cannot be run.
  [[nodiscard]] double largest_move(const Hypothesis& h, const std::vector<double>& start) const;
  /// Squared change of an event's answer, in units of noise; NaN where it cannot be run.
  [[nodiscard]] double moves(const Hypothesis& h, const sim::plant::Plant& plant, std::size_t event) const;
  /// Runs the score test at the neutral point. Each start is as small as a first step along its amplitude
  /// would make it. The standard start comes first, then those with most to gain. An effect without an
  /// amplitude acts in full or not at all; its starts are ordered by how little they raise chi2. An effect
  /// with nothing to gain gets no starts. Slopes are taken of the first `looks` starts.
  void score(const Hypothesis& h, std::size_t looks, Candidate& c) const;
  /// More draws of an effect without an amplitude, each with what it raises chi2 by.
  void add_far(const Hypothesis& h, std::vector<std::pair<double, std::vector<double>>>& starts) const;
  /// A limiter that stands above its pickup at the start cannot be run, and one far below it does nothing.
  /// Finds a start that acts by going `beyond` the first point between the two that runs; none if this start
  /// does not act.
  [[nodiscard]] std::optional<std::vector<double>> between(const Hypothesis& h,
                                                           const std::vector<double>& failing,
                                                           const std::vector<double>& idle,
                                                           double beyond) const;
  /// Whether an answer differs from the structure's.
  [[nodiscard]] bool acts(const Hypothesis& h, const sim::plant::Plant& plant) const;
  /// Whether two answers differ by a hundredth of the noise somewhere.
  [[nodiscard]] static bool differ(const playin::Response& x, const playin::Response& y,
                                   const event::WhitenedEvent& of);

  const Stage& stage_;
  std::optional<fit::ScoreTest> score_;
};

}  // namespace swingbank::validate::hypothesis
