#include "mpi/store/dataset.hpp"

#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "base/sealed_text.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDatasetFormat = "swingbank-dataset-2";
constexpr const char* kRestoreHeader =
    "restore the file from a copy, or make the dataset again in an empty folder";
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
  if (h.frequency > 0.0) {
    j["frequency"] = h.frequency;
    j["generators"] = h.generators;
    if (!h.machine_base.empty()) j["machine_base"] = h.machine_base;
    j["held_names"] = h.held_names;
    j["held"] = h.held;
  }
  j["config"] = h.config;
  return j;
}

/// What is said of the generators must be said of each.
void require_agreement(const DatasetHeader& h) {
  const std::size_t n = h.generators.size();
  const bool values =
      std::ranges::all_of(h.held, [&](const auto& v) { return v.size() == h.held_names.size(); });
  if (h.held.size() != n || !values || (!h.machine_base.empty() && h.machine_base.size() != n))
    throw std::runtime_error("held or machine_base is not given for each of its generators");
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
  if (j.contains("frequency")) {
    j.at("frequency").get_to(h.frequency);
    j.at("generators").get_to(h.generators);
    if (j.contains("machine_base")) j.at("machine_base").get_to(h.machine_base);
    j.at("held_names").get_to(h.held_names);
    j.at("held").get_to(h.held);
    require_agreement(h);
  }
  j.at("config").get_to(h.config);
  if (h.draws_per_shard == 0) throw std::runtime_error("draws_per_shard is 0");
  return h;
}

ShardInfo info_of(const fs::path& folder, const JournalLine& l, const DatasetHeader& h,
                  std::uint64_t first_row) {
  return {folder / l.file, l.shard,
          l.rows,          first_row,
          l.bytes,         l.hash,
          h.config_hash,   {l.rows, h.channel_names.size(), h.samples, h.parameter_names.size()},
          l.draws,         l.outcomes,
          l.file_hash};
}

std::string text_of(const std::map<std::string, std::uint64_t>& outcomes) {
  std::string text;
  for (const auto& [name, count] : outcomes)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
  return text.empty() ? "none" : text;
}

std::string combine(const std::vector<ShardInfo>& shards) {
  std::string all;
  for (const auto& s : shards) all += s.hash;
  return hex(XXH3_64bits(all.data(), all.size()));
}

}  // namespace

std::string header_text(const DatasetHeader& header) {
  try {
    return sealed_text(to_json(header).dump(1));
  } catch (const nlohmann::json::type_error& e) {
    throw InputError({"a name that is no UTF-8", "the config '" + header.name + "' or a file it names",
                      e.what(), "give the file a name in UTF-8"});
  }
}

void write_header(const fs::path& folder, const DatasetHeader& header) {
  write_text(folder / "dataset.json", header_text(header));
}

std::string config_text(const DatasetHeader& header, const std::string& key) {
  const std::string start = "\n" + key + " = ", all = "\n" + header.config;
  const auto at = all.find(start);
  if (at == std::string::npos) return {};
  const auto from = at + start.size();
  return all.substr(from, std::min(all.find('\n', from), all.size()) - from);
}

std::vector<double> config_numbers(const DatasetHeader& header, const std::string& key) {
  const std::string text = config_text(header, key);
  std::vector<double> numbers;
  for (const char *p = text.data(), *end = p + text.size(); p < end;) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(p, end, value);
    if (error == std::errc{}) numbers.push_back(value);
    p = error == std::errc{} ? next : p + 1;
  }
  return numbers;
}

void require_machines(const DatasetHeader& header, const fs::path& folder) {
  if (header.frequency > 0.0) return;
  throw InputError({"no frequency and no held parameters", (folder / "dataset.json").string(),
                    "an older version of the software made the dataset",
                    "make the dataset again in an empty folder"});
}

DatasetHeader read_header(const fs::path& folder) {
  const fs::path file = folder / "dataset.json";
  if (!fs::exists(file))
    throw InputError(
        {"no dataset", folder.string(), "it holds no dataset.json", "give the folder that generate wrote"});
  try {
    const std::string text = read_text(file);
    DatasetHeader header = from_json(nlohmann::json::parse(text));
    if (!is_sealed(text))
      throw InputError(
          {"damaged dataset header", file.string(), "its sum is not that of its text", kRestoreHeader});
    return header;
  } catch (const nlohmann::json::exception& e) {
    throw InputError({"damaged dataset header", file.string(), e.what(), kRestoreHeader});
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
  auto lines = read_journals(folder);
  std::ranges::sort(lines, {}, &JournalLine::shard);
  Problems problems;
  for (const auto& l : lines) {
    if (const auto p = fault_of(folder, l, d, false)) problems.add(p->what, p->where, p->why, p->remedy);
    d.shards.push_back(info_of(folder, l, d, d.rows));
    d.rows += l.rows;
    for (const auto& [name, count] : l.outcomes) d.outcomes[name] += count;
    for (const auto& [name, count] : l.operating_points) d.operating_points[name] += count;
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

ShardData read_checked(const ShardInfo& s) {
  const auto fail = [&](const std::string& what, const std::string& why) {
    throw InputError({what, s.path.string(), why, kRepairDataset});
  };
  // First, because HDF5 1.10 may crash on a file that is damaged.
  if (const std::string bytes = hash_of_file(s.path); bytes != s.file_hash)
    fail("changed shard", "the hash of its bytes is " + bytes + ", the journal says " + s.file_hash);
  ShardData data = read_shard(s.path, {}, &s.shape);
  if (data.attributes.config_hash != s.config_hash)
    fail("a shard of another config",
         "its config hash is " + data.attributes.config_hash + ", the dataset's " + s.config_hash);
  if (const auto draws = data.draw_sample_id.size(); draws != s.draws)
    fail("another number of draws",
         "it has " + std::to_string(draws) + ", the journal says " + std::to_string(s.draws));
  if (const auto outcomes = count_outcomes(data.draw_outcome, s.path); outcomes != s.outcomes)
    fail("other outcomes", "it has " + text_of(outcomes) + ", the journal says " + text_of(s.outcomes));
  if (const auto found = hex(shard_hash(data)); found != s.hash)
    fail("changed shard", "its hash is " + found + ", the journal says " + s.hash);
  return data;
}

std::optional<Problem> fault_of(const fs::path& folder, const JournalLine& line, const DatasetHeader& header,
                                bool deep) {
  const fs::path file = folder / line.file;
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return Problem{"missing shard", file.string(), error.message(), kRepairDataset};
  if (size != line.bytes)
    return Problem{
        "truncated or changed shard", file.string(),
        "it has " + std::to_string(size) + " bytes, the journal says " + std::to_string(line.bytes),
        kRepairDataset};
  if (line.shard >= header.shard_count())
    return Problem{"shard " + std::to_string(line.shard), file.string(),
                   "the dataset has " + std::to_string(header.shard_count()) + " shards",
                   "restore dataset.json and the journals of one and the same dataset"};
  if (!deep) return std::nullopt;
  try {
    read_checked(info_of(folder, line, header, 0));
  } catch (const InputError& e) {
    Problem p = e.problems().front();
    p.remedy = kRepairDataset;
    return p;
  }
  return std::nullopt;
}

void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields) {
  read_rows(shard.path, first, count, out, shard.config_hash, fields, &shard.shape);
}

}  // namespace swingbank::mpi::store
