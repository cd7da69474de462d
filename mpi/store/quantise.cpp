#include "mpi/store/quantise.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::mpi::store {

namespace {

constexpr double kLargestCode = 32767.0;

/// Quantises one channel of one row. `scale`: offset, step.
void encode_channel(const float* values, std::size_t count, float* scale, std::int16_t* codes) {
  const auto [low, high] = std::minmax_element(values, values + count);
  scale[0] = *low == *high ? *low : static_cast<float>(0.5 * (double{*low} + double{*high}));
  scale[1] = static_cast<float>((double{*high} - double{*low}) / (2.0 * kLargestCode));
  const double offset = scale[0], step = scale[1];
  for (std::size_t k = 0; k < count; ++k) {
    const double code = step > 0.0 ? std::nearbyint((values[k] - offset) / step) : 0.0;
    codes[k] = static_cast<std::int16_t>(std::clamp(code, -kLargestCode, kLargestCode));
  }
}

}  // namespace

void quantise(RowBlock& b) {
  b.codes.resize(b.records.size());
  b.code_scale.resize(b.rows * b.channels * kScaleColumns);
  for (std::size_t i = 0; i < b.rows * b.channels && b.samples > 0; ++i)
    encode_channel(b.records.data() + i * b.samples, b.samples, b.code_scale.data() + i * kScaleColumns,
                   b.codes.data() + i * b.samples);
  decode(b);
}

void decode(RowBlock& b) {
  b.records.resize(b.codes.size());
  for (std::size_t i = 0; i < b.codes.size(); ++i) {
    const float* scale = b.code_scale.data() + i / b.samples * kScaleColumns;
    b.records[i] = static_cast<float>(double{scale[0]} + double{scale[1]} * b.codes[i]);
  }
}

}  // namespace swingbank::mpi::store
