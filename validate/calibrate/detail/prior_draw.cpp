#include "validate/calibrate/detail/prior_draw.hpp"

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"
#include "sim/plant/usual.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/fit/sign.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::calibrate {

std::vector<double> prior_draw(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free,
                               std::uint64_t stream) {
  const std::vector<double> own = fit::values_of(plant, free);
  for (std::uint32_t attempt = 0; attempt < 100; ++attempt) {
    std::vector<double> values = own;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto& record = sim::plant::parameter_record(plant, free[i].id);
      const double normal = sim::normal_pair(stream, attempt, i)[0];
      const double moved = fit::moves_by_logarithm(record, own[i])
                               ? own[i] * std::exp(free[i].prior_sd * normal)
                               : own[i] + normal * fit::axis_unit(plant, free[i]);
      const auto [low, high] = sim::plant::search_range(record, own[i]);
      values[i] = std::clamp(moved, low, high);
    }
    if (playin::can_exist_beside(fit::with_values(plant, free, values), plant)) return values;
  }
  return own;
}

}  // namespace swingbank::validate::calibrate
