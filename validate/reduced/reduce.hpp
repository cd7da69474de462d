#pragma once
// The plant as its inputs see it. About an inference the residuals of an event are linear in the plant's
// numbers, the event's own, torque and field voltage. What the event's own numbers can do is taken out by
// orthogonal triangles. What stays says how well any course u(t) of one input, made by whatever block, would
// fit the records with everything else following:
//   |r + T d + L g u|^2 + |(offset + d) / spread|^2, least over the plant's numbers d.
// One of these, d_g, acts through the input's gain too: the rate at which a machine's state follows the input
// is 1/T'do of a field voltage, 1/2H of a torque. It stays explicit: g = exp(exponent d_g).
#include <Eigen/SparseCore>

#include "validate/playin/open_loop.hpp"
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced {

/// Both inputs of all events.
class Reduction {
 public:
  Reduction(Inference inference, const event::WhitenedEvents& events, const sim::Conventions& conventions);

  [[nodiscard]] const Inference& inference() const { return inference_; }
  [[nodiscard]] const sim::Conventions& conventions() const { return conventions_; }
  /// One event.
  struct Event {
    playin::OpenLoop loop;                                   ///< what the plant's controls see
    Eigen::SparseMatrix<double, Eigen::RowMajor> over_hats;  ///< mean over each knot's hat: [knot][moment]
    /// Rows of [plant | torque | field | residual without either input].
    Eigen::MatrixXd triangle;
    Knots knots;
  };
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// How many knots all events have.
  [[nodiscard]] Eigen::Index knots() const { return knots_; }
  /// Between two samples [s].
  [[nodiscard]] double step() const { return step_; }
  /// What an input was at the inference, at the knots of all events.
  [[nodiscard]] const Eigen::VectorXd& course(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_ : field_;
  }
  /// The plant's number that is in an input's gain, and its exponent.
  struct Gain {
    Eigen::Index number = -1;  ///< -1: none is
    double exponent = 0;
  };
  [[nodiscard]] Gain gain(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_gain_ : field_gain_;
  }

 private:
  [[nodiscard]] Gain find_gain(const event::WhitenedEvents& events, event::InputKind kind) const;
  Inference inference_;
  sim::Conventions conventions_;
  std::vector<Event> events_;
  Eigen::Index knots_ = 0;
  double step_ = 0;
  Eigen::VectorXd torque_, field_;
  Gain torque_gain_, field_gain_;
};

/// One input of the plant, its course to be explained.
class ReducedPlant {
 public:
  /// `other`: the course of the other input at the knots of all events, null: it stays free in time. `held`
  /// marks numbers of the plant that stand still, because their blocks are not there; empty: none.
  ReducedPlant(const Reduction& reduction, event::InputKind kind, const Eigen::VectorXd* other,
               const std::vector<char>& held = {});

  /// Cost of each course [knot of all events][course] with its move of the gain's number.
  [[nodiscard]] Eigen::VectorXd costs(const Eigen::MatrixXd& courses, const Eigen::VectorXd& gains) const;
  /// Half the gradient and the Gauss-Newton curvature of one course's cost, by the gain's number and by what
  /// moves the course as `slopes` [knot][number] do; the plant follows.
  struct Bowl {
    Eigen::MatrixXd curvature;
    Eigen::VectorXd gradient;
  };
  [[nodiscard]] Bowl bowl(const Eigen::VectorXd& course, double gain, const Eigen::MatrixXd& slopes) const;
  /// Moves of the plant's numbers that belong to a course.
  [[nodiscard]] Eigen::VectorXd plant_of(const Eigen::VectorXd& course, double gain) const;
  [[nodiscard]] Reduction::Gain gain() const { return gain_; }

 private:
  struct Event {
    Eigen::VectorXd r, by_gain;
    Eigen::MatrixXd T, L;  ///< by the numbers that follow, by the course
  };
  [[nodiscard]] double factor(double gain) const { return std::exp(gain_.exponent * gain); }

  Reduction::Gain gain_;
  std::vector<Eigen::Index> free_;  ///< numbers that follow
  Eigen::Index numbers_;
  std::vector<Event> events_;
  Eigen::MatrixXd inverse_;  ///< of the curvature by the numbers that follow
  Eigen::VectorXd first_;    ///< half the gradient by them that beliefs have
  double believed_ = 0;      ///< cost of the numbers where they stand
  double gain_precision_ = 0, gain_offset_ = 0;
};

}  // namespace swingbank::validate::reduced
