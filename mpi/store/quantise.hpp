#pragma once
// Quantisation of records to 16-bit integers with an offset and a step for each row and channel, which halves
// their size.
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

/// Largest quantisation error (half a step), relative to the range of a channel in its row. Rounding to
/// float32 adds to it.
constexpr double kQuantisationError = 1.0 / (2.0 * 65534.0);  // 0.00076 %

/// Computes `codes` and `code_scale`, and replaces `records` by the decoded values.
void quantise(RowBlock& block);
/// Computes `records` = offset + step * code in double precision, rounded once. The product of a 24-bit and a
/// 16-bit significand is exact, so the result is the same on every processor.
void decode(RowBlock& block);

}  // namespace swingbank::mpi::store
