#pragma once
// Where a hypothesis starts beside a structure: draws in order of what they leave, or, beside a structure
// that nearly fits, as small as the score test would make them. For search.cpp only.
#include <optional>

#include "validate/score_test.hpp"
#include "validate/search.hpp"

namespace swingbank::validate {

/// Starts that are fitted.
constexpr std::size_t kTries = 4;
/// Fall of chi2 below which a hypothesis is not worth a fit: half the evidence asked for.
constexpr double kHopeless = 20;

/// A hypothesis with its starts: its standard values, then draws in order of what they leave before any fit.
/// What leaves least may be what hardly acts.
struct Candidate {
  Hypothesis hypothesis;
  std::vector<sim::Plant> starts;
  /// The stage as fitted, with each start: its misfit, and all free parameters. The standard start first, the
  /// others as they suit the stage.
  std::vector<std::pair<double, std::vector<double>>> nested = {};
  /// Its standard start beside the stage as fitted, but for the blocks that the fit has bent: these as the
  /// model has them. What is missing bends what stands nearest to it, and a short fit does not lead back.
  /// Empty: none is bent.
  std::vector<double> unbent = {};
  double promise = 0;  ///< by how much chi2 would fall, by the score test
};

class StartFinder {
 public:
  explicit StartFinder(const Stage& stage);
  /// Whether the stage nearly fits: then the score test chooses.
  [[nodiscard]] bool near() const { return score_.has_value(); }
  /// No starts: it does not act here.
  [[nodiscard]] Candidate of(Hypothesis h) const;
  /// Candidate::unbent.
  [[nodiscard]] std::vector<double> unbent(const Hypothesis& h) const;

 private:
  /// About what its parameters are believed: its first start, and what earlier stages brought as that was
  /// believed.
  [[nodiscard]] sim::Plant believed(const Hypothesis& h) const;
  /// A limiter may wait for more than the standard values let it meet here: then draws that act are its
  /// starts. False: they stay what they were.
  bool provoke(Hypothesis& h) const;
  void screen(const Hypothesis& h, Candidate& c) const;
  /// The stage as fitted, with this start: all free parameters.
  [[nodiscard]] std::vector<double> beside_fit(const Hypothesis& h, const std::vector<double>& start) const;
  [[nodiscard]] static sim::Plant with_values(const Hypothesis& h, const std::vector<FreeParameter>& free,
                                              const std::vector<double>& values);
  /// Starts beside what was fitted, the standard one first, then as they suit the stage.
  void nest(const Hypothesis& h, Candidate& c) const;
  /// Parameters that switch the effect off at their neutral value, by their place in the free ones.
  [[nodiscard]] std::vector<std::size_t> amplitudes(const Hypothesis& h,
                                                    const std::vector<double>& standard) const;
  /// The stage as fitted, with this start.
  [[nodiscard]] sim::Plant beside(const Hypothesis& h, const std::vector<double>& start) const;
  /// Squared change by this start of the first event's answer that it changes so much that it acts, else of
  /// the one it changes most, in units of noise; NaN where it cannot be run.
  [[nodiscard]] double largest_move(const Hypothesis& h, const std::vector<double>& start) const;
  /// Squared change of an event's answer, in units of noise; NaN where it cannot be run.
  [[nodiscard]] double moves(const Hypothesis& h, const sim::Plant& plant, std::size_t event) const;
  /// Score test at the neutral point: each start as small as a first step along its amplitude would make it,
  /// those with most to gain first, the standard one before them. What has no amplitude acts in full or not
  /// at all: of its starts those first that raise chi2 least. Nothing to gain: no starts, not worth a fit.
  /// Slopes of the first `looks` starts.
  void score(const Hypothesis& h, std::size_t looks, Candidate& c) const;
  /// A limiter that stands above its pickup at the start fails, one far below it does nothing: one that acts,
  /// so far beyond the first between the two that runs; none if it does not.
  [[nodiscard]] std::optional<std::vector<double>> between(const Hypothesis& h,
                                                           const std::vector<double>& failing,
                                                           const std::vector<double>& idle,
                                                           double beyond) const;
  /// Misfit of a start, everything else as in the model; whether it acts at all.
  [[nodiscard]] bool answer(const sim::Plant& plant, const Hypothesis& h, double& misfit, bool& acts) const;
  /// Whether two answers differ by a hundredth of the noise somewhere.
  [[nodiscard]] static bool differ(const Response& x, const Response& y, const FitEvent& e);
  [[nodiscard]] static double misfit_of(const Response& r, const FitEvent& e);

  const Stage& stage_;
  std::optional<ScoreTest> score_;
};

}  // namespace swingbank::validate
