#pragma once
// A dataset folder: dataset.json, journals, shards/ (docs/formats.md). Readers trust the journals alone.
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

/// What dataset.json says; written before the first shard.
struct DatasetHeader {
  std::string name = {};  ///< of the config's file: "ieee39_genrou"; empty in older datasets
  std::string config_hash, kernel, software, machine_model;
  std::string config;  ///< the config in canonical form
  std::uint64_t seed = 0, draws = 0, draws_per_shard = 0;
  double rate = 0.0;          ///< [1/s]
  std::uint64_t samples = 0;  ///< per channel and row
  std::vector<std::string> channel_names, channel_units, parameter_names, parameter_units;
  std::vector<double> parameter_low, parameter_high;  ///< the sampling box
  std::vector<std::string> parameter_effects = {};    ///< whose they are; empty: all the machine's
  double frequency = 0.0;                             ///< of the system [Hz]; 0 in older datasets
  std::vector<std::int32_t> generators = {};   ///< bus numbers of those that vary; empty in older datasets
  std::vector<double> machine_base = {};       ///< theirs [MVA]; empty where each row has its own
  std::vector<std::string> held_names = {};    ///< parameters of the machine that are not among the above
  std::vector<std::vector<double>> held = {};  ///< their values, generator by generator
  bool int16 = false;                          ///< records are stored as quantise.hpp says
  [[nodiscard]] std::uint64_t shard_count() const { return (draws + draws_per_shard - 1) / draws_per_shard; }
};

struct ShardInfo {
  std::filesystem::path path;
  std::uint64_t shard = 0;  ///< number in the dataset
  std::uint64_t rows = 0;
  std::uint64_t first_row = 0;  ///< of this shard, counted over the dataset
  std::uint64_t bytes = 0;
  std::string hash;  ///< shard hash, 16 hex digits
  std::string config_hash;
  ShardShape shape;  ///< by header and journal
  std::uint64_t draws = 0;
  std::map<std::string, std::uint64_t> outcomes;  ///< draws by outcome
  std::string file_hash;                          ///< of the file's bytes
};

struct Dataset : DatasetHeader {
  std::filesystem::path path;
  std::string hash;               ///< XXH3-64 over the shard hashes in order of shard number, 16 hex digits
  std::vector<ShardInfo> shards;  ///< in order of shard number
  std::uint64_t rows = 0;
  std::map<std::string, std::uint64_t> outcomes;          ///< draws by outcome
  std::map<std::string, std::uint64_t> operating_points;  ///< as in the journal, over all shards
  bool complete = false;                                  ///< every shard of the header is in the journal
};

/// XXH3-64 over the shard hashes in order of shard number, 16 hex digits.
std::string dataset_hash(const std::vector<ShardInfo>& shards);
/// What there is to say of a shard that stands in memory, and not on the disk: no path, bytes or file hash.
ShardInfo info_of(const DatasetHeader& header, const ShardData& data, std::uint64_t first_row);

/// Opens a dataset. Throws InputError naming file and remedy if there is none, or, unless `allow_incomplete`,
/// if shards are still to be made. By the manifest where there is one, which names what there is without a
/// look at each file; else by the journals and the names in the folders. Whoever reads a shard looks at its
/// length and bytes.
Dataset open_dataset(const std::filesystem::path& folder, bool allow_incomplete = false);
/// A journalled shard that cannot be trusted, and why.
struct BadShard {
  std::uint64_t shard;
  Problem problem;
};
/// What is wrong with a journalled shard of `folder`: missing, of another length, and, if `deep`, not as
/// read_checked wants it. Reads the file if `deep`.
std::optional<Problem> fault_of(const std::filesystem::path& folder, const JournalLine& line,
                                const DatasetHeader& header, bool deep);
/// Reads a whole shard and compares it with header and journal: config, shapes, rows, draws, outcomes, hash.
/// Throws InputError naming the file; the remedy is --repair.
ShardData read_checked(const ShardInfo& shard);
/// Rows first ... first+count-1 of one shard. Checks length, config and shapes, not the hash.
void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields = {});

/// Numbers of a line "key = 1" or "key = [1, 2]" of a dataset's config; empty if it has no such line.
std::vector<double> config_numbers(const DatasetHeader& header, const std::string& key);
/// What stands behind "key = " in a dataset's config; empty if it has no such line.
std::string config_text(const DatasetHeader& header, const std::string& key);

/// Throws InputError if the header says neither frequency nor what its machines hold fixed: older datasets.
void require_machines(const DatasetHeader& header, const std::filesystem::path& folder);

/// What dataset.json holds. Throws InputError if a text of the header is no UTF-8, which JSON cannot hold.
std::string header_text(const DatasetHeader& header);
/// Writes dataset.json under a temporary name, flushes and renames.
void write_header(const std::filesystem::path& folder, const DatasetHeader& header);
DatasetHeader read_header(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
