#pragma once
// Posterior head: a small network on top of a trained one, which outputs a row's posterior. Its inputs are
// the row and the features and estimates of the trained network, which it does not change.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "train/networks/network.hpp"
#include "train/posterior/mixture.hpp"

namespace at {
class Tensor;
}

namespace swingbank::train::posterior {

/// Varying parameter.
struct HeadParameter {
  std::size_t output = 0;           ///< index in the trained network's outputs
  double low = 0.0, high = 0.0;     ///< its sampling box [raw units]
  double unit = 1.0, origin = 0.0;  ///< raw = output x unit + origin
};

class Head final : public networks::Network {
 public:
  /// `trained` must outlive the head and provide features (Network::describe) for rows of `inputs` numbers.
  /// Weights come from torch's generator, which must be seeded before.
  Head(networks::Network& trained, std::int64_t inputs, std::vector<HeadParameter> parameters);
  ~Head() override;
  /// Returns the numbers that define the rows' posteriors: batch x numbers. Each varying parameter has
  /// 3 kComponents + kFactors numbers.
  at::Tensor forward(const at::Tensor& x, const networks::StepRows* training) override;
  std::vector<at::Tensor> parameters() override;
  /// Returns the mean negative log density of the true values per parameter, over the logits of their
  /// positions. `targets`: batch x all outputs of the trained network, scaled.
  [[nodiscard]] at::Tensor loss(const at::Tensor& numbers, const at::Tensor& targets) const;

  [[nodiscard]] const std::vector<HeadParameter>& of() const;
  /// Converts the output of forward() to posteriors.
  [[nodiscard]] Posteriors posteriors(std::span<const float> numbers) const;
  /// Returns the positions of raw values in the box, rows x of().size(). `raw`: rows x `outputs`.
  [[nodiscard]] std::vector<double> places(std::span<const double> raw, std::size_t outputs) const;

 private:
  struct Layers;
  networks::Network& trained_;
  std::vector<HeadParameter> parameters_;
  std::unique_ptr<Layers> layers_;
};

}  // namespace swingbank::train::posterior
