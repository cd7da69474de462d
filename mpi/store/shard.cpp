#include "mpi/store/shard.hpp"

#include <xxhash.h>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "mpi/store/quantise.hpp"
#include "mpi/store/shard_apart.hpp"
#include "mpi/store/shard_layout.hpp"
#include "sim/core/trajectory.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

void bad_shard(const fs::path& file, const std::string& what, const std::string& why) {
  throw InputError({what, file.string(), why, kRepairDataset});
}

ShardAttributes read_attributes(const h5::File& f, const fs::path& file) {
  const std::string format = f.text_attribute("format");
  if (format != kShardFormat && format != kInt16Format)
    bad_shard(file, "not a shard of this version",
              "format is \"" + format + "\", not \"" + kShardFormat + "\" or \"" + kInt16Format + "\"");
  ShardAttributes a;
  a.int16 = format == kInt16Format;
  a.config_hash = f.text_attribute("config_hash");
  a.kernel = f.text_attribute("kernel");
  a.software = f.text_attribute("software");
  a.seed = f.integer_attribute("seed");
  a.shard = f.integer_attribute("shard");
  a.rate = f.real_attribute("rate");
  a.machine_model = f.text_attribute("machine_model");
  a.channel_names = f.texts_attribute("channel_names");
  a.channel_units = f.texts_attribute("channel_units");
  a.parameter_names = f.texts_attribute("parameter_names");
  a.parameter_units = f.texts_attribute("parameter_units");
  a.parameter_low = f.reals_attribute("parameter_low");
  a.parameter_high = f.reals_attribute("parameter_high");
  if (f.has_attribute("parameter_effects")) a.parameter_effects = f.texts_attribute("parameter_effects");
  a.operating_points = f.has("/machine_base");
  return a;
}

std::string text_of(const h5::Shape& shape) {
  std::string text;
  for (const auto n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text.empty() ? "a scalar" : text;
}

void require_array(const h5::File& f, const fs::path& file, const char* name, const h5::Shape& expected) {
  if (const auto found = f.shape(name); found != expected)
    bad_shard(file, std::string("wrong shape of ") + name,
              "it is " + text_of(found) + ", not " + text_of(expected));
}

/// Reads the shape of a shard. Throws InputError if its arrays disagree with each other or with the dataset.
void read_shape(const h5::File& f, const fs::path& file, const ShardShape* dataset, RowBlock& out) {
  const auto records = f.shape("/records"), parameters = f.shape("/parameters");
  if (records.size() != 3 || parameters.size() != 2 || parameters[0] != records[0])
    bad_shard(file, "inconsistent shapes",
              "/records must be rows x channels x samples and /parameters rows x parameters");
  if (dataset != nullptr) {
    require_array(f, file, "/records", {dataset->rows, dataset->channels, dataset->samples});
    require_array(f, file, "/parameters", {dataset->rows, dataset->parameters});
  }
  for (const char* name : {"/sample_id", "/generator", "/largest_spread"})
    require_array(f, file, name, {records[0]});
  require_array(f, file, "/fault", {records[0], kFaultColumns});
  if (f.has("/angle_valid")) require_array(f, file, "/angle_valid", {records[0], records[2]});
  if (f.has("/machine_base")) require_array(f, file, "/machine_base", {records[0]});
  if (f.has("/record_scale"))
    require_array(f, file, "/record_scale", {records[0], records[1], kScaleColumns});
  out.channels = records[1];
  out.samples = records[2];
  out.parameter_count = parameters[1];
}

void read_block(const h5::File& f, std::uint64_t first, std::uint64_t count, const ShardFields& fields,
                RowBlock& out) {
  out.rows = count;
  out.records.clear();
  out.codes.clear();
  out.code_scale.clear();
  out.parameters.clear();
  out.angle_valid.clear();
  out.machine_base.clear();
  if (fields.records && f.has("/record_scale")) {
    f.read("/records", first, count, out.codes);
    f.read("/record_scale", first, count, out.code_scale);
    decode(out);
  } else if (fields.records) {
    f.read("/records", first, count, out.records);
  }
  if (fields.parameters) f.read("/parameters", first, count, out.parameters);
  f.read("/sample_id", first, count, out.sample_id);
  f.read("/generator", first, count, out.generator);
  f.read("/fault", first, count, out.fault);
  f.read("/largest_spread", first, count, out.largest_spread);
  if (fields.angle_valid && f.has("/angle_valid")) f.read("/angle_valid", first, count, out.angle_valid);
  if (f.has("/machine_base")) f.read("/machine_base", first, count, out.machine_base);
}

template <class T>
void feed(XXH3_state_t* state, const T* values, std::size_t count) {
  XXH3_64bits_update(state, values, count * sizeof(T));
}

struct HashState {
  XXH3_state_t* state = XXH3_createState();
  HashState() { XXH3_64bits_reset(state); }
  ~HashState() { XXH3_freeState(state); }
  HashState(const HashState&) = delete;
  HashState& operator=(const HashState&) = delete;
};

}  // namespace

std::string_view draw_outcome_name(std::uint8_t outcome) {
  return outcome == kRefused ? "refused" : sim::outcome_name(static_cast<sim::Outcome>(outcome));
}

