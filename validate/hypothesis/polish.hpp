#pragma once
// Joint optimisation of a plant and its hypothesis from where identification saw an optimum.
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "validate/fit/axis.hpp"
#include "validate/hypothesis/search.hpp"
#include "validate/reduced/identify.hpp"

namespace swingbank::validate::hypothesis {

/// A hypothesis whose block was identified alone.
struct Identified {
  Hypothesis hypothesis;
  reduced::Trial trial;
  std::vector<reduced::Optimum> optima = {};  ///< best first
  /// Of the best optimum or, once the whole plant was fitted, of that.
  double cost = std::numeric_limits<double>::infinity();
  std::vector<fit::Fit> fits = {};  ///< of the whole plant
  bool polished = false;            ///< they went to the end
  std::string companion = {};       ///< see Judgement
  double companion_gain = 0;
  /// Null: there is none, or all failed.
  [[nodiscard]] const fit::Fit* best() const;
  [[nodiscard]] event::InputKind input() const {
    return hypothesis.side == Side::mechanical ? event::InputKind::torque : event::InputKind::field;
  }
};

class Polish {
 public:
  using Reduced = std::shared_ptr<const reduced::Reduction>;
  explicit Polish(const Stage& stage);

  /// Free parameters of the stage's plant.
  [[nodiscard]] const std::vector<fit::FreeParameter>& free() const { return free_; }
  [[nodiscard]] static reduced::Inputs only(event::InputKind kind) {
    return {.torque = kind == event::InputKind::torque, .field = kind == event::InputKind::field};
  }
  /// The plant linear about the best fit, and in these changes of it. Throws InputError where that cannot be
  /// simulated.
  [[nodiscard]] Reduced linear_about(const Identified& h,
                                     std::span<const reduced::Change> changes = {}) const;
  /// Fits the whole plant for a few steps from the best optimum of a linear point that may be far away.
  void briefly(Identified& h, const reduced::Reduction& from) const;
  /// Fits the whole plant from each optimum, as far as it may come below `goal`; there is no fit where the
  /// plant that is linear about the optimum itself says that it does not. Before that, the plant is
  /// made linear about the optimum itself, from where the block is identified again, a few times: the reduced
  /// plant goes along valleys in which a fit is slow, as that of gain and T'do.
  void polish(Identified& h, const reduced::Reduction& from, double goal) const;

 private:
  /// Values of a whole plant and of each event, on their axes.
  struct Point {
    Eigen::VectorXd plant, own;  ///< parameters of the stage's plant, of the hypothesis
    std::vector<Eigen::VectorXd> states;
  };
  [[nodiscard]] static Eigen::VectorXd own_of(const Identified& h, const std::vector<double>& values);
  [[nodiscard]] Point expected(const Identified& h, const reduced::Reduction& reduction,
                               const reduced::Optimum& found) const;
  /// The linear point itself, with the block that was found.
  [[nodiscard]] static Point reference(const Identified& h, const reduced::Reduction& reduction,
                                       const reduced::Optimum& found);
  /// Calls `act` at `to` or, where that returns false or the plant cannot be simulated, part of the way back
  /// to `from`; `to` is then that point. Returns whether it did anywhere.
  template <class F>
  static bool between(const Point& from, Point& to, F act);
  [[nodiscard]] sim::plant::Plant whole(const Identified& h, const Point& point) const;
  [[nodiscard]] std::vector<event::EventState> states_of(const Point& point) const;
  [[nodiscard]] double prior_cost(const Identified& h, const Point& point) const;
  [[nodiscard]] Reduced linear_about(const Identified& h, const Point& point,
                                     std::span<const reduced::Change> changes = {}) const;
  [[nodiscard]] fit::Fit fit_from(const Identified& h, const Point& point, fit::FitOptions options) const;

  const Stage& stage_;
  std::vector<fit::FreeParameter> free_;
  std::vector<fit::Axis> axes_;  ///< of them
};

}  // namespace swingbank::validate::hypothesis
