#pragma once
// Adam (Kingma and Ba 2015, algorithm 1) in one pass over memory per step, with decoupled weight decay
// (Loshchilov and Hutter 2019) and a longest gradient where asked for.
#include <cstdint>
#include <vector>

namespace at {
class Tensor;
}

namespace swingbank::train::loop {

class Adam {
 public:
  /// Contiguous single-precision leaves; the moments start at zero.
  explicit Adam(std::vector<at::Tensor> parameters, double beta1 = 0.9, double beta2 = 0.999,
                double epsilon = 1e-8);
  ~Adam();
  Adam(Adam&&) noexcept;

  /// One step with the gradients the parameters hold; parameters without a gradient stay. Clears the
  /// gradients. `decay`: matrices shrink by learning_rate x decay. `longest`: the gradient of all parameters
  /// together is shortened to it; 0: it stays.
  void step(double learning_rate, double decay = 0.0, double longest = 0.0);
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  void set_steps(std::int64_t steps) { steps_ = steps; }
  /// First moments of all parameters, then second moments: what a checkpoint holds.
  [[nodiscard]] std::vector<at::Tensor> moments() const;

 private:
  [[nodiscard]] double gradient_length() const;

  std::vector<at::Tensor> parameters_, first_, second_;
  double beta1_, beta2_, epsilon_;
  std::int64_t steps_ = 0;
};

}  // namespace swingbank::train::loop
