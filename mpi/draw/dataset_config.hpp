#pragma once
// A dataset's config (configs/datasets/*.toml; keys explained in configs/datasets/README.md) and the grid it
// is about.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/frequency.hpp"
#include "sim/grid/grid.hpp"
#include "sim/lanes/batch.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::mpi::draw {

enum class Policy { physical, literal };
enum class Vary { one, all };

/// A parameter of the dataset: sampled uniformly from low ... high, or held (low == high).
struct Box {
  int index;  ///< in the effect's records
  double low, high;
  const sim::Effect* effect = nullptr;  ///< whose parameter it is; nullptr: the machine's
  [[nodiscard]] bool sampled() const { return high > low; }
};

struct DatabankConfig {
  Policy policy = Policy::physical;
  double distance = 0.0;  ///< smallest Euclidean distance of two points; 0: none
  bool scaled = false;    ///< distance in units of each box's width, else in the parameters' own units
  double candidates_per_point = 20.0;  ///< gives up after this many admissible candidates per point
};

struct FaultConfig {
  std::vector<int> buses;                 ///< bus numbers; empty: any bus
  std::vector<int> except;                ///< bus numbers
  double start = 2.0;                     ///< [s]
  double shortest = 0.05, longest = 0.2;  ///< duration [s]
  double r = 0.0, x = 0.0;                ///< [pu on the network's base]; 0: bolted
  std::uint64_t per_point = 1;            ///< faults simulated for each point of the databank
};

struct RecordConfig {
  double t_end = 15.0;                ///< [s]
  double rate = 60.0;                 ///< [1/s]
  std::vector<std::string> channels;  ///< of sim/core/channel.hpp, or "frequency"
  sim::FrequencyFilter frequency;
  bool int16 = false;  ///< stored as mpi/store/quantise.hpp says, else as float32
  /// At k/rate, k = 0 ... t_end rate - 1: whole seconds hold whole numbers of samples.
  [[nodiscard]] std::size_t samples() const;
};

/// Operating points drawn at random; what is not given stays as in the case file. All factors are uniform.
struct OperatingPointConfig {
  std::uint64_t per_block = 2;                     ///< draws that share one operating point
  double loads_low = 1.0, loads_high = 1.0;        ///< factor of all loads and of all dispatch
  double load_spread = 0.0;                        ///< each load by itself: factor 1 -+ this
  double dispatch_low = 1.0, dispatch_high = 1.0;  ///< each generator's power by itself; the slack balances
  double voltage = 0.0;                            ///< each held voltage: plus or minus this [pu]
  /// Apparent power over machine base; 0: bases stay. So many of the machines have a base so many times
  /// larger.
  double loading_low = 0.0, loading_high = 0.0;
  double oversized_share = 0.0, oversized_low = 1.0, oversized_high = 1.0;
  int lines_out_low = 0, lines_out_high = 0;  ///< lines out of service
  [[nodiscard]] bool draws_bases() const { return loading_high > 0.0; }
};

/// What is done to a case that is not whole, as the options of the same names of `simulate` say.
struct CaseConfig {
  int raw_version = 0;
  bool net_generators = false, widen_limits = false;
  bool start_from_file = false, reactive_limits = true, drop_refused = false;
  std::string complete_records = "no", devices = "checked", repeated = "refuse";
};

/// What the command line replaces.
struct Overrides {
  std::optional<std::uint64_t> draws = {}, seed = {}, draws_per_shard = {}, faults_per_point = {};
  std::optional<double> shard_megabytes = {}, rate = {};  ///< [MB], [1/s]
  std::vector<std::string> channels = {};                 ///< only these of the config's; empty: all
  bool int16 = false;                                     ///< records as int16, whatever the config says
};

struct DatasetConfig {
  std::filesystem::path file, raw, dyr;
  Overrides overrides;                 ///< as they were given; all below holds them already
  bool psse = true;                    ///< convention, else andes
  sim::formats::DyrOptions models;     ///< .dyr models left out or read as others
  std::optional<double> frequency_hz;  ///< what a MATPOWER case needs
  CaseConfig mend;                     ///< of raw and dyr
  Vary vary = Vary::one;
  std::vector<int> generators;   ///< bus numbers of the machines that vary
  std::vector<std::string> ids;  ///< of the units at these buses; "": the only one there. Empty: all so
  std::string model;             ///< their machine model
  /// The machine's in record order, then those of other effects in order of slot, name and record.
  std::vector<Box> box;
  std::vector<std::filesystem::path> laws;          ///< law files; read with the config
  sim::library::EffectLibrary library;              ///< owns the laws that box and attachments point to
  std::vector<sim::plant::Attachment> attachments;  ///< effects that the .dyr lacks
  DatabankConfig databank;
  FaultConfig fault;
  RecordConfig record;
  std::optional<OperatingPointConfig> operating_point;
  std::uint64_t draws = 0, draws_per_shard = 0, seed = 1;
  double tolerance = 1e-6;  ///< of the kernel
  int lanes = 0;            ///< of the kernel; 0: the widest of this build

  [[nodiscard]] const sim::Effect& effect() const;
  [[nodiscard]] const sim::Effect& effect_of(const Box& box) const;
  [[nodiscard]] const sim::Parameter& record_of(const Box& box) const;
  /// "H" of the machine, "SEXS.K" of another effect.
  [[nodiscard]] std::string name_of(const Box& box) const;
  /// The effects besides the machine that have parameters in the box, each once.
  [[nodiscard]] std::vector<const sim::Effect*> other_effects() const;
  /// What a stable draw takes in a shard [bytes].
  [[nodiscard]] std::uint64_t bytes_per_draw() const;
  /// Points of the databank the draws need.
  [[nodiscard]] std::uint64_t points() const;
  /// Every value that bytes depend on, one `key = value` per line.
  [[nodiscard]] std::string canonical() const;
};

/// Throws InputError with every problem of the file.
DatasetConfig read_dataset_config(const std::filesystem::path& file, const Overrides& overrides = {});

/// The config joined with its grid: bus numbers became indices.
struct Study {
  DatasetConfig config;
  sim::grid::Grid grid;
  std::vector<int> plants;       ///< index of each varied generator
  std::vector<int> fault_buses;  ///< index of each bus that may be faulted
};
/// Throws InputError: unknown buses, a generator of another model or without a varied effect, an effect
/// attached to a slot that is taken, parameters nobody can run.
Study load_study(const DatasetConfig& config);

/// XXH3-64 over the canonical config, the contents of .raw, .dyr and law files and the kernel's variant; 16
/// hex digits.
std::string config_hash(const DatasetConfig& config, const std::string& kernel);

}  // namespace swingbank::mpi::draw
