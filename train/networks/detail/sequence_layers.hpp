#pragma once
// Common parts of the networks whose hidden layers are series: batch x steps x width.
#include <vector>

#include "train/networks/detail/layers.hpp"
#include "train/networks/detail/norm.hpp"

namespace swingbank::train::networks {

inline void append(std::vector<at::Tensor>& all, const Dense& layer) {
  all.insert(all.end(), {layer.weight, layer.bias});
}
inline void append(std::vector<at::Tensor>& all, const Norm& norm) {
  all.insert(all.end(), {norm.weight, norm.bias});
}

/// Applies a dense layer to every step.
inline at::Tensor each_step(const Dense& layer, const at::Tensor& x) {
  return at::matmul(x, layer.weight) + layer.bias;
}

/// Output of a network of series: norm, mean over the steps, dense layer. The outputs initially equal the
/// means of the targets.
class SequenceOutput {
 public:
  SequenceOutput(std::int64_t width, const std::vector<float>& start)
      : norm_(width), output_(output_layer(width, start)) {
    at::NoGradGuard no_gradients;
    output_.weight.zero_();
  }
  [[nodiscard]] at::Tensor operator()(const at::Tensor& x) const { return output_(norm_(x).mean(1)); }
  void append_to(std::vector<at::Tensor>& all) const {
    append(all, norm_);
    append(all, output_);
  }

 private:
  Norm norm_;
  Dense output_;
};

}  // namespace swingbank::train::networks
