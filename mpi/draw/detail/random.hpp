#pragma once
// Counter-based random numbers: the n-th number is a pure function of (seed, stream, id, n). Therefore the
// numbers depend neither on the process nor on the order of execution. Generator: Philox4x32-10 (J. Salmon et
// al., "Parallel random numbers: as easy as 1, 2, 3", SC'11).
#include <Random123/philox.h>

#include <cstdint>

namespace swingbank::mpi::draw {

/// Purpose of a sequence of random numbers. Never renumber: the values determine the content of datasets.
enum class Stream : std::uint32_t { databank = 1, fault = 2, operating_point = 3 };

/// Sequence of random numbers.
class Random {
 public:
  Random(std::uint64_t seed, Stream stream, std::uint64_t id)
      : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
        counter_{{static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32), 0,
                  static_cast<std::uint32_t>(stream)}} {}

  /// Returns a uniform number in [0, 1) with 53 random bits.
  double uniform() {
    if (half_ == 0) {
      block_ = r123::Philox4x32()(counter_, key_);
      ++counter_[2];
    }
    const std::uint64_t low = block_[half_], high = block_[half_ + 1];
    half_ = 2 - half_;
    return static_cast<double>(((high << 32) | low) >> 11) * 0x1p-53;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Returns a uniform integer in 0 ... n-1; the bias is below \f$ n\,2^{-53} \f$.
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>(uniform() * static_cast<double>(n));
  }

 private:
  r123::Philox4x32::key_type key_;
  r123::Philox4x32::ctr_type counter_, block_{};
  unsigned half_ = 0;
};

}  // namespace swingbank::mpi::draw
