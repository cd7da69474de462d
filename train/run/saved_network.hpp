#pragma once
// A trained network with everything an estimate needs: what it reads and how that is normalised, the weights,
// and how far it was off on its validation rows. One sealed file beside the result's JSON.
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

/// A parameter that a network estimates.
struct EstimatedParameter {
  std::string name, unit, effect;  ///< "SEXS.K", "pu", "SEXS"
  double low = 0.0, high = 0.0;    ///< the sampling box; equal: held, nothing was learnt
  double bias = 0.0;               ///< mean of estimate less truth on the validation rows [unit]
  double spread = 0.0;             ///< root mean square of the same [unit]
};

/// What a network reads and says.
struct NetworkInfo {
  std::string run;  ///< "V-cnn-quick-seed1-gen30"
  std::string network, kind, machine_model, dataset, dataset_hash, software;
  std::optional<std::int32_t> left_out;           ///< generator no row of which was trained on
  std::vector<std::string> channels;              ///< as a dataset names them, in order
  double rate = 0.0;                              ///< samples per second of the records it reads [1/s]
  std::size_t samples = 0;                        ///< of a channel, from t = 0
  std::optional<double> fault_start;              ///< when its records' faults begin [s]; none: unknown
  std::optional<sim::FrequencyFilter> frequency;  ///< of the channel "frequency"
  double input_rms_seen = 0.0;  ///< largest root mean square of a validation row's normalised input
  std::vector<EstimatedParameter> parameters;
};

struct Estimate {
  std::vector<double> values;  ///< per parameter [its unit]
  double input_rms = 0.0;      ///< of the normalised input: about 1 on rows like those of the training
};

struct NetworkParts {
  const data::ShardStream& stream;
  const RunRequest& request;
  const data::Features& features;
  const data::TargetScale& scale;
  const data::RowSplit& split;
  const nlohmann::json& identity;
};

/// "V-cnn-quick-seed1-gen30.network" beside the result.
std::filesystem::path network_file(const std::filesystem::path& result);
/// Judges the network on its validation rows and writes it. Throws InputError if the file cannot be written.
void save_network(const std::filesystem::path& file, const NetworkParts& parts, networks::Network& network);

class SavedNetwork {
 public:
  /// `path`: the file, or a folder that holds one. Throws InputError if there is none, several, or a damaged
  /// one.
  static SavedNetwork load(const std::filesystem::path& path);
  SavedNetwork(SavedNetwork&&) noexcept;
  SavedNetwork& operator=(SavedNetwork&&) noexcept;
  ~SavedNetwork();
  [[nodiscard]] const NetworkInfo& info() const { return info_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// record: info().channels x info().samples, at info().rate from t = 0 [as a dataset's record].
  [[nodiscard]] Estimate estimate(std::span<const float> record) const;

 private:
  SavedNetwork();
  data::FeatureSizes read_header(const nlohmann::json& header);
  std::filesystem::path file_;
  NetworkInfo info_;
  data::InputSelection selection_;
  data::Features features_;
  data::TargetScale scale_;
  std::unique_ptr<networks::Network> network_;
};

}  // namespace swingbank::train::run
