#pragma once
// Which rows train, which decide when to stop, and which are judged. Rows that share a databank point (the
// same parameter values) or an event always go together, so that no test point was seen under another fault
// and no test event at another machine. Rows behind Labels::judged only train.
#include <cstdint>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

/// Row numbers of the dataset, ascending.
struct RowSplit {
  std::vector<std::uint64_t> train, validation, test;
  std::vector<std::int32_t> set_aside = {};     ///< bus numbers of generators that calibrate beliefs
  std::vector<std::uint64_t> calibration = {};  ///< their rows
};

/// 60 / 20 / 20 of the groups of rows. Throws InputError if a part would be empty.
RowSplit split_by_point(const Labels& labels, std::uint64_t seed);
/// Test: every row of one generator. The others' points: `validation_share` for validation, the rest for
/// training, but for so many generators as are `set_aside`. Throws InputError if the generator has no rows or
/// no others exist.
RowSplit leave_one_out(const Labels& labels, std::int32_t generator, double validation_share,
                       std::uint64_t seed, std::size_t set_aside = 0);
/// Bus numbers of the generators that have rows, ascending: one fold each.
std::vector<std::int32_t> generators(const Labels& labels);

}  // namespace swingbank::train::data
