#include "mpi/store/dataset.hpp"

#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/sealed_text.hpp"
#include "mpi/store/manifest.hpp"
#include "mpi/store/shard_apart.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDatasetFormat = "swingbank-dataset-2";
constexpr const char* kInt16Dataset = "swingbank-dataset-3";  ///< older readers reject this format
constexpr const char* kRestoreHeader =
    "restore the file from a copy, or generate the dataset again in an empty folder";
constexpr const char* kRemake =
    "run generate with the dataset's config on this folder again: it generates the missing shards";

nlohmann::ordered_json to_json(const DatasetHeader& h) {
  nlohmann::ordered_json j;
  j["format"] = h.int16 ? kInt16Dataset : kDatasetFormat;
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
  if (h.int16) j["record_storage"] = "int16";
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

/// Throws std::runtime_error unless the fixed parameters and bases are given for every generator.
void require_agreement(const DatasetHeader& h) {
  const std::size_t n = h.generators.size();
  const bool values =
      std::ranges::all_of(h.held, [&](const auto& v) { return v.size() == h.held_names.size(); });
  if (h.held.size() != n || !values || (!h.machine_base.empty() && h.machine_base.size() != n))
    throw std::runtime_error("held or machine_base is not given for each of its generators");
}

DatasetHeader from_json(const nlohmann::json& j) {
  const std::string format = j.at("format");
  if (format != kDatasetFormat && format != kInt16Dataset)
    throw std::runtime_error("format is \"" + format + "\", neither \"" + kDatasetFormat + "\" nor \"" +
                             kInt16Dataset + "\"");
  DatasetHeader h;
  h.int16 = format == kInt16Dataset;
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

/// Returns the problem of a file whose length differs from the journal's; nothing if it agrees.
std::optional<Problem> fault_of_length(const fs::path& file, std::uint64_t bytes) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return Problem{"missing shard", file.string(), error.message(), kRepairDataset};
  if (size == bytes) return std::nullopt;
  return Problem{"truncated or changed shard", file.string(),
                 "it has " + std::to_string(size) + " bytes, the journal records " + std::to_string(bytes),
                 kRepairDataset};
}

Problem beyond(const fs::path& folder, const JournalLine& line, const DatasetHeader& header) {
  return {"journal entry for shard " + std::to_string(line.shard), (folder / line.file).string(),
          "the dataset has " + std::to_string(header.shard_count()) + " shards",
          "restore dataset.json and the journals of one and the same dataset"};
}

void require_length(const ShardInfo& s) {
  if (const auto p = fault_of_length(s.path, s.bytes)) throw InputError(*p);
}

/// Cached listing of the shard folders. It avoids a system call for each file.
class Listing {
 public:
  explicit Listing(fs::path folder) : folder_(std::move(folder)) {}
  bool has(const fs::path& file) {
    const auto [names, is_new] = names_.try_emplace(file.parent_path().string());
    std::error_code none;
    if (is_new)
      for (const auto& entry : fs::directory_iterator(folder_ / file.parent_path(), none))
        names->second.insert(entry.path().filename().string());
    return names->second.contains(file.filename().string());
  }

 private:
  fs::path folder_;
  std::map<std::string, std::set<std::string>> names_;
};

}  // namespace

std::string dataset_hash(const std::vector<ShardInfo>& shards) {
  std::string all;
  for (const auto& s : shards) all += s.hash;
  return hex(XXH3_64bits(all.data(), all.size()));
}

ShardInfo info_of(const DatasetHeader& h, const ShardData& d, std::uint64_t first_row) {
  ShardInfo info;
  info.path = "shard " + std::to_string(d.attributes.shard) + " of " + h.name;
  info.shard = d.attributes.shard;
  info.rows = d.rows;
  info.first_row = first_row;
  info.hash = hex(shard_hash(d));
  info.config_hash = h.config_hash;
  info.shape = {d.rows, d.channels, d.samples, d.parameter_count};
  info.draws = d.draw_sample_id.size();
  info.outcomes = count_outcomes(d.draw_outcome, info.path);
  return info;
}

