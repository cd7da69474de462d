#pragma once
// How much of a training step is matrix products: what a processor's rate of products says of the step's
// time.

namespace swingbank::train::runtime {

/// Counts the operations of LibTorch's matrix products while it lives, those of the backward pass included;
/// one at a time in a process.
class ProductCount {
 public:
  ProductCount();
  ProductCount(const ProductCount&) = delete;
  ProductCount& operator=(const ProductCount&) = delete;
  ~ProductCount();
  /// Multiplications and additions so far: 2 m n k for m x k times k x n.
  [[nodiscard]] double operations() const;

 private:
  unsigned long handle_ = 0;
};

}  // namespace swingbank::train::runtime
