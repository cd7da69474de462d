#include "mpi/store/dataset.hpp"

#include <xxhash.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "mpi/store/durable.hpp"
#include "mpi/store/journal.hpp"
#include "sim/core/problem.hpp"

namespace swingbank {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDatasetFormat = "swingbank-dataset-1";
constexpr const char* kRemake =
    "run generate with the dataset's config on this folder again: it makes what is missing";

nlohmann::ordered_json to_json(const DatasetHeader& h) {
  nlohmann::ordered_json j;
  j["format"] = kDatasetFormat;
  if (!h.name.empty()) j["name"] = h.name;
  j["config_hash"] = h.config_hash;
  j["kernel"] = h.kernel;
  j["software"] = h.software;
  j["machine_model"] = h.machine_model;
  j["seed"] = h.seed;
  j["draws"] = h.draws;
  j["draws_per_shard"] = h.draws_per_shard;
  j["shards"] = h.shard_count();
  j["rate"] = h.rate;
  j["samples"] = h.samples;
  j["channel_names"] = h.channel_names;
  j["channel_units"] = h.channel_units;
  j["parameter_names"] = h.parameter_names;
  j["parameter_units"] = h.parameter_units;
  j["parameter_low"] = h.parameter_low;
  j["parameter_high"] = h.parameter_high;
  if (!h.parameter_effects.empty()) j["parameter_effects"] = h.parameter_effects;
  j["config"] = h.config;
  return j;
}

DatasetHeader from_json(const nlohmann::json& j) {
  if (j.at("format") != kDatasetFormat)
    throw std::runtime_error("format is not \"" + std::string(kDatasetFormat) + "\"");
  DatasetHeader h;
  h.name = j.value("name", "");
  j.at("config_hash").get_to(h.config_hash);
  j.at("kernel").get_to(h.kernel);
  j.at("software").get_to(h.software);
  j.at("machine_model").get_to(h.machine_model);
  j.at("seed").get_to(h.seed);
  j.at("draws").get_to(h.draws);
  j.at("draws_per_shard").get_to(h.draws_per_shard);
  j.at("rate").get_to(h.rate);
  j.at("samples").get_to(h.samples);
  j.at("channel_names").get_to(h.channel_names);
  j.at("channel_units").get_to(h.channel_units);
  j.at("parameter_names").get_to(h.parameter_names);
  j.at("parameter_units").get_to(h.parameter_units);
  j.at("parameter_low").get_to(h.parameter_low);
  j.at("parameter_high").get_to(h.parameter_high);
  if (j.contains("parameter_effects")) j.at("parameter_effects").get_to(h.parameter_effects);
  j.at("config").get_to(h.config);
  if (h.draws_per_shard == 0) throw std::runtime_error("draws_per_shard is 0");
  return h;
}

constexpr const char* kRepair = "run generate with --repair on the dataset: it makes the shard anew";

/// What is wrong with a journalled shard; `deep` reads it, else its length must do, which shows truncation.
std::optional<Problem> fault_of(const fs::path& file, const JournalLine& line, const DatasetHeader& header,
                                bool deep) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return Problem{"missing shard", file.string(), error.message(), kRepair};
  if (size != line.bytes)
    return Problem{
        "truncated or changed shard", file.string(),
        "it has " + std::to_string(size) + " bytes, the journal says " + std::to_string(line.bytes), kRepair};
  if (line.shard >= header.shard_count())
    return Problem{"shard " + std::to_string(line.shard), file.string(),
                   "the dataset has " + std::to_string(header.shard_count()) + " shards",
                   "restore dataset.json and journal.jsonl of one and the same dataset"};
  if (!deep) return std::nullopt;
  try {
    const ShardData data = read_shard(file);
    if (data.attributes.config_hash != header.config_hash)
      return Problem{
          "a shard of another config", file.string(),
          "its config hash is " + data.attributes.config_hash + ", the dataset's " + header.config_hash,
          kRepair};
    if (const auto found = hex(shard_hash(data)); found != line.hash)
      return Problem{"changed shard", file.string(),
                     "its hash is " + found + ", the journal says " + line.hash, kRepair};
  } catch (const InputError& e) {
    Problem p = e.problems().front();
    p.remedy = kRepair;
    return p;
  }
  return std::nullopt;
}

std::string combine(const std::vector<ShardInfo>& shards) {
  std::string all;
  for (const auto& s : shards) all += s.hash;
  return hex(XXH3_64bits(all.data(), all.size()));
}

}  // namespace

void write_header(const fs::path& folder, const DatasetHeader& header) {
  write_text(folder / "dataset.json", to_json(header).dump(1) + "\n");
}

DatasetHeader read_header(const fs::path& folder) {
  const fs::path file = folder / "dataset.json";
  if (!fs::exists(file))
    throw InputError(
        {"no dataset", folder.string(), "it holds no dataset.json", "give the folder that generate wrote"});
  try {
    return from_json(nlohmann::json::parse(read_text(file)));
  } catch (const nlohmann::json::exception& e) {
    throw InputError({"damaged dataset header", file.string(), e.what(),
                      "restore the file from a copy, or make the dataset again in an empty folder"});
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& e) {
    throw InputError({"dataset header of another kind", file.string(), e.what(),
                      "use the version of the software that wrote it"});
  }
}

Dataset open_dataset(const fs::path& folder, bool allow_incomplete) {
  Dataset d;
  static_cast<DatasetHeader&>(d) = read_header(folder);
  d.path = folder;
  auto lines = read_journal(folder / "journal.jsonl");
  std::ranges::sort(lines, {}, &JournalLine::shard);
  Problems problems;
  for (const auto& l : lines) {
    ShardInfo s{folder / l.file, l.shard, l.rows, d.rows, l.bytes, l.hash, d.config_hash};
    if (const auto p = fault_of(s.path, l, d, false)) problems.add(p->what, p->where, p->why, p->remedy);
    d.rows += l.rows;
    for (const auto& [name, count] : l.outcomes) d.outcomes[name] += count;
    d.shards.push_back(std::move(s));
  }
  d.complete = d.shards.size() == d.shard_count();
  if (!d.complete && !allow_incomplete)
    problems.add(
        "unfinished dataset", folder.string(),
        std::to_string(d.shards.size()) + " of " + std::to_string(d.shard_count()) + " shards are there",
        kRemake);
  problems.raise();
  d.hash = combine(d.shards);
  return d;
}

std::vector<BadShard> find_bad_shards(const fs::path& folder, bool deep) {
  const DatasetHeader header = read_header(folder);
  std::vector<BadShard> bad;
  for (const auto& line : read_journal(folder / "journal.jsonl"))
    if (const auto p = fault_of(folder / line.file, line, header, deep)) bad.push_back({line.shard, *p});
  return bad;
}

std::vector<BadShard> strike_bad_shards(const fs::path& folder) {
  auto bad = find_bad_shards(folder, true);
  auto lines = read_journal(folder / "journal.jsonl");
  std::erase_if(lines, [&](const JournalLine& l) {
    return std::ranges::find(bad, l.shard, &BadShard::shard) != bad.end();
  });
  if (!bad.empty()) rewrite_journal(folder / "journal.jsonl", lines);
  return bad;
}

void verify_dataset(const Dataset& dataset) {
  Problems problems;
  for (const auto& bad : find_bad_shards(dataset.path, true))
    problems.add(bad.problem.what, bad.problem.where, bad.problem.why, bad.problem.remedy);
  problems.raise();
}

void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields) {
  read_rows(shard.path, first, count, out, shard.config_hash, fields);
}

}  // namespace swingbank
