#pragma once
// Split of the rows into training, validation and test. Groups of rows that share a databank sample (the same
// parameter values) or an event are not divided between training and validation. split_by_point does not
// divide them between training and test either: training then contains neither a test sample with another
// fault nor a test event at another machine. Others choose the test rows by generator or dataset;
// split_by_row divides groups. Rows whose number is at least Labels::judged, those of the training dataset,
// are never test rows. They are not training rows either if a validation or test row has the same parameters:
// two datasets with the same seed and box contain the same databank samples.
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

/// Row numbers of the dataset, ascending.
struct RowSplit {
  std::vector<std::uint64_t> train, validation, test;
  std::vector<std::int32_t> set_aside = {};     ///< bus numbers of the generators used only for recalibration
  std::vector<std::uint64_t> calibration = {};  ///< rows of these generators
};

using ParameterSets = std::set<std::vector<double>>;
/// Returns the parameter sets of the validation and test rows [raw units].
ParameterSets held_out(const Labels& labels, const RowSplit& split);
/// Removes the rows whose parameter set is one of `sets`.
void leave_out(std::vector<std::uint64_t>& rows, const Labels& labels, const ParameterSets& sets);

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
/// Returns `most` of the rows, drawn at random, in their order; all rows if there are no more. Evenly spaced
/// rows could all belong to a few generators, because the rows of an event's generators follow one another.
std::vector<std::uint64_t> some_of(std::span<const std::uint64_t> rows, std::size_t most);
/// Keeps a fraction of the training rows: the first rows of the dataset and of the training dataset, as if
/// both datasets were smaller. Throws InputError if no row remains.
void keep_share(RowSplit& split, const Labels& labels, double share);
/// Returns the bus numbers of the generators with rows, ascending. Each generator is one fold.
std::vector<std::int32_t> generators(const Labels& labels);

}  // namespace swingbank::train::data
