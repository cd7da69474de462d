#pragma once
// Which part of a record a network reads: channels by name, a time window, and slicing (every n-th sample).
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "train/data/physics.hpp"

namespace swingbank::train::data {

/// How a channel is shown. The steady value before the fault is the record's first sample.
enum class InputForm {
  absolute,   ///< as recorded
  deviation,  ///< less the value before the fault
  relative,   ///< the deviation divided by the row's root mean square deviation of the first channel. A
              ///< machine's H and D follow from the ratio of its channels, so this shows a large machine that
              ///< moves little like any other
  both,       ///< the absolute channels, then the relative ones
  physics,    ///< what the machine's equations are written in, and steady values behind it (Physics)
};
/// Names as experiments write them, in order of the enumeration.
inline const std::vector<std::string> kInputForms = {"absolute", "deviation", "relative", "both", "physics"};

/// As an experiment's preset states it.
struct InputRecipe {
  std::vector<std::string> channels;
  double start_s = 0.0, end_s = 0.0;  ///< window [s]; the end is not included
  std::size_t slice = 1;              ///< keep every slice-th sample: 120/s and 4 make 30/s
  InputForm form = InputForm::absolute;
  bool seconds_as_steps = false;  ///< with principal components: a second's are one step of a series
  bool shows_level = false;       ///< of the form physics: the noise's level stands behind the steady values
  bool regressions =
      false;  ///< of the form physics: how its signals follow from one another (regressions.hpp)
};

/// The same, resolved against a dataset.
struct InputSelection {
  std::vector<std::size_t> channels;  ///< indices into the record's channels
  std::size_t first = 0, step = 1, samples = 0;
  InputForm form = InputForm::absolute;
  double rate = 0.0;               ///< after slicing [1/s]
  std::optional<Physics> physics;  ///< of that form; it then makes the series
  bool seconds_as_steps = false;   ///< features order components so
  bool shows_level = false;        ///< the last value is level_input() of the noise; its reader puts it there
  bool regressions = false;        ///< of that form: features hold them too

  [[nodiscard]] std::size_t outputs() const {
    return physics ? physics->channels() : channels.size() * (form == InputForm::both ? 2 : 1);
  }
  /// Values behind the series.
  [[nodiscard]] std::size_t levels() const { return physics ? physics->levels() : 0; }
  [[nodiscard]] std::size_t values() const { return outputs() * samples + levels() + (shows_level ? 1 : 0); }
  /// record: channels x record_samples of one row; out: outputs() x samples, then levels().
  void apply(const float* record, std::size_t record_samples, float* out) const;
};

/// Throws InputError with every channel that is not in the dataset, a window outside the record, or a slice
/// of 0.
InputSelection select_input(const InputRecipe& recipe, const mpi::store::DatasetHeader& dataset);

}  // namespace swingbank::train::data
