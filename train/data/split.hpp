#pragma once
// Which rows train, which decide when to stop, and which are judged. Rows that share a databank point (the
// same parameter values) or an event always go together, so that no test point was seen under another fault
// and no test event at another machine. Rows behind Labels::judged only train.
#include <cstdint>
#include <optional>
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
/// Who is left out, and who judges.
struct LeaveOneOut {
  std::int32_t generator = 0;
  double validation_share = 0.0;
  std::uint64_t seed = 0;
  /// Its rows are the test instead, and those of `generator` take no part at all: so recipes are chosen
  /// without a look at the generator that the table leaves out.
  std::optional<std::int32_t> judged = {};
  std::size_t set_aside = 0;  ///< generators whose rows calibrate
};
/// Test: every row of one generator. The others' points: `validation_share` for validation, the rest for
/// training, but for the generators set aside. Throws InputError if the generator has no rows or no others
/// exist.
RowSplit leave_one_out(const Labels& labels, const LeaveOneOut& plan);
/// Test: the dataset whole. Of the rows behind it, a share of the points decides when to stop and the others
/// train. Throws InputError if one of the three has no rows.
RowSplit split_across(const Labels& labels, double validation_share, std::uint64_t seed);
/// Of the rows that train the first of the judged dataset and of the one that only trains, as if both had
/// been made smaller. Throws InputError if nothing would be left.
void keep_share(RowSplit& split, const Labels& labels, double share);
/// Bus numbers of the generators that have rows, ascending: one fold each.
std::vector<std::int32_t> generators(const Labels& labels);

}  // namespace swingbank::train::data
