#include "validate/calibrate/detail/screen.hpp"

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"
#include "sim/plant/usual.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/fit/sign.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::calibrate {

std::vector<double> Screen::draw(std::uint64_t k) const {
  for (std::uint32_t attempt = 0; attempt < 100; ++attempt) {
    std::vector<double> values;
    for (std::size_t i = 0; i < free_.size(); ++i)
      values.push_back(one(free_[i], sim::normal_pair(seed_ + k, attempt, i)[0]));
    if (playin::can_exist_beside(with(values), plant_)) return values;
  }
  return own();
}

sim::plant::Plant Screen::with(const std::vector<double>& values) const {
  sim::plant::Plant plant = plant_;
  for (std::size_t i = 0; i < free_.size(); ++i) sim::plant::parameter_value(plant, free_[i].id) = values[i];
  return plant;
}

std::vector<double> Screen::own() const {
  sim::plant::Plant plant = plant_;
  std::vector<double> values;
  for (const auto& f : free_) values.push_back(sim::plant::parameter_value(plant, f.id));
  return values;
}

double Screen::one(const fit::FreeParameter& f, double normal) const {
  const auto& record = sim::plant::parameter_record(plant_, f.id);
  sim::plant::Plant plant = plant_;
  const double value = sim::plant::parameter_value(plant, f.id);
  const double moved = fit::moves_by_logarithm(record, value) ? value * std::exp(f.prior_sd * normal)
                                                              : value + normal * fit::axis_unit(plant_, f);
  const auto [low, high] = sim::plant::search_range(record, value);
  return std::clamp(moved, low, high);
}

}  // namespace swingbank::validate::calibrate
