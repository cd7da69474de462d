#pragma once
// Joint fit of the parameters of a plant and of a hypothesis, started from the optima of the hypothesis's
// identification.
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "validate/fit/axis.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {

/// A control hypothesis whose block (the added effect) was identified without the rest of the plant.
struct Identified {
  Hypothesis hypothesis;                      ///< hypothesis that adds the block
  reduced::Trial trial;                       ///< its block and free parameters
  std::vector<reduced::Optimum> optima = {};  ///< best first
  /// Cost of the best optimum; after a fit of the whole plant, the cost of that fit.
  double cost = std::numeric_limits<double>::infinity();
  std::vector<fit::Fit> fits = {};  ///< fits of the whole plant
  bool polished = false;            ///< whether the fits are complete
  std::string companion = {};       ///< see Judgement
  double companion_gain = 0;        ///< see Judgement
  /// Returns the best fit; null if there is none or all failed.
  [[nodiscard]] const fit::Fit* best() const;
  /// Returns the input of the machine on which the block acts: torque or field voltage.
  [[nodiscard]] event::InputKind input() const {
    return hypothesis.side == Side::mechanical ? event::InputKind::torque : event::InputKind::field;
  }
};

/// Joint fits of the whole plant for identified hypotheses on one base model.
class Polish {
 public:
  /// Reduced plant at one linearisation point.
  using Reduced = std::shared_ptr<const reduced::Reduction>;
  /// Prepares the fits. `base_model` must outlive this object.
  explicit Polish(const BaseModel& base_model);

  /// Free parameters of the base model.
  [[nodiscard]] const std::vector<fit::FreeParameter>& free() const { return free_; }
  /// Returns the selection that contains only this input.
  [[nodiscard]] static reduced::Inputs only(event::InputKind kind) {
    return {.torque = kind == event::InputKind::torque, .field = kind == event::InputKind::field};
  }
  /// Linearises the plant about the best fit, with a column for each of `changes`. Throws InputError if the
  /// plant cannot be simulated.
  [[nodiscard]] Reduced linear_about(const Identified& h,
                                     std::span<const reduced::Change> changes = {}) const;
  /// Fits the whole plant for a few steps from the best optimum. This optimum may be far from the
  /// linearisation point of `from`, the plant on which `h` was identified.
  void briefly(Identified& h, const reduced::Reduction& from) const;
  /// Fits the whole plant from each optimum. Before the fit, the plant is linearised about the optimum and
  /// the block is identified again, in at most three rounds. These rounds follow narrow valleys of the cost
  /// in which a fit is slow, such as that of gain and T'do. An optimum is not fitted if a round after the
  /// first predicts a cost above `goal`.
  void polish(Identified& h, const reduced::Reduction& from, double goal) const;

 private:
  /// Parameter values of the whole plant and state of each event, in the coordinates of the fit.
  struct Point {
    Eigen::VectorXd plant, own;  ///< parameters of the base model and of the hypothesis
    std::vector<Eigen::VectorXd> states;
  };
  [[nodiscard]] static Eigen::VectorXd own_of(const Identified& h, const std::vector<double>& values);
  [[nodiscard]] Point expected(const Identified& h, const reduced::Reduction& reduction,
                               const reduced::Optimum& found) const;
  /// Returns the linearisation point, with the block at the values of the optimum `found`.
  [[nodiscard]] static Point reference(const Identified& h, const reduced::Reduction& reduction,
                                       const reduced::Optimum& found);
  /// Calls `act` at `to`, at most five times. After each call that returns false, or if the plant cannot be
  /// simulated, `to` is moved halfway back to `from`. Returns whether a call returned true.
  template <class F>
  static bool between(const Point& from, Point& to, F act);
  [[nodiscard]] sim::plant::Plant whole(const Identified& h, const Point& point) const;
  [[nodiscard]] std::vector<event::EventState> states_of(const Point& point) const;
  [[nodiscard]] double prior_cost(const Identified& h, const Point& point) const;
  [[nodiscard]] Reduced linear_about(const Identified& h, const Point& point,
                                     std::span<const reduced::Change> changes = {}) const;
  [[nodiscard]] fit::Fit fit_from(const Identified& h, const Point& point, fit::FitOptions options) const;

  const BaseModel& base_model_;
  std::vector<fit::FreeParameter> free_;
  std::vector<fit::Axis> axes_;  ///< axes of `free_`
};

}  // namespace swingbank::validate::hypothesis
