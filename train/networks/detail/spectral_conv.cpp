#include "train/networks/detail/spectral_conv.hpp"

#include <ATen/ATen.h>
#include <torch/csrc/autograd/custom_function.h>

#include <cmath>

#include "base/constants.hpp"

namespace swingbank::train::networks {
using at::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Transform matrices for F frequencies, L samples and K taps. Spectra are stored in two planes: all real
/// parts, then all imaginary parts.
struct SpectralMatrices {
  Tensor series;   ///< 2F x L: samples to spectrum
  Tensor taps;     ///< 2F x K: taps to spectrum
  Tensor inverse;  ///< L x 2F: spectrum to samples, shifted by the left padding
};

namespace {

/// Returns a matrix, 2F x n: the cosines of 2 pi f (first + i) / period, and below them the negative sines.
/// If `folded`, each frequency is weighted for the inverse real transform.
Tensor waves(std::int64_t period, std::int64_t first, std::int64_t n, bool folded) {
  const std::int64_t f_count = period / 2 + 1;
  Tensor m = at::empty({2 * f_count, n}, at::kFloat);
  float* out = m.data_ptr<float>();
  for (std::int64_t f = 0; f < f_count; ++f) {
    const bool alone = f == 0 || 2 * f == period;  // has no conjugate partner in the real transform
    const double weight = folded ? (alone ? 1.0 : 2.0) / static_cast<double>(period) : 1.0;
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int64_t turn = ((f * (first + i)) % period + period) % period;  // exact: integers
      const double angle = constants::turn * static_cast<double>(turn) / static_cast<double>(period);
      out[f * n + i] = static_cast<float>(weight * std::cos(angle));
      out[(f_count + f) * n + i] = static_cast<float>(-weight * std::sin(angle));
    }
  }
  return m;
}

/// Transforms a series, n x a x b, to its spectrum's planes 2 x F x a x b.
Tensor transform(const Tensor& matrix, const Tensor& t) {
  const auto a = t.size(1), b = t.size(2);
  return at::mm(matrix, t.reshape({t.size(0), a * b})).view({2, matrix.size(0) / 2, a, b});
}
/// Applies a matrix to planes 2 x F x a x b; returns n x a x b.
Tensor transform_back(const Tensor& matrix, const Tensor& planes) {
  const auto a = planes.size(2), b = planes.size(3);
  return at::mm(matrix, planes.view({2 * planes.size(1), a * b})).view({matrix.size(0), a, b});
}

/// Correlation theorem: Y = X conj(W) per frequency. A complex product takes three real ones:
///   T = (Xr + Xi) Wr,  Yr = T - Xi (Wr - Wi),  Yi = T - Xr (Wr + Wi).
Tensor spectral_product(const Tensor& x, const Tensor& w) {
  const Tensor xr = x[0], xi = x[1], wr = w[0], wi = w[1];
  Tensor y = at::empty({2, x.size(1), x.size(2), w.size(3)}, x.options());
  Tensor yr = y[0], yi = y[1];
  at::bmm_out(yi, xr + xi, wr);
  at::baddbmm_out(yr, yi, xi, wr - wi, 1, -1);
  yi.baddbmm_(xr, wr + wi, 1, -1);
  return y;
}

/// dX = dY W:  T = (dYr + dYi) Wr,  re = T - dYi (Wr + Wi),  im = T - dYr (Wr - Wi).
Tensor gradient_of_series(const Tensor& dy, const Tensor& w) {
  const Tensor wr = w[0], wi = w[1];
  Tensor dx = at::empty({2, dy.size(1), dy.size(2), w.size(2)}, dy.options());
  Tensor re = dx[0], im = dx[1];
  at::bmm_out(im, dy[0] + dy[1], wr.transpose(1, 2));
  at::baddbmm_out(re, im, dy[1], (wr + wi).transpose(1, 2), 1, -1);
  im.baddbmm_(dy[0], (wr - wi).transpose(1, 2), 1, -1);
  return dx;
}

/// dW = X' conj(dY):  T = (Xr + Xi)' dYr,  re = T - Xi' (dYr - dYi),  im = T - Xr' (dYr + dYi).
Tensor gradient_of_taps(const Tensor& dy, const Tensor& x) {
  const Tensor xr = x[0].transpose(1, 2), xi = x[1].transpose(1, 2);
  Tensor dw = at::empty({2, x.size(1), x.size(3), dy.size(3)}, dy.options());
  Tensor re = dw[0], im = dw[1];
  at::bmm_out(im, (x[0] + x[1]).transpose(1, 2), dy[0]);
  at::baddbmm_out(re, im, xi, dy[0] - dy[1], 1, -1);
  im.baddbmm_(xr, dy[0] + dy[1], 1, -1);
  return dw;
}

struct SpectralConv : torch::autograd::Function<SpectralConv> {
  static Tensor forward(AutogradContext* context, const Tensor& x, const Tensor& weight,
                        const std::shared_ptr<const SpectralMatrices>& m) {
    const Tensor spectrum = transform(m->series, x), taps = transform(m->taps, weight);
    context->save_for_backward({spectrum, taps, m->series, m->taps, m->inverse});
    context->saved_data["series_needs_gradient"] = x.requires_grad();
    return transform_back(m->inverse, spectral_product(spectrum, taps));
  }
  static tensor_list backward(AutogradContext* context, tensor_list gradient) {
    const auto saved = context->get_saved_variables();
    const Tensor &x = saved[0], &w = saved[1], &series = saved[2], &taps = saved[3], &inverse = saved[4];
    const Tensor dy = transform(inverse.t(), gradient[0]);
    Tensor dx;
    if (context->saved_data["series_needs_gradient"].toBool())
      dx = transform_back(series.t(), gradient_of_series(dy, w));
    return {dx, transform_back(taps.t(), gradient_of_taps(dy, x)), Tensor()};
  }
};

}  // namespace

SpectralPlan::SpectralPlan(std::int64_t length, std::int64_t kernel) : length_(length), kernel_(kernel) {
  TORCH_CHECK(length >= 1 && kernel >= 1, "spectral_conv: length and kernel must be at least 1");
  const std::int64_t left = (kernel - 1) / 2, right = kernel - 1 - left;
  // Output t needs the samples t - left ... t + right. The period is so long that indices beyond the series
  // wrap only to zeros.
  period_ = length + std::max(left, right);
  auto m = std::make_shared<SpectralMatrices>();
  m->series = waves(period_, 0, length, false);
  m->taps = waves(period_, 0, kernel, false);
  m->inverse = waves(period_, -left, length, true).t().contiguous();
  matrices_ = std::move(m);
}
SpectralPlan::~SpectralPlan() = default;
SpectralPlan::SpectralPlan(SpectralPlan&&) noexcept = default;

Tensor spectral_conv(const Tensor& x, const Tensor& weight, const SpectralPlan& plan) {
  TORCH_CHECK(x.dim() == 3 && x.size(0) == plan.length(), "spectral_conv: x must be length x batch x in");
  TORCH_CHECK(weight.dim() == 3 && weight.size(0) == plan.kernel() && weight.size(1) == x.size(2),
              "spectral_conv: weight must be kernel x in x out");
  return SpectralConv::apply(x, weight, plan.matrices());
}

}  // namespace swingbank::train::networks
