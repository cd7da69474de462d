#include "train/networks/detail/dropout.hpp"

#include <cmath>

#include "train/data/random.hpp"

namespace swingbank::train::networks {

at::Tensor dropout(const at::Tensor& h, double rate, const StepRows* rows, std::uint64_t layer) {
  if (rows == nullptr) return h;
  const auto dropped = static_cast<std::uint64_t>(std::ldexp(rate, 64));
  const auto kept = static_cast<float>(1.0 / (1.0 - rate));
  at::Tensor mask = at::empty(h.sizes(), at::kFloat);
  const auto units = static_cast<std::uint64_t>(h.size(1));
  float* to = mask.data_ptr<float>();
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(h.size(0)); ++i) {
    const std::uint64_t row = data::mix(data::mix(rows->key ^ layer) ^ (rows->first + i * rows->stride));
    for (std::uint64_t unit = 0; unit < units; ++unit) *to++ = data::mix(row ^ unit) < dropped ? 0.0f : kept;
  }
  return h * mask;
}

}  // namespace swingbank::train::networks
