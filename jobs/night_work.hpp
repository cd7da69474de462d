#pragma once
// What the runs of an experiment cost, from measured rates, and a preset made larger or smaller.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/loop/experiment.hpp"

namespace swingbank::jobs {

/// Work of one core, as jobs/rates.toml states it.
struct NetworkRate {
  double sample = 0.0;  ///< of one training sample [s]
  double length =
      0.0;           ///< of the series that was measured; work is proportional to it; 0: it does not matter
  double row = 0.0;  ///< of one row that is judged, for what is not trained [s]
  double noisy_row = 0.0;  ///< the same where there is noise [s]
  double run = 0.0;        ///< of a run whatever its size: reading, fitting of scales, start [s]
};
struct Rates {
  double event = 0.0;       ///< one event, one row [s]
  double row_of_all = 0.0;  ///< a row of an event that records every generator [s]
  std::map<std::string, double>
      stable;  ///< share of the events that give rows, by name of the dataset's config
  std::map<std::string, NetworkRate> networks;
};
/// Throws InputError with every problem of the file.
Rates read_rates(const std::filesystem::path& file);

struct Scale {
  std::string name;   ///< of the preset that comes out
  double work = 1.0;  ///< events and epochs grow with its root each
};
train::loop::Preset scaled(const train::loop::Preset& preset, const Scale& to);

/// One line of a plan.
struct Part {
  std::string what;      ///< "events", or a network
  std::size_t runs = 0;  ///< noise levels times folds
  double rows = 0;       ///< that a run trains on or judges, or that are generated
  std::size_t epochs = 0;
  double core_seconds = 0;  ///< of all runs
  bool simulated = false;   ///< and not trained or judged
};
/// Throws InputError for a network without a rate.
std::vector<Part> work_of(const train::loop::Experiment& experiment, const train::loop::Preset& preset,
                          const Rates& rates);

/// The experiment's file with its preset `from` alone, scaled. Throws InputError if the file writes its sizes
/// in a way that is not understood.
void write_scaled(const train::loop::Experiment& experiment, const std::string& from, const Scale& to,
                  const std::filesystem::path& file);

}  // namespace swingbank::jobs
