#pragma once
// One-dimensional stride-1 'same' convolution (cross-correlation, as torch::nn::Conv1d) with a long kernel,
// computed in the frequency domain. The transforms are dense products with sines and cosines. At kernel
// lengths around 100 a matrix product at full speed is faster than a memory-bound FFT.
#include <cstdint>
#include <memory>

namespace at {
class Tensor;
}

namespace swingbank::train::networks {

struct SpectralMatrices;  // the transform matrices, in single precision

/// Transform matrices for one series length and kernel length; computed once per layer.
class SpectralPlan {
 public:
  /// length, kernel [samples] >= 1. The period is the smallest one that causes no aliasing in the 'same'
  /// outputs.
  SpectralPlan(std::int64_t length, std::int64_t kernel);
  ~SpectralPlan();
  SpectralPlan(SpectralPlan&&) noexcept;
  SpectralPlan(const SpectralPlan&) = delete;

  [[nodiscard]] std::int64_t length() const { return length_; }
  [[nodiscard]] std::int64_t kernel() const { return kernel_; }
  [[nodiscard]] std::int64_t period() const { return period_; }
  [[nodiscard]] std::int64_t frequencies() const { return period_ / 2 + 1; }
  [[nodiscard]] const std::shared_ptr<const SpectralMatrices>& matrices() const { return matrices_; }

 private:
  std::int64_t length_, kernel_, period_;
  std::shared_ptr<const SpectralMatrices> matrices_;
};

/// Returns the convolution, length x batch x out, without bias. x: length x batch x in; weight: kernel x in x
/// out (weight[k][i][o] is Conv1d's weight[o][i][k]). Differentiable in x and weight. As in Conv1d, the extra
/// zero of an even kernel is on the right.
at::Tensor spectral_conv(const at::Tensor& x, const at::Tensor& weight, const SpectralPlan& plan);

}  // namespace swingbank::train::networks
