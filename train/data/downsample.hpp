#pragma once
// Selection of a network's input from a record: channels by name, a time window, and decimation.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "train/data/physics.hpp"
#include "train/data/swing.hpp"

namespace swingbank::train::data {

/// Representation of a channel. The steady value before the fault is the record's first sample.
enum class InputForm {
  absolute,   ///< as recorded
  deviation,  ///< minus the value before the fault
  /// Deviation divided by the row's root mean square deviation of the first channel. A large machine with
  /// small deviations then has inputs like any other machine. H and D remain identifiable, because they
  /// follow from the ratio of the channels.
  relative,
  both,     ///< absolute channels, then relative ones
  physics,  ///< signals of the machine's equations, then steady values (Physics)
  swing,    ///< integrals of the swing equation, then the noise level (SwingIntegrals)
};
/// Names used in experiment files, in order of the enumeration.
inline const std::vector<std::string> kInputForms = {"absolute", "deviation", "relative",
                                                     "both",     "physics",   "swing"};

/// Input of a network as given in an experiment's preset.
struct InputRecipe {
  std::vector<std::string> channels;
  double start_s = 0.0, end_s = 0.0;  ///< window [s], end excluded
  std::size_t slice = 1;              ///< keep every slice-th sample: 120/s and 4 give 30/s
  InputForm form = InputForm::absolute;
  bool seconds_as_steps = false;  ///< with PCA: the components of each second form one time step
  bool shows_level = false;       ///< form physics: append the noise level after the steady values
  bool regressions = false;       ///< form physics only: append regressions between the signals
};

/// An InputRecipe resolved against a dataset.
struct InputSelection {
  std::vector<std::size_t> channels;  ///< indices into the record's channels
  std::size_t first = 0, step = 1, samples = 0;
  InputForm form = InputForm::absolute;
  double rate = 0.0;                    ///< sampling rate after decimation [1/s]
  std::optional<Physics> physics;       ///< form physics only: conversion of a record to series
  std::optional<SwingIntegrals> swing;  ///< form swing only: conversion of a record to integrals
  bool seconds_as_steps = false;        ///< as in InputRecipe
  bool shows_level = false;  ///< whether the last value is the noise level (form physics: level_input())
  bool regressions = false;  ///< form physics only: Features append the regression coefficients

  [[nodiscard]] std::size_t outputs() const {
    if (swing) return SwingIntegrals::terms;
    return physics ? physics->channels() : channels.size() * (form == InputForm::both ? 2 : 1);
  }
  /// Returns the number of steady values after the series.
  [[nodiscard]] std::size_t levels() const { return physics ? physics->levels() : 0; }
  [[nodiscard]] std::size_t values() const { return outputs() * samples + levels() + (shows_level ? 1 : 0); }
  /// Computes the input of one row. record: channels x record_samples; `level`: noise level; `reactance`: X'd
  /// [pu of the machine], form swing only; out: values().
  void apply(const float* record, std::size_t record_samples, double level, double reactance,
             float* out) const;
};

/// Resolves a recipe. Throws InputError with every channel that the dataset lacks, a window outside the
/// record, or a slice of 0.
InputSelection select_input(const InputRecipe& recipe, const mpi::store::DatasetHeader& dataset);

}  // namespace swingbank::train::data
