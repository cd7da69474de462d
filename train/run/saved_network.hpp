#pragma once
// Trained network in a checksummed file beside the result's JSON. The file contains everything that an
// estimate needs: input and its normalisation, weights, and errors on the test rows.
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/core/frequency.hpp"
#include "train/data/features.hpp"
#include "train/run/run.hpp"

namespace swingbank::train::run {

/// Parameter that a network estimates.
struct EstimatedParameter {
  std::string name, unit, effect;  ///< "SEXS.K", "pu", "SEXS"
  double low = 0.0, high = 0.0;    ///< sampling box; if equal, the parameter is constant and not learnt
  double bias = 0.0;               ///< mean of estimate minus truth on test rows [unit]
  double rms_error = 0.0;          ///< root mean square of estimate minus truth [unit]
};

/// Inputs and outputs of a network.
struct NetworkInfo {
  std::string run;  ///< "V-cnn-quick-seed1-gen30"
  std::string network, kind, machine_model, dataset, dataset_hash, software;
  std::optional<std::int32_t> left_out;           ///< generator whose rows were not used in training
  std::vector<std::string> channels;              ///< names as in a dataset, in order
  double rate = 0.0;                              ///< sampling rate of the dataset's records [1/s]
  std::size_t samples = 0;                        ///< samples per channel, from t = 0
  std::optional<double> fault_start;              ///< fault time in the dataset's records [s]; none: unknown
  std::optional<sim::FrequencyFilter> frequency;  ///< filter of the channel "frequency"
  double input_rms_seen = 0.0;   ///< largest root mean square of a validation row's normalised input
  bool noise_as_input = false;   ///< whether the record's noise level is an input
  bool needs_reactance = false;  ///< whether X'd of the machine is an input
  std::vector<EstimatedParameter> parameters;
};

/// Central 90 % interval of a parameter and its median [unit of the parameter].
struct Interval {
  double low = 0.0, median = 0.0, high = 0.0;
};

struct Estimate {
  std::vector<double> values;                      ///< one per parameter [unit of the parameter]
  std::vector<std::optional<Interval>> intervals;  ///< none: constant parameter, or no posterior
  /// RMS of the input. About 1 if the record is like the training rows; the input of `swing` is not
  /// normalised.
  double input_rms = 0.0;
};

struct PreparedRun;
struct Trained;

/// Returns the path of the network beside a result: "V-cnn-quick-seed1-gen30.network".
std::filesystem::path network_file(const std::filesystem::path& result);
/// Evaluates the network on its test rows and writes it. Throws InputError if the file cannot be written.
void save_network(const std::filesystem::path& file, const PreparedRun& run, const Trained& trained);

class SavedNetwork {
 public:
  /// Loads a network. `path`: the file, or a folder with exactly one. Throws InputError if there is none,
  /// several, or a damaged one.
  static SavedNetwork load(const std::filesystem::path& path);
  SavedNetwork(SavedNetwork&&) noexcept;
  SavedNetwork& operator=(SavedNetwork&&) noexcept;
  ~SavedNetwork();
  [[nodiscard]] const NetworkInfo& info() const { return info_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// Returns the identity of the training (data, recipe, seed, software).
  [[nodiscard]] const nlohmann::json& identity() const { return *identity_; }
  /// Returns the training's result and gives up ownership; estimates are no longer possible.
  [[nodiscard]] std::unique_ptr<Trained> release();
  /// Returns the estimate from a record: info().channels x info().samples, at info().rate from t = 0, in the
  /// units of a dataset's record. `noise`: noise level of the record, used only if
  /// info().noise_as_input. `reactance`: X'd of the machine [pu on the machine base], used only if
  /// info().needs_reactance.
  [[nodiscard]] Estimate estimate(std::span<const float> record, double noise = 0.0,
                                  double reactance = 0.0) const;

 private:
  SavedNetwork();
  data::FeatureSizes read_header(const nlohmann::json& header);
  void add_head(const data::FeatureSizes& sizes);
  void add_intervals(const at::Tensor& x, double noise, Estimate& e) const;
  std::filesystem::path file_;
  NetworkInfo info_;
  data::InputSelection selection_;
  data::TargetScale scale_;
  std::unique_ptr<Trained> trained_;
  std::unique_ptr<nlohmann::json> identity_;
};

}  // namespace swingbank::train::run
