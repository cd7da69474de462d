#include "mpi/draw/databank_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <numeric>

#include "base/durable.hpp"
#include "mpi/store/hdf5_file.hpp"

namespace swingbank::mpi::draw {

namespace {

constexpr const char* kFormat = "swingbank-databank-1";
constexpr const char* kDrawAnew = "run swingbank databank with this config again";

/// Returns the hash of everything that determines the samples, except their number.
std::string databank_hash(const DatasetConfig& c, const sim::plant::Plant& base) {
  std::string text = fmt::format("{} {} {} {:.17g} {}\n", c.model, c.seed,
                                 static_cast<int>(c.databank.policy), c.databank.distance, c.databank.scaled);
  for (const Box& b : c.box) text += fmt::format("{} {:.17g} {:.17g}\n", c.name_of(b), b.low, b.high);
  for (int block = sim::plant::kMachineBlock; block < sim::plant::first_measurement(base); ++block) {
    const auto& base_block = sim::plant::block_at(base, block);
    text += fmt::format("{} {:.17g}\n", base_block.effect->name, fmt::join(base_block.p, " "));
  }
  return hex(XXH3_64bits(text.data(), text.size()));
}

std::string hash_of(const std::vector<double>& values) {
  return hex(XXH3_64bits(values.data(), values.size() * sizeof(double)));
}

}  // namespace

std::string values_hash(const Databank& bank) { return hash_of(bank.values); }

void write_databank(const std::filesystem::path& file, const Databank& bank, const DatasetConfig& config,
                    const sim::plant::Plant& base) {
  std::vector<std::string> names, units, effects;
  std::vector<double> low, high;
  for (const Box& b : config.box) {
    names.push_back(config.name_of(b));
    units.emplace_back(config.record_of(b).unit);
    effects.emplace_back(config.effect_of(b).name);
    low.push_back(b.low);
    high.push_back(b.high);
  }
  std::vector<std::uint64_t> points(bank.points());
  std::iota(points.begin(), points.end(), 0);
  reserve(file, (bank.values.size() + points.size()) * sizeof(double));
  store::h5::File f = store::h5::File::create(temporary_name(file));
  f.attribute("format", std::string(kFormat));
  f.attribute("machine_model", config.model);
  f.attribute("seed", config.seed);
  f.attribute("databank_hash", databank_hash(config, base));
  f.attribute("values_hash", hash_of(bank.values));
  f.attribute("parameter_names", names);
  f.attribute("parameter_units", units);
  f.attribute("parameter_low", low);
  f.attribute("parameter_high", high);
  if (!config.other_effects().empty()) f.attribute("parameter_effects", effects);
  f.create<double>("/parameters", {bank.points(), bank.dimensions});
  f.create<std::uint64_t>("/point", {points.size()});
  f.create_labels("/parameter", names);
  f.describe("/parameters", "see parameter_units", "parameter values of the databank samples");
  f.describe("/point", "1", "number of the databank sample");
  f.describe("/parameter", "1", "name of the parameter");
  f.attach_scales({{"/parameters", {"/point", "/parameter"}}});
  f.write("/parameters", 0, bank.points(), bank.values.data());
  f.write("/point", 0, points.size(), points.data());
  f.write_labels("/parameter", names);
  f.close();
  publish(file);
}

Databank read_databank(const std::filesystem::path& file, const DatasetConfig& config,
                       const sim::plant::Plant& base, std::uint64_t points) {
  // Opens the file in a separate process, because HDF5 must read it before the checksums inside it can be
  // verified.
  const store::h5::File f = store::h5::File::open_apart(
      file, {"f8/parameters", "text@format", "text@databank_hash", "text@values_hash"});
  const auto refuse = [&](const std::string& what, const std::string& why) {
    throw InputError({what, file.string(), why, kDrawAnew});
  };
  if (!f.has_attribute("format") || f.text_attribute("format") != kFormat ||
      !f.has_attribute("databank_hash") || !f.has_attribute("values_hash"))
    refuse("not a databank file",
           std::string("it needs the format ") + kFormat + ", databank_hash and values_hash");
  if (f.text_attribute("databank_hash") != databank_hash(config, base))
    refuse("a databank of another config", "its parameter intervals, policy, distance, seed or plant differ");
  const auto shape = f.shape("/parameters");
  if (shape.size() != 2 || shape[1] != config.box.size())
    refuse("wrong shape of /parameters", "it must have one column per parameter of the config");
  if (shape[0] < points)
    refuse("too few databank samples", fmt::format("it has {}, the draws need {}", shape[0], points));
  Databank bank;
  bank.dimensions = config.box.size();
  f.read("/parameters", bank.values);
  if (hash_of(bank.values) != f.text_attribute("values_hash"))
    refuse("changed databank", "its checksum is wrong");
  bank.values.resize(points * bank.dimensions);
  return bank;
}

}  // namespace swingbank::mpi::draw
