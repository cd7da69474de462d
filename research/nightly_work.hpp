#pragma once
// Cost of an experiment's runs from measured times, and scaling of a preset to a given cost.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/loop/experiment.hpp"

namespace swingbank::research {

/// Time that a network needs on one core, from research/rates.toml.
struct NetworkRate {
  double sample = 0.0;  ///< training time per sample [s]
  /// Length of the time series with which `sample` was measured; the time is proportional to the length. 0:
  /// the time does not depend on the length.
  double length = 0.0;
  double row = 0.0;        ///< time per evaluated row, for estimators without training [s]
  double noisy_row = 0.0;  ///< time per evaluated row with noise [s]
  double run = 0.0;        ///< fixed time per run: reading, fitting of scales, start [s]
};
/// Measured times of all parts of an experiment.
struct Rates {
  double event = 0.0;                    ///< time per event with one row [s]
  double row_of_all = 0.0;               ///< time per row of an event that records every generator [s]
  std::map<std::string, double> stable;  ///< share of stable events, by name of the dataset's config
  std::map<std::string, NetworkRate> networks;
};
/// Reads research/rates.toml. Throws InputError with every problem of the file.
Rates read_rates(const std::filesystem::path& file);

/// Target of a scaled preset.
struct Scale {
  std::string name;   ///< name of the scaled preset
  double work = 1.0;  ///< factor of the work; events and epochs each grow with its square root
};
/// Returns the preset scaled to another amount of work.
train::loop::Preset scaled(const train::loop::Preset& preset, const Scale& to);

/// Part of a plan: one line of its table.
struct Part {
  std::string what;      ///< "events", or a network
  std::size_t runs = 0;  ///< noise levels times folds, plus one for each share
  double rows = 0;       ///< rows per run (trained on or evaluated), or generated rows
  std::size_t epochs = 0;
  double core_seconds = 0;  ///< core time of all runs [s]
  bool simulated = false;   ///< whether this part is a simulation of events
};
/// Returns the parts of a preset with their cost. Throws InputError for a network without a rate.
std::vector<Part> work_of(const train::loop::Experiment& experiment, const train::loop::Preset& preset,
                          const Rates& rates);

/// Writes the experiment's file with the preset `from` only, scaled. Throws InputError if the file states its
/// sizes in a form that cannot be replaced.
void write_scaled(const train::loop::Experiment& experiment, const std::string& from, const Scale& to,
                  const std::filesystem::path& file);

}  // namespace swingbank::research
