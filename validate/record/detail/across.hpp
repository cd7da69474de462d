#pragma once
// What values that lie on both sides of a gap tell of those in it.
#include <cstddef>
#include <vector>

namespace swingbank::validate::record {

/// The polynomial through the values beside a gap that foretells best, and whether one that jumps in the gap
/// foretells better: by Akaike's criterion for few values. Too low a degree misses a swing's bend, too high a
/// one follows noise.
struct Across {
  std::vector<double> inside;  ///< the values in the gap
  double jump = 0;             ///< by how much they jump there; 0: smoothly from side to side
};
/// `at`, `value`: beside the gap; `inside`: where in the same measure, of about 1 on each side, values are
/// asked for. At least kMinAcross are needed.
Across across(const std::vector<double>& at, const std::vector<double>& value,
              const std::vector<double>& inside);
constexpr std::size_t kMinAcross = 6;

}  // namespace swingbank::validate::record