std::string header_text(const DatasetHeader& header) {
  try {
    return sealed_text(to_json(header).dump(1));
  } catch (const nlohmann::json::type_error& e) {
    throw InputError({"a name that is not UTF-8", "the config '" + header.name + "' or a file it names",
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
  throw InputError({"the header lacks the frequency and the fixed parameters",
                    (folder / "dataset.json").string(), "an older version of Swingbank generated the dataset",
                    "generate the dataset again in an empty folder"});
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
      throw InputError({"damaged dataset header", file.string(), "its checksum is wrong", kRestoreHeader});
    return header;
  } catch (const nlohmann::json::exception& e) {
    throw InputError({"damaged dataset header", file.string(), e.what(), kRestoreHeader});
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& e) {
    throw InputError({"unknown format of the dataset header", file.string(), e.what(),
                      "use the version of Swingbank that wrote it"});
  }
}

Dataset open_dataset(const fs::path& folder, bool allow_incomplete) {
  Dataset d;
  static_cast<DatasetHeader&>(d) = read_header(folder);
  d.path = folder;
  const auto manifest = read_manifest(folder);
  auto lines = manifest ? *manifest : read_journals(folder);
  std::ranges::sort(lines, {}, &JournalLine::shard);
  Problems problems;
  Listing listing(folder);
  for (const auto& l : lines) {
    if (l.shard >= d.shard_count()) {
      const Problem p = beyond(folder, l, d);
      problems.add(p.what, p.where, p.why, p.remedy);
    }
    if (!manifest && !listing.has(l.file))
      problems.add("missing shard", (folder / l.file).string(), "No such file or directory", kRepairDataset);
    d.shards.push_back(info_of(folder, l, d, d.rows));
    d.rows += l.rows;
    for (const auto& [name, count] : l.outcomes) d.outcomes[name] += count;
    for (const auto& [name, count] : l.operating_points) d.operating_points[name] += count;
  }
  d.complete = d.shards.size() == d.shard_count();
  if (!d.complete && !allow_incomplete)
    problems.add("incomplete dataset", folder.string(),
                 std::to_string(d.shards.size()) + " of " + std::to_string(d.shard_count()) + " shards exist",
                 kRemake);
  problems.raise();
  d.hash = dataset_hash(d.shards);
  return d;
}

ShardData read_checked(const ShardInfo& s) {
  const auto fail = [&](const std::string& what, const std::string& why) {
    throw InputError({what, s.path.string(), why, kRepairDataset});
  };
  require_length(s);
  // Check the hash before HDF5 opens the file, because HDF5 1.10 may crash on a damaged one.
  if (const std::string bytes = hash_of_file(s.path); bytes != s.file_hash)
    fail("changed shard", "the hash of its bytes is " + bytes + ", the journal records " + s.file_hash);
  ShardData data = read_shard(s.path, {}, &s.shape);
  if (data.attributes.config_hash != s.config_hash)
    fail("a shard of another config",
         "its config hash is " + data.attributes.config_hash + ", the dataset's " + s.config_hash);
  if (const auto draws = data.draw_sample_id.size(); draws != s.draws)
    fail("wrong number of draws",
         "it has " + std::to_string(draws) + ", the journal records " + std::to_string(s.draws));
  if (const auto outcomes = count_outcomes(data.draw_outcome, s.path); outcomes != s.outcomes)
    fail("wrong outcomes", "it has " + text_of(outcomes) + ", the journal records " + text_of(s.outcomes));
  if (const auto found = hex(shard_hash(data)); found != s.hash)
    fail("changed shard", "its hash is " + found + ", the journal records " + s.hash);
  return data;
}

std::optional<Problem> fault_of(const fs::path& folder, const JournalLine& line, const DatasetHeader& header,
                                bool deep) {
  if (auto p = fault_of_length(folder / line.file, line.bytes)) return p;
  if (line.shard >= header.shard_count()) return beyond(folder, line, header);
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

ShardData read_shard_apart(const ShardInfo& shard, const ShardFields& fields) {
  require_length(shard);
  ShardData data = read_shard_apart(shard.path, fields, &shard.shape);
  if (const std::string& found = data.attributes.config_hash; found != shard.config_hash)
    throw InputError({"a shard of another config", shard.path.string(),
                      "its config hash is " + found + ", the dataset's " + shard.config_hash,
                      kRepairDataset});
  return data;
}

void read_rows(const ShardInfo& shard, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const ShardFields& fields) {
  require_length(shard);
  read_rows(shard.path, first, count, out, shard.config_hash, fields, &shard.shape);
}

}  // namespace swingbank::mpi::store
