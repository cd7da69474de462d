#pragma once
// Priors and ordering constraints of a fit as Ceres cost functions, and the constant quantities of a fit.
#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/plant/orderings.hpp"
#include "validate/fit/axis.hpp"
#include "validate/fit/states.hpp"

namespace swingbank::validate::fit::fitting {

using Kind = playin::SensitivityParameter::Kind;

/// Quantities that stay constant during a fit.
struct Setting {
  const sim::plant::Plant* plant;
  const sim::Conventions* conventions;
  const noise::WhitenedEvents* events;
  std::vector<Axis> axes;
  double tolerance;
  bool lenient = false;  ///< see FitOptions::lenient
  bool goes_on = false;  ///< whether a lenient search reuses sensitivities that predicted a step well
  /// Whether the start passes can_exist_beside(`plant`). If so, the search refuses every plant that fails it.
  bool can_exist = false;
};

/// Returns the plant with the parameter values of `z`.
inline sim::plant::Plant moved(const Setting& s, const double* z) {
  sim::plant::Plant plant = *s.plant;
  for (std::size_t i = 0; i < s.axes.size(); ++i)
    parameter_value(plant, s.axes[i].where.id) = s.axes[i].value(z[i]);
  return plant;
}

/// Gaussian priors: one residual z / prior_sd per variable, multiplied by the square root of the reduced
/// chi-square `discrepancy`.
class GaussianPrior : public ceres::CostFunction {
 public:
  GaussianPrior(std::vector<double> prior_sd, const double* discrepancy)
      : prior_sd_(std::move(prior_sd)), discrepancy_(discrepancy) {
    set_num_residuals(static_cast<int>(prior_sd_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(prior_sd_.size()));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = prior_sd_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double weight = prior_sd_[i] > 0 ? std::sqrt(*discrepancy_) / prior_sd_[i] : 0.0;
      residuals[i] = weight * blocks[0][i];
      if (jacobians && jacobians[0])
        for (std::size_t j = 0; j < n; ++j) jacobians[0][i * n + j] = i == j ? weight : 0.0;
    }
    return true;
  }

 private:
  std::vector<double> prior_sd_;
  const double* discrepancy_;
};

/// Penalty that enforces the physical orderings of a machine's parameters (Xd > X'd > ...). It acts if the
/// gap between two parameters is below kMargin, or below their gap at the start if that is smaller. A start
/// that violates an ordering is drawn back towards the ordering, unless the violation may be intended
/// (Ordering::may_be_meant).
class Walls : public ceres::CostFunction {
 public:
  Walls(const Setting& setting, const double* discrepancy) : setting_(setting), discrepancy_(discrepancy) {
    const sim::plant::Block& machine = setting.plant->machine;
    for (const auto& o : sim::plant::orderings(machine)) {
      if (o.may_be_meant && gap(machine, o) < 0) continue;
      const Wall wall{{o.greater, o.smaller},
                      {axis_of(o.greater), axis_of(o.smaller)},
                      std::clamp(gap(machine, o), 0.0, kMargin)};
      if (wall.axes[0] >= 0 || wall.axes[1] >= 0) walls_.push_back(wall);
    }
    set_num_residuals(static_cast<int>(walls_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(setting.axes.size()));
  }
  [[nodiscard]] bool empty() const { return walls_.empty(); }
  /// Returns the ordering whose penalty acts on the parameter `axis` at z, for example "X''d > Xl"; empty:
  /// none.
  [[nodiscard]] std::string active_constraint(std::size_t axis, const double* z) const {
    const sim::plant::Plant plant = moved(setting_, z);
    const auto symbol = [&](int parameter) {
      return std::string(plant.machine.effect->parameters[static_cast<std::size_t>(parameter)].symbol);
    };
    for (const Wall& wall : walls_)
      if (std::ranges::count(wall.axes, static_cast<int>(axis)) > 0 &&
          gap(plant.machine, {wall.parameters[0], wall.parameters[1]}) < wall.foot)
        return symbol(wall.parameters[0]) + " > " + symbol(wall.parameters[1]);
    return "";
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = setting_.axes.size();
    const sim::plant::Plant plant = moved(setting_, blocks[0]);
    const double weight = std::sqrt(*discrepancy_) / kSteepness;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const Wall& wall = walls_[w];
      const double beyond = wall.foot - gap(plant.machine, {wall.parameters[0], wall.parameters[1]});
      residuals[w] = beyond > 0 ? weight * beyond : 0.0;
      if (!jacobians || !jacobians[0]) continue;
      double* row = jacobians[0] + w * n;
      std::fill(row, row + n, 0.0);
      for (std::size_t side = 0; beyond > 0 && side < 2; ++side) {
        if (wall.axes[side] < 0) continue;
        const auto at = static_cast<std::size_t>(wall.axes[side]);
        const double value = plant.machine.p[static_cast<std::size_t>(wall.parameters[side])];
        row[at] = (side == 0 ? -1.0 : 1.0) * weight * setting_.axes[at].derivative(blocks[0][at]) / value;
      }
    }
    return true;
  }

 private:
  static constexpr double kMargin = 0.01;      ///< gap ln(greater / smaller) below which the penalty acts
  static constexpr double kSteepness = 0.001;  ///< shortfall of the gap that costs one reduced chi-square
  struct Wall {
    std::array<int, 2> parameters, axes;  ///< greater, smaller; axis -1: that parameter is fixed
    double foot;                          ///< kMargin, or the gap at the start if that is smaller
  };
  static double gap(const sim::plant::Block& b, const sim::plant::Ordering& o) {
    return std::log(b.p[static_cast<std::size_t>(o.greater)] / b.p[static_cast<std::size_t>(o.smaller)]);
  }
  [[nodiscard]] int axis_of(int parameter) const {
    for (std::size_t i = 0; i < setting_.axes.size(); ++i)
      if (setting_.axes[i].where.id == sim::plant::ParameterId{sim::plant::kMachineBlock, parameter})
        return static_cast<int>(i);
    return -1;
  }
  const Setting& setting_;
  const double* discrepancy_;
  std::vector<Wall> walls_;
};

}  // namespace swingbank::validate::fit::fitting
