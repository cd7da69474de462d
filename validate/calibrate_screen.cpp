#include "validate/calibrate_screen.hpp"

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"
#include "validate/calibrate_slopes.hpp"

namespace swingbank::validate {

bool possible(const sim::Plant& plant) {
  Problems problems;
  bool physical = true;
  const auto check = [&](const sim::Block& b) {
    if (!b.effect) return;
    b.effect->check(b.effect->law.get(), b.p.data(), "", problems);
    physical = physical && (!b.effect->unphysical || b.effect->unphysical(b.p.data()).empty());
  };
  check(plant.machine);
  check(plant.transformer);
  for (const auto& b : plant.controls) check(b);
  return physical && problems.empty();
}

std::vector<double> Screen::draw(std::uint64_t k) const {
  for (std::uint32_t attempt = 0; attempt < 100; ++attempt) {
    std::vector<double> values;
    for (std::size_t i = 0; i < free_.size(); ++i)
      values.push_back(one(free_[i], sim::normal_pair(seed_ + k, attempt, i)[0]));
    if (possible(with(values))) return values;
  }
  return own();
}

sim::Plant Screen::with(const std::vector<double>& values) const {
  sim::Plant plant = plant_;
  for (std::size_t i = 0; i < free_.size(); ++i)
    parameter_value(plant, free_[i].block, free_[i].index) = values[i];
  return plant;
}

std::vector<double> Screen::own() const {
  sim::Plant plant = plant_;
  std::vector<double> values;
  for (const auto& f : free_) values.push_back(parameter_value(plant, f.block, f.index));
  return values;
}

double Screen::one(const FreeParameter& f, double normal) const {
  const auto& record = parameter_record(plant_, f.block, f.index);
  sim::Plant plant = plant_;
  const double value = parameter_value(plant, f.block, f.index);
  const double moved =
      value > 0 ? value * std::exp(f.spread * normal) : value + normal * axis_unit(plant_, f);
  return std::clamp(moved, record.low, record.high);
}

}  // namespace swingbank::validate
