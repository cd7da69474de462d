#include "mpi/store/virtual_dataset.hpp"

#include <algorithm>
#include <array>

#include "base/durable.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "mpi/store/shard_layout.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVirtualFormat = "swingbank-virtual-1";
constexpr std::array kOfRows = {"/records", "/record_scale",   "/parameters",  "/sample_id",   "/generator",
                                "/fault",   "/largest_spread", "/angle_valid", "/machine_base"};
constexpr std::array kOfDraws = {"/draws/sample_id", "/draws/outcome", "/draws/redrawn"};

/// Returns the sources of one array, one for each shard with rows or draws.
std::vector<h5::File::Part> parts_of(const Dataset& d, const char* array, bool of_draws) {
  std::vector<h5::File::Part> parts;
  for (const ShardInfo& s : d.shards)
    if (const std::uint64_t count = of_draws ? s.draws : s.rows; count > 0)
      parts.push_back({fs::relative(s.path, d.path).string(), array, count});
  return parts;
}

}  // namespace

bool write_virtual_dataset(const Dataset& d) {
  if (d.rows == 0 || d.shards.size() > kMostVirtual) return false;
  const std::lock_guard guard(h5::lock());
  const fs::path file = d.path / kVirtualFile;
  const auto filled = std::ranges::find_if(d.shards, [](const ShardInfo& s) { return s.rows > 0; });
  const h5::File example = h5::File::open(filled->path);
  reserve(file, 0);
  h5::File f = h5::File::create(temporary_name(file));
  f.attribute("format", std::string(kVirtualFormat));
  f.attribute("dataset_hash", d.hash);
  f.attribute("config_hash", d.config_hash);
  f.attribute("rate", d.rate);
  f.attribute("machine_model", d.machine_model);
  f.attribute("channel_names", d.channel_names);
  f.attribute("channel_units", d.channel_units);
  f.attribute("parameter_names", d.parameter_names);
  f.attribute("parameter_units", d.parameter_units);
  f.attribute("parameter_low", d.parameter_low);
  f.attribute("parameter_high", d.parameter_high);
  for (const char* array : kOfRows)
    if (example.has(array)) f.create_virtual(array, example, parts_of(d, array, false));
  f.create_group("/draws");
  for (const char* array : kOfDraws)
    if (example.has(array)) f.create_virtual(array, example, parts_of(d, array, true));
  const ShardAxes axes{d.channel_names, d.parameter_names, d.samples, d.rate};
  lay_out_axes(f, axes);
  fill_axes(f, axes);
  f.close();
  publish(file);
  return true;
}

}  // namespace swingbank::mpi::store