namespace {

ShardData shard_of(const h5::File& f, const fs::path& file, const ShardFields& fields,
                   const ShardShape* shape) {
  ShardData data;
  data.attributes = read_attributes(f, file);
  read_shape(f, file, shape, data);
  read_block(f, 0, f.shape("/records")[0], fields, data);
  if (fields.draws) {
    const auto ids = f.shape("/draws/sample_id");
    if (ids.size() != 1) bad_shard(file, "wrong shape of /draws/sample_id", "it is " + text_of(ids));
    require_array(f, file, "/draws/outcome", ids);
    f.read("/draws/sample_id", data.draw_sample_id);
    f.read("/draws/outcome", data.draw_outcome);
    if (data.attributes.operating_points) {
      require_array(f, file, "/draws/redrawn", {ids[0], kRedrawnColumns});
      f.read("/draws/redrawn", data.draw_redrawn);
    }
  }
  return data;
}

}  // namespace

ShardData read_shard(const fs::path& file, const ShardFields& fields, const ShardShape* shape) {
  const std::lock_guard guard(h5::lock());
  return shard_of(h5::File::open(file), file, fields, shape);
}

ShardData read_shard_apart(const fs::path& file, const ShardFields& fields, const ShardShape* shape) {
  std::vector<std::string> names{"text@format",        "text@config_hash",     "text@kernel",
                                 "text@software",      "integer@seed",         "integer@shard",
                                 "real@rate",          "text@machine_model",   "text@channel_names",
                                 "text@channel_units", "text@parameter_names", "text@parameter_units",
                                 "real@parameter_low", "real@parameter_high",  "text@parameter_effects"};
  // Requested arrays, each with its type in a shard. The reading process also returns their shapes.
  for (const char* array : {"/records", "f4/record_scale", "f8/parameters", "u8/sample_id", "i4/generator",
                            "f8/fault", "f8/largest_spread", "u1/angle_valid", "f8/machine_base"})
    names.emplace_back(array);
  if (fields.draws)
    for (const char* array : {"u8/draws/sample_id", "u1/draws/outcome", "i4/draws/redrawn"})
      names.emplace_back(array);
  return shard_of(h5::File::open_apart(file, names), file, fields, shape);
}

void read_rows(const fs::path& file, std::uint64_t first, std::uint64_t count, RowBlock& out,
               const std::string& config_hash, const ShardFields& fields, const ShardShape* shape) {
  const std::lock_guard guard(h5::lock());
  const h5::File f = h5::File::open(file);
  if (!config_hash.empty()) {
    const std::string found = f.text_attribute("config_hash");
    if (found != config_hash)
      bad_shard(file, "a shard of another config",
                "its config hash is " + found + ", the dataset's " + config_hash);
  }
  read_shape(f, file, shape, out);
  read_block(f, first, count, fields, out);
}

void write_shard(const fs::path& file, const ShardData& data) {
  const std::lock_guard guard(h5::lock());
  make_folder(file.parent_path());
  const fs::path temporary = temporary_name(file);
  reserve(file, 0);
  try {
    h5::File f = h5::File::create(temporary);
    lay_out_shard(f, data, {data.rows, data.draw_sample_id.size()});
    fill_shard(f, data, 0, 0);
    f.close();
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  publish(file);
}

std::vector<std::uint64_t> row_hashes(const RowBlock& b) {
  std::vector<std::uint64_t> hashes(b.rows);
  const HashState h;
  const std::size_t record = b.channels * b.samples;
  for (std::size_t i = 0; i < b.rows; ++i) {
    XXH3_64bits_reset(h.state);
    feed(h.state, &b.sample_id[i], 1);
    feed(h.state, &b.generator[i], 1);
    feed(h.state, b.parameters.data() + i * b.parameter_count, b.parameter_count);
    feed(h.state, b.fault.data() + i * kFaultColumns, kFaultColumns);
    feed(h.state, &b.largest_spread[i], 1);
    if (!b.angle_valid.empty()) feed(h.state, b.angle_valid.data() + i * b.samples, b.samples);
    if (!b.machine_base.empty()) feed(h.state, &b.machine_base[i], 1);
    feed(h.state, b.records.data() + i * record, record);
    hashes[i] = XXH3_64bits_digest(h.state);
  }
  return hashes;
}

std::uint64_t shard_hash(const std::vector<std::uint64_t>& rows,
                         const std::vector<std::uint64_t>& draw_sample_id,
                         const std::vector<std::uint8_t>& draw_outcome,
                         const std::vector<std::int32_t>& draw_redrawn) {
  const HashState h;
  feed(h.state, rows.data(), rows.size());
  feed(h.state, draw_sample_id.data(), draw_sample_id.size());
  feed(h.state, draw_outcome.data(), draw_outcome.size());
  feed(h.state, draw_redrawn.data(), draw_redrawn.size());
  return XXH3_64bits_digest(h.state);
}

std::uint64_t shard_hash(const ShardData& data) {
  return shard_hash(row_hashes(data), data.draw_sample_id, data.draw_outcome, data.draw_redrawn);
}

std::map<std::string, std::uint64_t> count_outcomes(const std::vector<std::uint8_t>& draw_outcome,
                                                    const fs::path& file) {
  std::map<std::string, std::uint64_t> counts;
  for (const auto outcome : draw_outcome) {
    if (outcome > kRefused)
      bad_shard(file, "outcome " + std::to_string(outcome) + " in /draws/outcome",
                "outcomes are numbered up to " + std::to_string(kRefused));
    ++counts[std::string(draw_outcome_name(outcome))];
  }
  return counts;
}

}  // namespace swingbank::mpi::store
