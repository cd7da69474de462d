#include "validate/calibrate/detail/newton.hpp"

#include <algorithm>
#include <cmath>

#include "sim/plant/usual.hpp"
#include "validate/fit/sign.hpp"

namespace swingbank::validate::calibrate {

Eigen::VectorXd off_prior(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                          const std::vector<fit::FreeParameter>& free) {
  Eigen::VectorXd off(static_cast<Eigen::Index>(free.size()));
  for (Eigen::Index i = 0; i < off.size(); ++i) {
    const auto& f = free[static_cast<std::size_t>(i)];
    const double start = sim::plant::parameter_value(believed, f.id),
                 value = sim::plant::parameter_value(plant, f.id);
    off[i] = fit::moves_by_logarithm(sim::plant::parameter_record(plant, f.id), start)
                 ? std::log(value / start) / f.prior_sd
                 : (value - start) / fit::axis_unit(believed, f);
  }
  return off;
}

Eigen::VectorXd prior_information(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                                  const std::vector<fit::FreeParameter>& free) {
  Eigen::VectorXd information = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(free.size()));
  for (Eigen::Index i = 0; i < information.size(); ++i) {
    const auto& f = free[static_cast<std::size_t>(i)];
    if (!fit::moves_by_logarithm(sim::plant::parameter_record(plant, f.id),
                                 sim::plant::parameter_value(believed, f.id)))
      information[i] = std::pow(fit::axis_unit(plant, f) / fit::axis_unit(believed, f), 2);
  }
  return information;
}

sim::plant::Plant stepped(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free,
                          const Eigen::VectorXd& step) {
  sim::plant::Plant moved = plant;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const auto& f = free[static_cast<std::size_t>(i)];
    const auto& record = sim::plant::parameter_record(plant, f.id);
    double& value = sim::plant::parameter_value(moved, f.id);
    const double move = fit::axis_unit(plant, f) * step[i], old = value;
    const auto [low, high] = sim::plant::search_range(record, old);
    value =
        std::clamp(fit::moves_by_logarithm(record, old) ? old * std::exp(move / old) : old + move, low, high);
  }
  return moved;
}

Eigen::VectorXd Secants::step(const Eigen::VectorXd& plain) {
  // No secant update if the product of the last and the predicted step is below this share of the squared
  // last step.
  constexpr double kMinSecantShare = 1e-3;
  if (taken_.size() > 0) {
    const Eigen::VectorXd done = inverse_ * (plain_ - plain);
    if (const double along = taken_.dot(done); std::abs(along) > kMinSecantShare * taken_.squaredNorm())
      inverse_ += ((taken_ - done) * (taken_.transpose() * inverse_) / along).eval();
  }
  plain_ = plain;
  return inverse_ * plain;
}

}  // namespace swingbank::validate::calibrate
