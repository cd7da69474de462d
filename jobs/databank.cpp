// swingbank databank: draws the parameter sets of a dataset's databank, writes them, and prints the
// percentage of candidates that was rejected for each reason.
#include "mpi/draw/databank.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>

#include "base/durable.hpp"
#include "base/inputs_kept.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "mpi/draw/databank_file.hpp"

namespace swingbank::jobs::databank_command {
namespace {
namespace fs = std::filesystem;

void write_csv(const fs::path& file, const mpi::draw::Databank& bank, const mpi::draw::DatasetConfig& c) {
  std::string text;
  for (const auto& b : c.box)
    text += fmt::format("{}{} [{}]", text.empty() ? "" : ",", c.name_of(b), c.record_of(b).unit);
  text += "\n";
  for (std::size_t i = 0; i < bank.points(); ++i)
    text += fmt::format("{}\n", fmt::join(bank.point(i), bank.point(i) + bank.dimensions, ","));
  write_text(file, text);
}

void report(const mpi::draw::Databank& bank, double seconds) {
  const auto share = [&](std::uint64_t n) {
    return 100.0 * static_cast<double>(n) / static_cast<double>(bank.candidates);
  };
  fmt::print("{} databank samples from {} candidates in {:.2f} s: {:.1f} % accepted\n", bank.points(),
             bank.candidates, seconds, share(bank.points()));
  for (const auto& [why, count] : bank.refused)
    fmt::print("  {:<28}{:>10} candidates  {:5.1f} %\n", why, count, share(count));
  fmt::print("  {:<28}{:>10} candidates  {:5.1f} %\n", "closer than the minimum", bank.too_close,
             share(bank.too_close));
}

int run(const std::string& config_file, const mpi::draw::Overrides& overrides, std::uint64_t points,
        const fs::path& out) {
  const mpi::draw::DatasetConfig config = mpi::draw::read_dataset_config(config_file, overrides);
  const mpi::draw::Study study = mpi::draw::load_study(config);
  if (!out.empty()) require_inputs_kept({{out, "--out"}});
  const auto extension = out.extension();
  if (!out.empty() && extension != ".csv" && extension != ".h5")
    throw InputError({"output format '" + extension.string() + "'", "--out " + out.string(),
                      "a databank is written as .csv or .h5", "end the name with one of these"});
  const auto start = std::chrono::steady_clock::now();
  const auto& base = study.grid.plants[static_cast<std::size_t>(study.plants[0])];
  catch_stop_signals();
  const mpi::draw::Databank bank =
      mpi::draw::draw_databank(config, base, points > 0 ? points : config.points());
  if (bank.points() < (points > 0 ? points : config.points())) {
    fmt::print(stderr,
               "stopped on a signal after {} databank samples: nothing was written; run the command again\n",
               bank.points());
    return kSubmitAgain;
  }
  report(bank, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (extension == ".csv") write_csv(out, bank, config);
  if (extension == ".h5") mpi::draw::write_databank(out, bank, config, base);
  if (!out.empty()) fmt::print("written to {}\n", out.string());
  return 0;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  line.describe(
      "Draws the databank of a dataset: parameter sets with a minimum mutual distance.\n"
      "  swingbank databank configs/datasets/ieee39_genrou.toml --points 60000 --out bank.h5");
  std::string config, out;
  mpi::draw::Overrides overrides;
  std::uint64_t points = 0;
  line.add("config", config, "the dataset's config (TOML)").required();
  line.add("--draws", overrides.draws,
           "number of events to simulate; determines the number of databank samples; overrides the config")
      .positive();
  line.add("--points", points,
           "number of databank samples; overrides the number that the config's draws determine")
      .positive();
  line.add("--seed", overrides.seed, "seed; overrides the config").not_negative();
  line.add("--out", out, "file to write: .csv or .h5");
  if (!line.parse(argc, argv)) return line.end();
  return run(config, overrides, points, out);
}

}  // namespace swingbank::jobs::databank_command
