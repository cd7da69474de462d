#pragma once
// Dataset folder: dataset.json, journals, shards/ (docs/reference/formats.md). Readers use only the shards
// that the journals list.
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

/// Content of dataset.json, which is written before the first shard.
struct DatasetHeader {
  std::string name = {};  ///< name of the config's file, "ieee39_genrou"; empty in older datasets
  std::string config_hash, kernel, software, machine_model;
  ///< 16 hex digits; Batch::variant(); "swingbank 0.2.0"; "GENROU"
  std::string config;  ///< the config in canonical form
  std::uint64_t seed = 0, draws = 0, draws_per_shard = 0;
  ///< seed of the random numbers; number of draws (simulated events); number of draws of a full shard
  double rate = 0.0;          ///< sampling rate [1/s]
  std::uint64_t samples = 0;  ///< samples per channel and row
  std::vector<std::string> channel_names, channel_units, parameter_names, parameter_units;
  ///< names and units, in the order of the arrays' columns
  std::vector<double> parameter_low, parameter_high;  ///< ends of the parameter intervals
  std::vector<std::string> parameter_effects = {};    ///< effect of each parameter; empty: machine for all
  double frequency = 0.0;                             ///< nominal frequency [Hz]; 0 in older datasets
  /// Bus numbers of the varied generators; empty in older datasets.
  std::vector<std::int32_t> generators = {};
  std::vector<double> machine_base = {};       ///< machine bases [MVA]; empty if each row has its own
  std::vector<std::string> held_names = {};    ///< fixed machine parameters outside of parameter_names
  std::vector<std::vector<double>> held = {};  ///< values of the fixed parameters of each generator
  bool int16 = false;                          ///< storage as 16-bit integers (quantise.hpp)
  /// Returns the number of shards; the last one may hold fewer draws.
  [[nodiscard]] std::uint64_t shard_count() const { return (draws + draws_per_shard - 1) / draws_per_shard; }
};

/// Shard of a dataset according to header and journal.
struct ShardInfo {
  std::filesystem::path path;   ///< HDF5 file
  std::uint64_t shard = 0;      ///< number in the dataset
  std::uint64_t rows = 0;       ///< number of rows
  std::uint64_t first_row = 0;  ///< index of its first row in the dataset
  std::uint64_t bytes = 0;      ///< length of the file [bytes]
  std::string hash;             ///< shard hash, 16 hex digits
  std::string config_hash;      ///< hash of the config that the shard was generated from, 16 hex digits
  ShardShape shape;             ///< shape of its arrays
  std::uint64_t draws = 0;      ///< number of draws, stable or not
  std::map<std::string, std::uint64_t> outcomes;  ///< draws by outcome
  std::string file_hash;                          ///< hash of the file's bytes
};

/// Dataset with its shards.
struct Dataset : DatasetHeader {
  std::filesystem::path path;     ///< dataset folder
  std::string hash;               ///< XXH3-64 over the shard hashes in order of shard number, 16 hex digits
  std::vector<ShardInfo> shards;  ///< in order of shard number
  std::uint64_t rows = 0;         ///< number of rows in all shards
  std::map<std::string, std::uint64_t> outcomes;          ///< draws by outcome
  std::map<std::string, std::uint64_t> operating_points;  ///< sum of the journal's counts over all shards
  bool complete = false;                                  ///< whether the journals list every shard
};

/// Returns XXH3-64 over the shard hashes in order of shard number, 16 hex digits.
std::string dataset_hash(const std::vector<ShardInfo>& shards);
/// Returns the properties of a shard in memory; `bytes` and `file_hash` are unset, and `path` is a
/// description.
ShardInfo info_of(const DatasetHeader& header, const ShardData& data, std::uint64_t first_row);

/// Opens a dataset. Takes the list of shards from the manifest if there is one, without access to the shards.
/// Otherwise takes it from the journals and checks that the files exist. The functions that read a shard
/// check its length; read_checked also checks its hash. Throws InputError if there is no dataset or, unless
/// `allow_incomplete`, if shards are missing.
Dataset open_dataset(const std::filesystem::path& folder, bool allow_incomplete = false);
/// Shard that differs from its journal line, and the problem.
struct BadShard {
  std::uint64_t shard;  ///< number in the dataset
  Problem problem;      ///< difference and remedy
};
/// Returns the problem of a shard of `folder`, if any: missing file, wrong length and, with `deep`, any
/// difference that read_checked detects. Reads the file only with `deep`.
std::optional<Problem> fault_of(const std::filesystem::path& folder, const JournalLine& line,
                                const DatasetHeader& header, bool deep);
/// Reads a whole shard and compares it with header and journal: config, shapes, rows, draws, outcomes, hash.
/// Throws InputError with the remedy --repair if it differs.
ShardData read_checked(const ShardInfo& shard);
/// Reads rows first ... first+count-1 of a shard. Checks length, config and shapes, but not the hash. Throws
/// InputError if they differ.
void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields = {});

/// Returns the numbers of a line "key = 1" or "key = [1, 2]" of a dataset's config; empty if there is no such
/// line.
std::vector<double> config_numbers(const DatasetHeader& header, const std::string& key);
/// Returns the text after "key = " in a dataset's config; empty if there is no such line.
std::string config_text(const DatasetHeader& header, const std::string& key);

/// Throws InputError if the header lacks the frequency and the fixed parameters, as it does in older
/// datasets.
void require_machines(const DatasetHeader& header, const std::filesystem::path& folder);

/// Returns the text of dataset.json. Throws InputError if a text of the header is not UTF-8, which JSON
/// cannot represent.
std::string header_text(const DatasetHeader& header);
/// Writes dataset.json atomically.
void write_header(const std::filesystem::path& folder, const DatasetHeader& header);
/// Reads dataset.json. Throws InputError if it is missing, damaged or of another version.
DatasetHeader read_header(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
