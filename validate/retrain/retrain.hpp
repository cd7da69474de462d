#pragma once
// What adding an effect does to a trained network: two datasets of the plant in its grid, without and with
// the effect; a network on each; both asked of the same measured records. Here is what does not need
// LibTorch: configs of the datasets and experiments, and the comparison. Who generates and trains:
// jobs/retrain_run.hpp.
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
  std::filesystem::path dataset;  ///< config of a dataset about this plant without the effect; empty: made
  std::uint64_t draws = 4000;     ///< events simulated for each network
  std::size_t epochs = 20;
  std::string network = "cnn";
  double range = 2.0;  ///< the effect's parameters are drawn from value / range to value * range, and those
                       ///< of the machine where no dataset is given
  std::uint64_t seed = 1;  ///< of draws and training
};

/// One network's files, in a folder of their own.
struct RetrainSide {
  std::string name;  ///< "without", "with"
  std::filesystem::path folder, dataset, experiment, data, results;
};

/// Writes a dataset config about the plant behind three lines and a large machine, at the operating point of
/// an event, with .raw and .dyr; each free parameter of the machine from value / range to value * range.
/// Returns the config's path. Throws InputError where the plant has no .dyr form.
std::filesystem::path write_plant_grid(const std::filesystem::path& folder, const plant::PlantModel& model,
                                       const event::FitEvent& event, double range);

/// Writes dataset and experiment of both sides below `folder`, the second with the effect of
/// `added`: attached at its fitted values and varied about those that the records decide. What the networks
/// read: P, Q, V, frequency, and speed and Ifd where every record holds them (and `added` compared them), for
/// up to 8 s after the event. Throws InputError: a base config that is not about one varied plant of this
/// machine model, an addition that a dataset cannot express, records that end too early.
std::array<RetrainSide, 2> write_retrain_configs(const std::filesystem::path& folder,
                                                 const plant::PlantModel& before, const add::Addition& added,
                                                 const std::vector<record::Record>& records,
                                                 const RetrainOptions& options);

/// One parameter that both networks learnt, or the network with the effect only.
struct RetrainedParameter {
  std::string name, unit;       ///< "GENROU.H"
  double reference = 0;         ///< the truth, else the fitted value
  double deviation = 0;         ///< of the values drawn: the box's width / sqrt(12)
  bool own = false;             ///< of the effect: only the network with it estimates it
  double estimate[2] = {0, 0};  ///< without, with: mean over the unseen events
  double error[2] = {0, 0};     ///< rms over the unseen events, in units of `deviation`
  double middle = 0;            ///< the same of the box's middle: what needs no network
};
struct RetrainedEvent {
  std::string record;
  bool seen = true;
  double parameter_error[2] = {0, 0};  ///< rms over the shared parameters, in deviations
  /// Model with the estimates from the events seen, this event's own instants and start: chi2 per value, and
  /// rms of P and Q [MW, Mvar]; infinite where that plant cannot be run.
  double misfit[2] = {0, 0}, rms[2] = {0, 0};
};
struct Retrained {
  bool truth = false;  ///< reference is the truth
  std::vector<RetrainedParameter> parameters;
  std::vector<RetrainedEvent> events;
  double error[2] = {0, 0}, middle = 0;  ///< rms over shared parameters and unseen events, in deviations
  double rms[2] = {0, 0};                ///< of P and Q over the unseen events [MW, Mvar]
  std::string sentence;
  [[nodiscard]] double fall() const { return error[0] / error[1]; }
};

/// `estimates`: of all records, in their order, by the two networks. Throws InputError where no event was
/// held out, or the networks share no learnt parameter with a reference.
Retrained compare_networks(const std::array<calibrate::NetworkEstimate, 2>& estimates,
                           const plant::PlantModel& before, const add::Addition& added,
                           const calibrate::Truth& truth);

std::string terminal_report(const Retrained& r);
nlohmann::json retrained_json(const Retrained& r);

}  // namespace swingbank::validate::retrain
