#pragma once
// Adam (Kingma and Ba 2015, algorithm 1) in one pass over memory per step, with optional decoupled weight
// decay (Loshchilov and Hutter 2019) and gradient clipping.
#include <cstdint>
#include <vector>

namespace at {
class Tensor;
}

namespace swingbank::train::loop {

class Adam {
 public:
  /// `parameters`: contiguous single-precision leaves. The moments start at zero.
  explicit Adam(std::vector<at::Tensor> parameters, double beta1 = 0.9, double beta2 = 0.999,
                double epsilon = 1e-8);
  ~Adam();
  Adam(Adam&&) noexcept;

  /// Performs one step with the parameters' gradients and clears them. Parameters without a gradient are
  /// unchanged. `decay`: matrices are multiplied by 1 - learning_rate x decay. `longest`: largest norm of the
  /// gradient over all parameters; a longer gradient is scaled down; 0: no clipping.
  void step(double learning_rate, double decay = 0.0, double longest = 0.0);
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  void set_steps(std::int64_t steps) { steps_ = steps; }
  /// Returns the first moments of all parameters, then the second moments, for a checkpoint.
  [[nodiscard]] std::vector<at::Tensor> moments() const;

 private:
  [[nodiscard]] double gradient_length() const;

  std::vector<at::Tensor> parameters_, first_, second_;
  double beta1_, beta2_, epsilon_;
  std::int64_t steps_ = 0;
};

}  // namespace swingbank::train::loop
