#pragma once
// Random parameter sets about the model's values, as starts of a calibration.
#include <cstdint>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Returns values of the free parameters, drawn from the prior about the plant's values and limited to the
/// search ranges. A draw is repeated until its values are physically possible. After 100 attempts, the
/// plant's own values are returned. The draw depends on `stream` only.
std::vector<double> prior_draw(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free,
                               std::uint64_t stream);

}  // namespace swingbank::validate::calibrate
