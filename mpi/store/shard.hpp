#pragma once
// One shard of a dataset: the HDF5 file that docs/formats.md describes. Reading works without MPI; writing
// through the MPI-IO driver stands in mpi/ranks/shard_group.hpp. All functions may be called from several
// threads: HDF5 is not thread-safe, so they take one lock.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::mpi::store {

/// What the root group's attributes say.
struct ShardAttributes {
  std::string config_hash;  ///< 16 hex digits
  std::string kernel;       ///< Batch::variant()
  std::string software;     ///< "swingbank 0.1.0"
  std::uint64_t seed = 0;
  std::uint64_t shard = 0;    ///< number of the shard in its dataset
  double rate = 0.0;          ///< samples per second [1/s]
  std::string machine_model;  ///< "GENROU"
  std::vector<std::string> channel_names, channel_units, parameter_names, parameter_units;
  std::vector<double> parameter_low, parameter_high;  ///< the sampling box
  std::vector<std::string> parameter_effects = {};    ///< whose they are; empty: all the machine's
  bool operating_points =
      false;           ///< whether rows have a machine base and draws an operating point of their own
  bool int16 = false;  ///< whether records are stored as quantise.hpp says, else as float32
};

/// Rows of a shard, one per stable generator record; every array is row-major.
struct RowBlock {
  std::size_t rows = 0, channels = 0, samples = 0, parameter_count = 0;
  std::vector<float> records;             ///< rows x channels x samples [pu on the machine's base, rad, pu/s]
  std::vector<double> parameters;         ///< rows x parameters, in order of parameter_names
  std::vector<std::uint64_t> sample_id;   ///< rows
  std::vector<std::int32_t> generator;    ///< rows: bus number of the generator
  std::vector<double> fault;              ///< rows x 5: bus number, t_on [s], t_off [s], r [pu], x [pu]
  std::vector<double> largest_spread;     ///< rows: how far apart two rotor angles have moved, at most [rad]
  std::vector<std::uint8_t> angle_valid;  ///< rows x samples, or empty: 0 where V = 0 and theta is held
  std::vector<double> machine_base;       ///< rows: of the generator [MVA]; empty without operating points
  std::vector<std::int16_t> codes;        ///< rows x channels x samples; empty where records are float32
  std::vector<float> code_scale;          ///< rows x channels x kScaleColumns: offset, step
};

struct ShardData : RowBlock {
  ShardAttributes attributes;
  std::vector<std::uint64_t> draw_sample_id;  ///< every draw of the shard, stable or not
  std::vector<std::uint8_t> draw_outcome;     ///< 0 ... kRefused
  /// draws x kRedrawnColumns: how often the draw's operating point was drawn again; empty without them.
  std::vector<std::int32_t> draw_redrawn;
};

constexpr std::size_t kFaultColumns = 5;
constexpr std::size_t kScaleColumns = 2;    ///< offset, step
constexpr std::size_t kRedrawnColumns = 2;  ///< no power flow, implausible
/// What to do about a shard that cannot be trusted.
constexpr const char* kRepairDataset = "run generate with --repair on the dataset: it makes the shard anew";
/// What a draw came to; the numbers stand in /draws/outcome. The first four are sim::Outcome.
constexpr std::uint8_t kRefused = 4;
std::string_view draw_outcome_name(std::uint8_t outcome);

/// What a dataset says of one of its shards before the file is opened.
struct ShardShape {
  std::uint64_t rows = 0, channels = 0, samples = 0, parameters = 0;
};

/// Which arrays a reader wants; what is not asked for stays empty.
struct ShardFields {
  bool records = true, parameters = true, angle_valid = true, draws = true;
};

/// Reads a whole shard. Throws InputError naming the file if it is truncated, no shard, or inconsistent, and
/// if its arrays are not as `shape` says; it is told before memory is taken for them.
ShardData read_shard(const std::filesystem::path& file, const ShardFields& fields = {},
                     const ShardShape* shape = nullptr);

/// Reads rows first ... first+count-1 into `out`, whose buffers are reused. Throws InputError as read_shard
/// does, and if `config_hash` is given and the file holds another one.
void read_rows(const std::filesystem::path& file, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const std::string& config_hash = {}, const ShardFields& fields = {},
               const ShardShape* shape = nullptr);

/// Writes a shard under a temporary name, flushes it to the disk and renames it. Throws InputError naming the
/// file if the disk is full or the folder cannot be written; nothing is left behind then.
void write_shard(const std::filesystem::path& file, const ShardData& data);

/// XXH3-64 over sample_id, generator, parameters, fault, largest_spread, angle_valid, machine_base (both if
/// there are any) and record of each row.
std::vector<std::uint64_t> row_hashes(const RowBlock& block);
/// XXH3-64 over the row hashes in order, then the draws' sample_id, outcomes and redraws.
std::uint64_t shard_hash(const std::vector<std::uint64_t>& rows,
                         const std::vector<std::uint64_t>& draw_sample_id,
                         const std::vector<std::uint8_t>& draw_outcome,
                         const std::vector<std::int32_t>& draw_redrawn);
std::uint64_t shard_hash(const ShardData& data);
/// Draws by outcome; those that did not occur are left out. Throws InputError naming `file` for a number that
/// is none.
std::map<std::string, std::uint64_t> count_outcomes(const std::vector<std::uint8_t>& draw_outcome,
                                                    const std::filesystem::path& file);

}  // namespace swingbank::mpi::store
