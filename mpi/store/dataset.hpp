#pragma once
// A dataset folder: dataset.json, journal.jsonl, shards/ (docs/formats.md). Readers trust the journal alone.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mpi/store/shard.hpp"
#include "sim/core/problem.hpp"

namespace swingbank {

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
};

struct Dataset : DatasetHeader {
  std::filesystem::path path;
  std::string hash;               ///< XXH3-64 over the shard hashes in order of shard number, 16 hex digits
  std::vector<ShardInfo> shards;  ///< in order of shard number
  std::uint64_t rows = 0;
  std::map<std::string, std::uint64_t> outcomes;  ///< draws by outcome
  bool complete = false;                          ///< every shard of the header is in the journal
};

/// Opens a dataset. Throws InputError naming file and remedy if there is none, if a shard is missing or
/// truncated, or, unless `allow_incomplete`, if shards are still to be made.
Dataset open_dataset(const std::filesystem::path& folder, bool allow_incomplete = false);
/// A journalled shard that cannot be trusted, and why.
struct BadShard {
  std::uint64_t shard;
  Problem problem;
};
/// Journalled shards that are missing, of another length, and, if `deep`, of another config or content.
std::vector<BadShard> find_bad_shards(const std::filesystem::path& folder, bool deep);
/// Takes bad shards (deep) out of the journal, so that generate makes them anew. Returns what they were.
std::vector<BadShard> strike_bad_shards(const std::filesystem::path& folder);
/// Reads every shard and compares its hash and config with the journal. Throws InputError with every shard at
/// fault.
void verify_dataset(const Dataset& dataset);
/// Rows first ... first+count-1 of one shard.
void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields = {});

/// Writes dataset.json under a temporary name, flushes and renames.
void write_header(const std::filesystem::path& folder, const DatasetHeader& header);
DatasetHeader read_header(const std::filesystem::path& folder);

}  // namespace swingbank
