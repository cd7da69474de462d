// swingbank databank: draws the points of a dataset's databank and writes them, with the shares of what was
// refused.
#include "mpi/draw/databank.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>

#include "base/durable.hpp"
#include "jobs/command_line.hpp"
#include "mpi/store/hdf5_file.hpp"

namespace {
using namespace swingbank;
namespace fs = std::filesystem;

struct Columns {
  std::vector<std::string> names, units, effects;
  std::vector<double> low, high;
};

Columns columns_of(const mpi::draw::DatasetConfig& c) {
  Columns all;
  for (const auto& b : c.box) {
    all.names.push_back(c.name_of(b));
    all.units.emplace_back(c.record_of(b).unit);
    all.effects.emplace_back(c.effect_of(b).name);
    all.low.push_back(b.low);
    all.high.push_back(b.high);
  }
  return all;
}

void write_csv(const fs::path& file, const mpi::draw::Databank& bank, const Columns& c) {
  std::string text;
  for (std::size_t i = 0; i < c.names.size(); ++i)
    text += fmt::format("{}{} [{}]", i == 0 ? "" : ",", c.names[i], c.units[i]);
  text += "\n";
  for (std::size_t i = 0; i < bank.points(); ++i)
    text += fmt::format("{}\n", fmt::join(bank.point(i), bank.point(i) + bank.dimensions, ","));
  write_text(file, text);
}

void write_hdf5(const fs::path& file, const mpi::draw::Databank& bank, const Columns& c,
                const mpi::draw::DatasetConfig& config) {
  reserve(file, bank.values.size() * sizeof(double));
  mpi::store::h5::File f = mpi::store::h5::File::create(temporary_name(file));
  f.attribute("format", std::string("swingbank-databank-1"));
  f.attribute("machine_model", config.model);
  f.attribute("seed", config.seed);
  f.attribute("parameter_names", c.names);
  f.attribute("parameter_units", c.units);
  f.attribute("parameter_low", c.low);
  f.attribute("parameter_high", c.high);
  if (!config.other_effects().empty()) f.attribute("parameter_effects", c.effects);
  f.create<double>("/parameters", {bank.points(), bank.dimensions});
  f.write("/parameters", 0, bank.points(), bank.values.data());
  f.close();
  publish(file);
}

void report(const mpi::draw::Databank& bank, double seconds) {
  const auto share = [&](std::uint64_t n) {
    return 100.0 * static_cast<double>(n) / static_cast<double>(bank.draws);
  };
  fmt::print("{} points from {} draws in {:.2f} s: {:.1f} % accepted\n", bank.points(), bank.draws, seconds,
             share(bank.points()));
  for (const auto& [why, count] : bank.refused)
    fmt::print("  {:<28}{:>10} draws  {:5.1f} %\n", why, count, share(count));
  fmt::print("  {:<28}{:>10} draws  {:5.1f} %\n", "too close to another point", bank.too_close,
             share(bank.too_close));
}

int run(const std::string& config_file, const mpi::draw::Overrides& overrides, std::uint64_t points,
        const fs::path& out) {
  const mpi::draw::DatasetConfig config = mpi::draw::read_dataset_config(config_file, overrides);
  const mpi::draw::Study study = mpi::draw::load_study(config);
  const auto extension = out.extension();
  if (!out.empty() && extension != ".csv" && extension != ".h5")
    throw InputError({"output format '" + extension.string() + "'", "--out " + out.string(),
                      "a databank is written as .csv or .h5", "end the name with one of these"});
  const auto start = std::chrono::steady_clock::now();
  const auto& base = study.grid.plants[static_cast<std::size_t>(study.plants[0])];
  const mpi::draw::Databank bank =
      mpi::draw::draw_databank(config, base, points > 0 ? points : config.points());
  report(bank, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (extension == ".csv") write_csv(out, bank, columns_of(config));
  if (extension == ".h5") write_hdf5(out, bank, columns_of(config), config);
  if (!out.empty()) fmt::print("written to {}\n", out.string());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  jobs::CommandLine line(
      "Draws the databank of a dataset: parameters that keep a distance from one another.\n"
      "  swingbank databank configs/datasets/ieee39_genrou.toml --points 60000 --out bank.h5",
      "swingbank databank");
  std::string config, out;
  mpi::draw::Overrides overrides;
  std::uint64_t points = 0;
  line.add("config", config, "the dataset's config (TOML)").required();
  line.add("--points", points, "number of points, instead of what the config's draws need").positive();
  line.add("--seed", overrides.seed, "seed, instead of the config's").not_negative();
  line.add("--out", out, "file to write: .csv or .h5");
  if (!line.parse(argc, argv)) return line.end();
  try {
    return run(config, overrides, points, out);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
