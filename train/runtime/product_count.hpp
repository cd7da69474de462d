#pragma once
// Count of the operations of a training step's matrix products, for comparison of the step's duration with
// the processor's rate.

namespace swingbank::train::runtime {

/// Counter of the operations of LibTorch's matrix products during its lifetime, including the backward pass.
/// At most one instance per process.
class ProductCount {
 public:
  ProductCount();
  ProductCount(const ProductCount&) = delete;
  ProductCount& operator=(const ProductCount&) = delete;
  ~ProductCount();
  /// Returns the multiplications and additions so far: 2 m n k for m x k times k x n.
  [[nodiscard]] double operations() const;

 private:
  unsigned long handle_ = 0;
};

}  // namespace swingbank::train::runtime
