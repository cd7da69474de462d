#pragma once
// A small network behind a trained one, which says what is to be believed of a row's parameters. It reads
// what the trained network knows of the row, and its estimates, and changes nothing in it.
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

/// A parameter that varies.
struct HeadParameter {
  std::size_t output = 0;           ///< of the trained network
  double low = 0.0, high = 0.0;     ///< its box, raw units
  double unit = 1.0, origin = 0.0;  ///< raw = output x unit + origin
};

class Head final : public networks::Network {
 public:
  /// `trained` must describe rows (Network::describe) of `inputs` numbers, and outlive the head. Weights come
  /// from torch's generator: seed it first.
  Head(networks::Network& trained, std::int64_t inputs, std::vector<HeadParameter> parameters);
  ~Head() override;
  /// Numbers of a row's belief: batch x belief_size().
  at::Tensor forward(const at::Tensor& x, bool training) override;
  std::vector<at::Tensor> parameters() override;
  /// Mean negative logarithm of the density of the truths, per parameter, in logits of places. `targets`:
  /// batch x all outputs of the trained network, scaled.
  [[nodiscard]] at::Tensor loss(const at::Tensor& numbers, const at::Tensor& targets) const;

  [[nodiscard]] const std::vector<HeadParameter>& of() const;
  /// Numbers of rows as forward() gives them.
  [[nodiscard]] Beliefs beliefs(std::span<const float> numbers) const;
  /// Places in the box of values in raw units, rows x all outputs: rows x of().
  [[nodiscard]] std::vector<double> places(std::span<const double> raw, std::size_t outputs) const;

 private:
  struct Layers;
  networks::Network& trained_;
  std::vector<HeadParameter> parameters_;
  std::unique_ptr<Layers> layers_;
};

}  // namespace swingbank::train::posterior
