#pragma once
// Records as 16-bit whole numbers with an offset and a step for each row and channel: half the bytes.
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

/// A value is off by at most this share of its channel's range in the row (half a step), and by the rounding
/// of a float. The thesis's own reduction keeps 0.01 %.
constexpr double kQuantisationError = 1.0 / (2.0 * 65534.0);  // 0.00076 %

/// Fills `codes` and `code_scale`, and gives `records` the values that a reader will get.
void quantise(RowBlock& block);
/// `records` from `codes` and `code_scale`: offset + step * code, in double, rounded once. The product of 24
/// and 16 bits is exact, so every processor gets the same.
void decode(RowBlock& block);

}  // namespace swingbank::mpi::store
