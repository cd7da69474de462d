#pragma once
// Influence of an added model component on a trained network. One network is trained on a dataset of the
// plant without the effect, another one on a dataset with the effect. Both networks estimate parameters from
// the same records. This module needs no LibTorch: it writes the configs and compares the estimates.
// jobs/retrain_run.hpp generates the datasets and trains the networks.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/add/add.hpp"
#include "validate/calibrate/network.hpp"
#include "validate/calibrate/side_by_side.hpp"

namespace swingbank::validate::retrain {

struct RetrainOptions {
  std::filesystem::path dataset;  ///< dataset config of this plant without the effect; empty: generated
  std::uint64_t draws = 4000;     ///< events simulated for each network
  std::size_t epochs = 20;
  std::string network = "cnn";
  double range = 2.0;  ///< parameters are drawn from value / range to value * range: those of the effect, and
                       ///< those of the machine if no dataset is given
  std::uint64_t seed = 1;  ///< seed of draws and training
};

/// Files of one network, in their own folder.
struct RetrainSide {
  std::string name;  ///< "without", "with"
  std::filesystem::path folder, dataset, experiment, data, results;
};

/// Writes a dataset config with .raw and .dyr: the plant at the operating point of `event`, connected through
/// three lines to a large machine. Each free parameter of the machine in its usual range varies from value /
/// range to value * range, but not beyond its usual range. Returns the config's path. Throws InputError if
/// the machine has no .dyr form, or if the conventions are neither psse nor andes.
std::filesystem::path write_plant_grid(const std::filesystem::path& folder, const plant::PlantModel& model,
                                       const event::FitEvent& event, double range);

/// Writes dataset and experiment configs of both networks below `folder`. The second dataset has the effect
/// of `added` at its fitted values, and varies the parameters that the records determine. The networks read
/// P, Q, V and frequency for up to 8 s after the event. They also read speed and Ifd, if every record has
/// them and `added` compared them. Throws InputError for a base config without a varied plant of this machine
/// model, an addition that a dataset cannot express, or records that end too early.
std::array<RetrainSide, 2> write_retrain_configs(const std::filesystem::path& folder,
                                                 const plant::PlantModel& before, const add::Addition& added,
                                                 const std::vector<record::Record>& records,
                                                 const RetrainOptions& options);

/// Parameter that both networks estimate, or only the network with the effect. Array index 0: network without
/// the effect; 1: network with it.
struct RetrainedParameter {
  std::string name, unit;       ///< "GENROU.H"
  double reference = 0;         ///< true value if known, otherwise fitted value
  double deviation = 0;         ///< standard deviation of the drawn values: width of the range / sqrt(12)
  bool own = false;             ///< parameter of the effect, estimated by the second network only
  double estimate[2] = {0, 0};  ///< mean over the held-out events
  double error[2] = {0, 0};     ///< RMS error over the held-out events [deviation]
  double middle = 0;            ///< error of the middle of the range, as a baseline [deviation]
};
struct RetrainedEvent {
  std::string record;
  bool seen = true;                    ///< false: held out
  double parameter_error[2] = {0, 0};  ///< RMS over the shared parameters [deviation]
  /// Reduced chi-square, and RMS error of P and Q [MW, Mvar], of the model with a network's estimates,
  /// averaged over the fitted events. Switching times and initial state of the event are fitted. Infinite if
  /// that plant cannot be simulated.
  double reduced_chi2[2] = {0, 0}, rms[2] = {0, 0};
};
struct Retrained {
  bool truth = false;  ///< whether the reference values are true values
  std::vector<RetrainedParameter> parameters;
  std::vector<RetrainedEvent> events;
  double error[2] = {0, 0}, middle = 0;  ///< RMS over shared parameters and held-out events [deviation]
  double rms[2] = {0, 0};                ///< RMS error of P and Q over the held-out events [MW, Mvar]
  std::string sentence;
  [[nodiscard]] double fall() const { return error[0] / error[1]; }
};

/// Compares the two networks. `estimates` must contain all records in their order. Throws InputError if no
/// event was held out, or if the networks share no parameter with a reference value.
Retrained compare_networks(const std::array<calibrate::NetworkEstimate, 2>& estimates,
                           const plant::PlantModel& before, const add::Addition& added,
                           const calibrate::Truth& truth);

std::string terminal_report(const Retrained& r);
nlohmann::json retrained_json(const Retrained& r);

}  // namespace swingbank::validate::retrain
