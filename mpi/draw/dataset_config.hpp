#pragma once
// Config of a dataset (configs/datasets/*.toml; keys in configs/datasets/README.md) and its grid.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/batch/batch.hpp"
#include "sim/core/frequency.hpp"
#include "sim/grid/grid.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::mpi::draw {

/// Policy for parameter sets: only physical ones are admissible, or all that the equations allow.
enum class Policy { physical, literal };
/// Number of generators that vary in an event.
enum class Vary { one, all };

/// Parameter of the dataset: sampled uniformly from [low, high], or fixed (low == high).
struct Box {
  int index;  ///< index in the effect's parameter records
  double low, high;
  const sim::Effect* effect = nullptr;  ///< effect with this parameter; nullptr: the machine
  [[nodiscard]] bool sampled() const { return high > low; }
};

/// [databank]: sampling of the parameter sets.
struct DatabankConfig {
  Policy policy = Policy::physical;
  double distance = 0.0;               ///< minimum Euclidean distance of two samples; 0: none
  bool scaled = false;                 ///< distance in box widths, else in the parameters' units
  double candidates_per_point = 20.0;  ///< largest number of admissible candidates per sample
};

/// [fault]: short circuits of the dataset.
struct FaultConfig {
  std::vector<int> buses;                 ///< bus numbers; empty: any bus
  std::vector<int> except;                ///< numbers of buses that are not faulted
  double start = 2.0;                     ///< time of the fault [s]
  double shortest = 0.05, longest = 0.2;  ///< duration [s]
  double r = 0.0, x = 0.0;                ///< fault impedance [pu on the network's base]; 0: bolted
  std::uint64_t per_point = 1;            ///< faults simulated for each databank sample
};

/// [record]: recorded channels and sampling.
struct RecordConfig {
  double t_end = 15.0;                ///< duration [s]
  double rate = 60.0;                 ///< sampling rate [1/s]
  std::vector<std::string> channels;  ///< names of sim/core/channel.hpp, or "frequency"
  sim::FrequencyFilter frequency;
  bool int16 = false;  ///< storage as 16-bit integers (mpi/store/quantise.hpp) instead of float32
  /// Returns the number of samples, at times k/rate, k = 0 ... t_end rate - 1, so that every whole second has
  /// the same number of samples.
  [[nodiscard]] std::size_t samples() const;
};

/// [operating_point]: random operating points. All quantities are uniformly distributed; a quantity without a
/// range keeps its value of the case file.
struct OperatingPointConfig {
  std::uint64_t per_block = 2;                     ///< number of draws that share one operating point
  double loads_low = 1.0, loads_high = 1.0;        ///< common factor of all loads and of all generators' P
  double load_spread = 0.0;                        ///< individual factor of each load: 1 -+ this
  double dispatch_low = 1.0, dispatch_high = 1.0;  ///< individual factor of each generator's P
  double voltage = 0.0;                            ///< change of each voltage setpoint: -+ this [pu]
  /// Loading: apparent power / machine base; 0: the bases do not change.
  double loading_low = 0.0, loading_high = 0.0;
  /// Fraction of machines that are oversized, and range of the factor that multiplies their base.
  double oversized_share = 0.0, oversized_low = 1.0, oversized_high = 1.0;
  int lines_out_low = 0, lines_out_high = 0;  ///< number of lines out of service
  [[nodiscard]] bool draws_bases() const { return loading_high > 0.0; }
};

/// Command-line options that replace values of the config.
struct Overrides {
  std::optional<std::uint64_t> draws = {}, seed = {}, draws_per_shard = {}, faults_per_point = {};
  std::optional<double> shard_megabytes = {}, rate = {};  ///< size of a shard [MB]; sampling rate [1/s]
  std::vector<std::string> channels = {};                 ///< subset of the config's channels; empty: all
  bool int16 = false;                                     ///< store records as 16-bit integers
};

/// Values of a dataset's config. A draw is one simulated event.
struct DatasetConfig {
  std::filesystem::path file, raw, dyr;
  Overrides overrides;               ///< as given; already applied to the other members
  bool psse = true;                  ///< true: conventions of PSS/E; false: of ANDES
  sim::grid::CaseOptions grid_case;  ///< treatment of an incomplete case, as in `swingbank simulate`
  bool widen_limits = false;         ///< widen limits that the operating point violates
  Vary vary = Vary::one;
  std::vector<int> generators;   ///< bus numbers of the machines that vary
  std::vector<std::string> ids;  ///< machine id at each bus; "": the only machine; empty list: "" for all
  std::string model;             ///< machine model of the units that vary
  /// Parameters of the machine in the order of its parameter list, then those of other effects, sorted by
  /// slot, effect name and parameter list.
  std::vector<Box> box;
  std::vector<std::filesystem::path> user_models;   ///< files of user-defined models
  sim::library::EffectLibrary library;              ///< owner of the user-defined models
  std::vector<sim::plant::Attachment> attachments;  ///< effects added to the .dyr
  DatabankConfig databank;
  FaultConfig fault;
  RecordConfig record;
  std::optional<OperatingPointConfig> operating_point;
  std::uint64_t draws = 0, draws_per_shard = 0, seed = 1;
  double tolerance = 1e-6;  ///< integration tolerance of the kernel
  int lanes = 0;            ///< SIMD width of the kernel; 0: the widest of this build in double

  [[nodiscard]] const sim::Effect& effect() const;
  [[nodiscard]] const sim::Effect& effect_of(const Box& box) const;
  [[nodiscard]] const sim::Parameter& record_of(const Box& box) const;
  /// Returns the parameter's name: "H" of the machine, "SEXS.K" of another effect.
  [[nodiscard]] std::string name_of(const Box& box) const;
  /// Returns the effects with parameters in the box, each once, without the machine.
  [[nodiscard]] std::vector<const sim::Effect*> other_effects() const;
  /// Returns the size of one stable draw's data in a shard [bytes].
  [[nodiscard]] std::uint64_t bytes_per_draw() const;
  /// Returns the number of databank samples for all draws.
  [[nodiscard]] std::uint64_t points() const;
  /// Returns every value that affects the dataset's bytes, one `key = value` per line.
  [[nodiscard]] std::string canonical() const;
};

/// Reads a config. Throws InputError with every problem of the file.
DatasetConfig read_dataset_config(const std::filesystem::path& file, const Overrides& overrides = {});

/// Returns the JSON Schema of configs.
std::string dataset_schema();

/// Config with its grid; bus numbers are resolved to indices.
struct Study {
  DatasetConfig config;
  sim::grid::Grid grid;
  std::vector<int> plants;       ///< index of each varied generator
  std::vector<int> fault_buses;  ///< index of each bus that may be faulted
};
/// Loads the grid of a config. Throws InputError for an unknown bus, a generator with another machine model
/// or without a varied effect, an effect attached to an occupied slot, or invalid parameters.
Study load_study(const DatasetConfig& config);

/// Returns the XXH3-64 hash of the canonical config, the contents of .raw, .dyr and user-defined models, and
/// the description `kernel` of the SIMD kernel; 16 hex digits.
std::string config_hash(const DatasetConfig& config, const std::string& kernel);

}  // namespace swingbank::mpi::draw
