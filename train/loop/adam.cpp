#include "train/loop/adam.hpp"

#include <ATen/ATen.h>
#include <ATen/Parallel.h>

#include <cmath>

namespace swingbank::train::loop {

Adam::Adam(std::vector<at::Tensor> parameters, double beta1, double beta2, double epsilon)
    : parameters_(std::move(parameters)), beta1_(beta1), beta2_(beta2), epsilon_(epsilon) {
  for (const auto& p : parameters_) {
    TORCH_CHECK(p.is_contiguous() && p.scalar_type() == at::kFloat,
                "Adam: parameters must be contiguous floats");
    first_.push_back(at::zeros(p.sizes(), at::kFloat));
    second_.push_back(at::zeros(p.sizes(), at::kFloat));
  }
}
Adam::~Adam() = default;
Adam::Adam(Adam&&) noexcept = default;

double Adam::gradient_length() const {
  double square = 0.0;
  for (const auto& p : parameters_)
    if (p.grad().defined()) square += p.grad().square().sum().item<double>();
  return std::sqrt(square);
}

void Adam::step(double learning_rate, double decay, double longest) {
  const double length = longest > 0.0 ? gradient_length() : 0.0;
  const auto shorten = static_cast<float>(length > longest ? longest / length : 1.0);
  ++steps_;
  const auto t = static_cast<double>(steps_);
  const auto rate = static_cast<float>(learning_rate / (1.0 - std::pow(beta1_, t)));
  const auto root = static_cast<float>(1.0 / std::sqrt(1.0 - std::pow(beta2_, t)));
  const auto b1 = static_cast<float>(beta1_), b2 = static_cast<float>(beta2_),
             eps = static_cast<float>(epsilon_);
  const auto a1 = static_cast<float>(1.0 - beta1_), a2 = static_cast<float>(1.0 - beta2_);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    at::Tensor& p = parameters_[i];
    if (!p.grad().defined()) continue;
    const at::Tensor gradient = p.grad().contiguous();
    float *w = p.data_ptr<float>(), *m = first_[i].data_ptr<float>(), *v = second_[i].data_ptr<float>();
    const float* g = gradient.data_ptr<float>();
    const auto keep = static_cast<float>(p.dim() > 1 ? 1.0 - learning_rate * decay : 1.0);
    at::parallel_for(0, p.numel(), 1 << 15, [=](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) {
        const float gk = shorten * g[k], mk = b1 * m[k] + a1 * gk, vk = b2 * v[k] + a2 * gk * gk;
        m[k] = mk;
        v[k] = vk;
        w[k] = keep * w[k] - rate * mk / (std::sqrt(vk) * root + eps);
      }
    });
    p.mutable_grad() = at::Tensor();
  }
}

std::vector<at::Tensor> Adam::moments() const {
  std::vector<at::Tensor> all = first_;
  all.insert(all.end(), second_.begin(), second_.end());
  return all;
}

}  // namespace swingbank::train::loop
