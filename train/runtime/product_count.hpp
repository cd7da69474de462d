#pragma once
// Count of matrix-product operations in a training step, to relate a processor's product rate to the step's
// time.

namespace swingbank::train::runtime {

/// Counts the operations of LibTorch's matrix products during its lifetime, including those of the backward
/// pass. At most one instance per process.
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
