#pragma once
// A task's methods as tables: against noise, per generator, per parameter, and how they were made.
#include "validate/report/detail/summary.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::report {

/// What a cell says.
inline constexpr const char* kCellMeaning =
    "A cell: raw MSE ± its standard deviation over seeds; in brackets its ratio to predict-the-mean and, where "
    "there is one, to the floor (the Bayesian Cramér-Rao bound: the least mean squared error that these noisy "
    "records allow). ¹ one seed, ² two seeds.";

/// Three columns at most, one per task, the thesis's tables first: the thesis, the best network, what needs
/// no training, the floor.
std::vector<Table> overview_tables(const std::vector<Task>& tasks);
/// One row per method, one column per level of noise, the thesis's figures beside.
Table method_table(const Task& task);
/// At one level of noise: one row per generator left out, one column per method.
Table generator_table(const Task& task, double noise);
/// The same rows and columns: the MSE on rows that did not train over that on validation rows of generators
/// that did, mean over seeds. No rows where nothing was trained.
Table unseen_table(const Task& task, double noise);
/// At one level of noise: one row per parameter; raw and relative error of each method.
Table parameter_comparison(const Task& task, double noise);
/// Plants estimated from several of their records. No rows where no plant has three.
Table several_table(const Task& task);
/// Sizes, epochs, processor time.
Table effort_table(const Task& task);
/// "Below the thesis, without noise: closed form in 10 of 10 runs, ..."
std::string against_thesis(const Task& task);

}  // namespace swingbank::validate::report
