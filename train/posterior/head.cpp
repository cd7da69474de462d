#include "train/posterior/head.hpp"

#include <ATen/ATen.h>

#include <cmath>

#include "base/constants.hpp"
#include "base/problem.hpp"

namespace swingbank::train::posterior {
namespace {

using at::Tensor;
constexpr std::int64_t kUnits = 256;
constexpr auto K = static_cast<std::int64_t>(kComponents), F = static_cast<std::int64_t>(kFactors);
constexpr double kNarrowest = -9.0, kWidest = 2.0;  // limits of the logarithm of a deviation
constexpr double kCertain = 1e-5;                   // smallest tail probability of a normal score
constexpr double kBoxEdge = 0.005;  // smallest distance of an estimate from the box's ends [box widths]

Tensor constant(const std::vector<HeadParameter>& all, double HeadParameter::*what) {
  std::vector<float> values;
  for (const auto& p : all) values.push_back(static_cast<float>(p.*what));
  return at::tensor(values, at::kFloat);
}

Tensor drawn(std::int64_t in, std::int64_t out) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(in));
  return at::empty({in, out}, at::kFloat).uniform_(-bound, bound).requires_grad_(true);
}

/// Returns the numbers that define the initial posterior: components around the estimate, each about as wide
/// as the box, without correlation.
std::vector<float> first_posterior(std::size_t parameters) {
  std::vector<float> all;
  for (std::size_t p = 0; p < parameters; ++p) {
    for (std::size_t k = 0; k < kComponents; ++k) all.push_back(0.0f);
    for (std::size_t k = 0; k < kComponents; ++k)
      all.push_back(0.5f * (static_cast<float>(k) - 0.5f * static_cast<float>(kComponents - 1)));
    for (std::size_t k = 0; k < kComponents; ++k) all.push_back(0.0f);
    for (std::size_t k = 0; k < kFactors; ++k) all.push_back(0.0f);
  }
  return all;
}

struct Parts {
  Tensor log_weight, mean, log_deviation, factor;  // batch x parameters x K or F
};
Parts parts_of(const Tensor& numbers, std::int64_t parameters) {
  const Tensor all = numbers.reshape({numbers.size(0), parameters, 3 * K + F});
  return {at::log_softmax(all.narrow(2, 0, K), 2), all.narrow(2, K, K),
          all.narrow(2, 2 * K, K).clamp(kNarrowest, kWidest), all.narrow(2, 3 * K, F)};
}

/// Returns the logarithm of the copula's density, one value per row of the batch.
Tensor copula(const Tensor& score, const Tensor& factor) {
  const std::int64_t p = factor.size(1);
  const Tensor root = (factor.square().sum(2, true) + 1.0).rsqrt();
  const Tensor scaled = factor * root;
  const Tensor correlation =
      at::matmul(scaled, scaled.transpose(1, 2)) + at::diag_embed(root.squeeze(2).square());
  const Tensor lower = at::linalg_cholesky(correlation);
  const Tensor white = at::linalg_solve_triangular(lower, score.reshape({-1, p, 1}), false).squeeze(2);
  return -at::diagonal(lower, 0, 1, 2).log().sum(1) - 0.5 * (white.square().sum(1) - score.square().sum(1));
}

}  // namespace

struct Head::Layers {
  Tensor first, first_bias, second, second_bias, last, last_bias;
  Tensor low, width, unit, origin;
  std::vector<std::int64_t> outputs;
};

Head::Head(networks::Network& trained, std::int64_t inputs, std::vector<HeadParameter> parameters)
    : trained_(trained), parameters_(std::move(parameters)), layers_(std::make_unique<Layers>()) {
  at::NoGradGuard no_gradients;
  const Tensor known = trained.describe(at::zeros({1, 1, inputs}, at::kFloat));
  if (!known.defined())
    throw InputError({"no posterior", "posterior_epochs",
                      "this network outputs estimates without a distribution",
                      "choose mlp, or leave posterior_epochs out"});
  Layers& l = *layers_;
  const std::int64_t in = known.size(1) + inputs;
  const auto out = static_cast<std::int64_t>(parameters_.size()) * (3 * K + F);
  const auto zeros = [](at::IntArrayRef shape) { return at::zeros(shape, at::kFloat).requires_grad_(true); };
  l.first = drawn(in, kUnits);
  l.first_bias = zeros({kUnits});
  l.second = drawn(kUnits, kUnits);
  l.second_bias = zeros({kUnits});
  l.last = zeros({kUnits, out});
  l.last_bias = at::tensor(first_posterior(parameters_.size()), at::kFloat).requires_grad_(true);
  l.low = constant(parameters_, &HeadParameter::low);
  l.width = constant(parameters_, &HeadParameter::high) - l.low;
  l.unit = constant(parameters_, &HeadParameter::unit);
  l.origin = constant(parameters_, &HeadParameter::origin);
  for (const auto& p : parameters_) l.outputs.push_back(static_cast<std::int64_t>(p.output));
}
Head::~Head() = default;

