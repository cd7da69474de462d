#pragma once
// Tables of a task's methods: per noise level, per generator, per parameter, and training effort.
#include "validate/report/detail/summary.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::report {

/// Explanation of a cell for captions.
inline constexpr const char* kCellMeaning =
    "A cell: raw MSE ± its standard deviation over seeds; in brackets its ratio to predict-the-mean and, where "
    "there is one, to the floor (the Bayesian Cramér-Rao bound, averaged over the prior; the MSE over a finite set "
    "of test events scatters around it, so ratios below 1 occur). ¹ one seed, ² two seeds.";

/// Cell of a method: mean error with its ratios, as kCellMeaning explains; `otherwise` without runs.
Cell figure_cell(const Task& task, const Of& of, const char* otherwise);
/// One row per method, one column per noise level, and the figures of the thesis's own methods.
Table method_table(const Task& task);
/// One row per excluded generator, one column per method, at one noise level.
Table generator_table(const Task& task, double noise);
/// Table of generalisation ratios with one row per excluded generator and one column per trained method: MSE
/// on the excluded generator / MSE on validation rows of the training generators, mean over seeds. No rows if
/// nothing was trained.
Table unseen_table(const Task& task, double noise);
/// One row per parameter with raw and relative error of each method, at one noise level.
Table parameter_comparison(const Task& task, double noise);
/// Errors of estimates from several records of the same plant. No rows if no plant has three records.
Table several_table(const Task& task);
/// Median and largest MSE of single test rows, and share of failed rows. No rows without such results.
Table scatter_table(const Task& task);
/// Table of training rows, epochs and processor time.
Table effort_table(const Task& task);
/// Sentence "MSE lower than in the thesis (noise-free): closed form at 10 of 10 generators. Higher: CNN."
std::string against_thesis(const Task& task);

}  // namespace swingbank::validate::report
