#pragma once
// Split of the rows into training, validation and test. Groups of rows that share a databank sample (the same
// parameter values) or an event are not divided between training and validation. split_by_point does not
// divide them between training and test either: training then contains neither a test sample with another
// fault nor a test event at another machine. Others choose the test rows by generator or dataset;
// split_by_row divides groups. Rows whose number is at least Labels::judged are never test rows.
#include <cstdint>
#include <optional>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

/// Row numbers of the dataset, ascending.
struct RowSplit {
  std::vector<std::uint64_t> train, validation, test;
  std::vector<std::int32_t> set_aside = {};     ///< bus numbers of the generators used only for recalibration
  std::vector<std::uint64_t> calibration = {};  ///< rows of these generators
};

/// Splits the groups of the dataset's rows: 60 % training, 20 % validation, 20 % test. Rows from number
/// Labels::judged on, those of the training dataset, are training rows. Throws InputError if a part is empty.
RowSplit split_by_point(const Labels& labels, std::uint64_t seed);
/// As split_by_point, but splits rows instead of groups, as the thesis did it seems: a parameter set may be
/// in all three parts, so the error on the test rows is too low for unknown machines.
RowSplit split_by_row(const Labels& labels, std::uint64_t seed);
/// Plan of a leave-one-out split.
struct LeaveOneOut {
  std::int32_t generator = 0;
  double validation_share = 0.0;
  std::uint64_t seed = 0;
  /// Generator whose rows are the test rows instead of those of `generator`, which are then not used at all.
  /// Thus recipes can be chosen without the test rows of the result tables.
  std::optional<std::int32_t> judged = {};
  std::size_t set_aside = 0;  ///< number of generators for recalibration
};
/// Returns the split whose test rows are all rows of one generator. The rows of the generators set aside are
/// for recalibration. Of the remaining generators' databank samples, `validation_share` is for validation and
/// the rest for training. Rows from number Labels::judged on are training or recalibration rows, except those
/// of the generators left out. Throws InputError if the generator has no rows, or if training or validation
/// is empty.
RowSplit leave_one_out(const Labels& labels, const LeaveOneOut& plan);
/// Returns the split whose test rows are the whole dataset. Of the databank samples of the rows from
/// number Labels::judged on, `validation_share` is for validation and the rest for training. Throws
/// InputError if one of the three parts is empty.
RowSplit split_across(const Labels& labels, double validation_share, std::uint64_t seed);
/// Keeps a fraction of the training rows: the first rows of the dataset and of the training dataset, as if
/// both datasets were smaller. Throws InputError if no row remains.
void keep_share(RowSplit& split, const Labels& labels, double share);
/// Returns the bus numbers of the generators with rows, ascending. Each generator is one fold.
std::vector<std::int32_t> generators(const Labels& labels);

}  // namespace swingbank::train::data
