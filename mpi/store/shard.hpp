#pragma once
// Shard of a dataset: an HDF5 file (docs/reference/formats.md), read and written without MPI. Parallel
// writing is in mpi/ranks/shard_group.hpp. All functions are thread-safe; they hold one lock, because HDF5 is
// not thread-safe.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::mpi::store {

/// Attributes of the root group.
struct ShardAttributes {
  std::string config_hash;    ///< 16 hex digits
  std::string kernel;         ///< Batch::variant()
  std::string software;       ///< "swingbank 0.2.0"
  std::uint64_t seed = 0;     ///< seed of the dataset's random numbers
  std::uint64_t shard = 0;    ///< number of the shard in its dataset
  double rate = 0.0;          ///< sampling rate [1/s]
  std::string machine_model;  ///< "GENROU"
  std::vector<std::string> channel_names, channel_units, parameter_names, parameter_units;
  ///< names and units, in the order of the arrays' columns
  std::vector<double> parameter_low, parameter_high;  ///< ends of the parameter intervals
  std::vector<std::string> parameter_effects = {};    ///< effect of each parameter; empty: machine for all
  bool operating_points = false;  ///< whether operating points vary, and with them the machine bases
  bool int16 = false;             ///< storage as 16-bit integers (quantise.hpp) instead of float32
};

/// Rows of a shard, one for each varied generator of a stable draw; every array is row-major.
struct RowBlock {
  std::size_t rows = 0, channels = 0, samples = 0, parameter_count = 0;
  ///< numbers of rows, channels, samples and parameters
  std::vector<float> records;            ///< rows x channels x samples [pu on the machine's base, rad]
  std::vector<double> parameters;        ///< rows x parameters, in order of parameter_names
  std::vector<std::uint64_t> sample_id;  ///< rows
  std::vector<std::int32_t> generator;   ///< rows: bus number of the generator
  std::vector<double> fault;             ///< rows x 5: bus number, t_on [s], t_off [s], r [pu], x [pu]
  std::vector<double>
      largest_spread;  ///< rows: largest change of the angle between two rotors since t = 0 [rad]
  std::vector<std::uint8_t> angle_valid;  ///< rows x samples, or empty; 0 where V = 0 and theta is undefined
  std::vector<double> machine_base;       ///< rows: machine base [MVA]; empty without operating points
  std::vector<std::int16_t> codes;        ///< rows x channels x samples; empty for float32 records
  std::vector<float> code_scale;          ///< rows x channels x kScaleColumns: offset, step
};

/// Content of a shard.
struct ShardData : RowBlock {
  ShardAttributes attributes;                 ///< attributes of the root group
  std::vector<std::uint64_t> draw_sample_id;  ///< every draw (simulated event) of the shard, stable or not
  std::vector<std::uint8_t> draw_outcome;     ///< outcome of every draw, 0 ... kRefused
  /// draws x kRedrawnColumns: rejected operating points of the draw's block; empty without operating points.
  std::vector<std::int32_t> draw_redrawn;
};

constexpr std::size_t kFaultColumns = 5;    ///< bus number, t_on [s], t_off [s], r [pu], x [pu]
constexpr std::size_t kScaleColumns = 2;    ///< offset, step
constexpr std::size_t kRedrawnColumns = 2;  ///< no power flow, implausible
/// Remedy for a damaged shard.
constexpr const char* kRepairDataset =
    "run generate with --repair on the dataset: it generates the shard again";
/// Outcome in /draws/outcome of a draw with inadmissible parameters, or with machines that cannot be
/// initialised at their operating point. The values 0 ... 3 are sim::Outcome.
constexpr std::uint8_t kRefused = 4;
/// Returns the name of an outcome in /draws/outcome, for example "stable".
std::string_view draw_outcome_name(std::uint8_t outcome);

/// Expected shape of a shard, from its dataset.
struct ShardShape {
  std::uint64_t rows = 0, channels = 0, samples = 0, parameters = 0;
  ///< number of rows, channels, samples of a channel, and parameters
};

/// Optional arrays to read; those not chosen remain empty. All other arrays are always read.
struct ShardFields {
  bool records = true, parameters = true, angle_valid = true, draws = true;
  ///< waveforms; parameter values; validity of the angle; draws
};

/// Reads a whole shard. Throws InputError if the file is truncated, not a shard or inconsistent, or if its
/// arrays differ from `shape`; shapes are checked before memory is allocated.
ShardData read_shard(const std::filesystem::path& file, const ShardFields& fields = {},
                     const ShardShape* shape = nullptr);

/// Reads rows first ... first+count-1 into `out`, whose buffers are reused. Throws InputError as read_shard
/// does, and if the file's config hash differs from a given `config_hash`.
void read_rows(const std::filesystem::path& file, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const std::string& config_hash = {}, const ShardFields& fields = {},
               const ShardShape* shape = nullptr);

/// Writes a shard atomically. On failure (full disk, read-only folder), removes the temporary file and throws
/// InputError.
void write_shard(const std::filesystem::path& file, const ShardData& data);

/// Returns for each row XXH3-64 over its sample_id, generator, parameters, fault, largest_spread, angle_valid
/// and machine_base (if present), and record.
std::vector<std::uint64_t> row_hashes(const RowBlock& block);
/// Returns XXH3-64 over the row hashes in order, then sample_id, outcomes and rejected operating points of
/// the draws.
std::uint64_t shard_hash(const std::vector<std::uint64_t>& rows,
                         const std::vector<std::uint64_t>& draw_sample_id,
                         const std::vector<std::uint8_t>& draw_outcome,
                         const std::vector<std::int32_t>& draw_redrawn);
/// Returns the hash of a shard in memory.
std::uint64_t shard_hash(const ShardData& data);
/// Returns the number of draws by outcome, for outcomes that occur. Throws InputError with `file` for an
/// invalid outcome.
std::map<std::string, std::uint64_t> count_outcomes(const std::vector<std::uint8_t>& draw_outcome,
                                                    const std::filesystem::path& file);

}  // namespace swingbank::mpi::store
