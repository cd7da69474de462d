#pragma once
// Learning curve of a training run: errors of each epoch as CSV, as TensorBoard events and as a terminal
// chart. It contains no clock times, so that equal runs write equal files.
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace swingbank::train::loop {

/// Errors of one epoch.
struct EpochErrors {
  std::size_t epoch = 0;       ///< number, from 1
  double training = 0.0;       ///< mean loss of the training rows during the epoch
  double validation = 0.0;     ///< loss of the validation rows after the epoch
  double learning_rate = 0.0;  ///< learning rate of the epoch's last step
};
using LearningCurve = std::vector<EpochErrors>;

/// Convert the curve to JSON, one object per epoch, and back.
nlohmann::json learning_curve_json(const LearningCurve& curve);
LearningCurve read_learning_curve(const nlohmann::json& curve);

/// Returns the curve as CSV with a header line.
std::string learning_curve_csv(const LearningCurve& curve);

/// Returns the curve as TensorBoard event records: scalars "loss/training", "loss/validation" and
/// "learning_rate" at step = epoch. A record's time is its epoch, as seconds. If `begin` is 0, the first
/// record contains the format's version; otherwise the records begin with the epoch of index `begin`. Format:
/// each record is a TFRecord with a protocol buffer `Event`
/// (https://github.com/tensorflow/tensorboard/blob/2.12.0/tensorboard/compat/proto/event.proto).
std::string tensorboard_events(const LearningCurve& curve, std::size_t begin = 0);

/// Returns a text chart of both losses over the epochs, `columns` characters wide. The loss axis is
/// logarithmic if all losses are positive.
std::string learning_curve_chart(const LearningCurve& curve, std::size_t columns = 72);

/// Files of a growing curve: <folder>/<run>.csv and <folder>/<run>/events.out.tfevents.*.
class LearningCurveFiles {
 public:
  /// Does not write yet.
  LearningCurveFiles(std::filesystem::path folder, std::string run);
  /// Appends the new epochs. At the first call, or if the curve is shorter than the files, writes the files
  /// anew. Throws InputError if a file cannot be written.
  void write(const LearningCurve& curve);

 private:
  std::filesystem::path csv_, events_;
  std::size_t written_ = 0;  ///< number of epochs in the files
};

}  // namespace swingbank::train::loop