const std::vector<HeadParameter>& Head::of() const { return parameters_; }

std::vector<Tensor> Head::parameters() {
  Layers& l = *layers_;
  return {l.first, l.first_bias, l.second, l.second_bias, l.last, l.last_bias};
}

Tensor Head::forward(const Tensor& x, const networks::StepRows*) {
  const Layers& l = *layers_;
  Tensor read, estimate;
  {
    at::NoGradGuard the_trained_network_stays;
    const Tensor known = trained_.describe(x);
    read = at::cat({known, x.reshape({x.size(0), -1})}, 1);
    const std::int64_t outputs = known.size(1);
    // The network's outputs are the last of its features.
    const auto all = static_cast<std::int64_t>(trained_.parameters().back().numel());
    const Tensor output =
        known.narrow(1, outputs - all, all).index_select(1, at::tensor(l.outputs, at::kLong));
    const Tensor place = ((output * l.unit + l.origin - l.low) / l.width).clamp(kBoxEdge, 1.0 - kBoxEdge);
    estimate = at::logit(place);
  }
  const Tensor h = at::gelu(at::addmm(l.first_bias, read, l.first));
  const Tensor deep = h + at::gelu(at::addmm(l.second_bias, h, l.second));
  const Tensor numbers = at::addmm(l.last_bias, deep, l.last).reshape({x.size(0), -1, 3 * K + F});
  return at::cat({numbers.narrow(2, 0, K), numbers.narrow(2, K, K) + estimate.unsqueeze(2),
                  numbers.narrow(2, 2 * K, K + F)},
                 2)
      .reshape({x.size(0), -1});
}

Tensor Head::loss(const Tensor& numbers, const Tensor& targets) const {
  const Layers& l = *layers_;
  const auto p = static_cast<std::int64_t>(parameters_.size());
  const Parts parts = parts_of(numbers, p);
  const Tensor raw = targets.index_select(1, at::tensor(l.outputs, at::kLong)) * l.unit + l.origin;
  const Tensor u = at::logit(((raw - l.low) / l.width).clamp(1e-5, 1.0 - 1e-5)).unsqueeze(2);
  const Tensor z = (u - parts.mean) * (-parts.log_deviation).exp();
  const Tensor each = parts.log_weight - parts.log_deviation - 0.5 * z.square();
  const Tensor marginal =
      at::logsumexp(each, 2).sum(1) - 0.5 * std::log(constants::turn) * static_cast<double>(p);
  // The copula is trained on detached scores of the marginal distributions, so that its loss does not
  // influence these distributions.
  const Tensor below =
      (parts.log_weight.detach().exp() * 0.5 * at::erfc(z.detach() * -std::sqrt(0.5))).sum(2);
  const Tensor score = std::sqrt(2.0) * at::erfinv(2.0 * below.clamp(kCertain, 1.0 - kCertain) - 1.0);
  return -(marginal + copula(score, parts.factor)).mean() / static_cast<double>(p);
}

Posteriors Head::posteriors(std::span<const float> numbers) const {
  const std::size_t per_parameter = 3 * kComponents + kFactors;
  Posteriors b;
  b.parameters = parameters_.size();
  b.rows = numbers.size() / (b.parameters * per_parameter);
  for (std::size_t i = 0; i < b.rows * b.parameters; ++i) {
    const float* n = numbers.data() + i * per_parameter;
    Mixture m;
    double most = n[0], sum = 0.0;
    for (std::size_t k = 1; k < kComponents; ++k) most = std::max(most, static_cast<double>(n[k]));
    for (std::size_t k = 0; k < kComponents; ++k) sum += m.weight[k] = std::exp(n[k] - most);
    for (std::size_t k = 0; k < kComponents; ++k) {
      m.weight[k] /= sum;
      m.mean[k] = n[kComponents + k];
      m.deviation[k] = std::exp(std::clamp(static_cast<double>(n[2 * kComponents + k]), kNarrowest, kWidest));
    }
    b.marginal.push_back(m);
    b.factor.insert(b.factor.end(), n + 3 * kComponents, n + per_parameter);
  }
  return b;
}

std::vector<double> Head::places(std::span<const double> raw, std::size_t outputs) const {
  std::vector<double> all;
  for (std::size_t row = 0; row < raw.size() / outputs; ++row)
    for (const auto& p : parameters_)
      all.push_back((raw[row * outputs + p.output] - p.low) / (p.high - p.low));
  return all;
}

}  // namespace swingbank::train::posterior
