// swingbank generate: simulates a dataset, on one rank or many, and continues where an earlier run ended.
#include "mpi/generate.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "mpi/session.hpp"
#include "mpi/stop_signal.hpp"
#include "mpi/store/shard_group.hpp"

namespace {
using namespace swingbank;

struct Command {
  std::string config, verify;
  Overrides overrides;
  GenerateOptions options;
};

const std::map<std::string, Progress::Mode> kModes = {{"auto", Progress::Mode::automatic},
                                                      {"bar", Progress::Mode::bar},
                                                      {"lines", Progress::Mode::lines},
                                                      {"none", Progress::Mode::none}};

void declare(CLI::App& app, Command& c) {
  app.description(
      "Simulates the dataset that a config describes into a folder of HDF5 shards (docs/formats.md).\n"
      "  swingbank generate configs/datasets/ieee39_gencls.toml --draws 4000 --out data/gencls\n"
      "  mpirun -np 8 swingbank generate ... on more cores: the data are the same to the last byte.\n"
      "Run again, it makes what is missing. SIGTERM, SIGUSR1 or Ctrl-C end it softly: exit code 2, "
      "run it again.");
  app.add_option("config", c.config, "the dataset's config (TOML)");
  app.add_option("--out", c.options.folder,
                 "dataset folder; new, empty, or an unfinished one of the same config");
  app.add_option("--draws", c.overrides.draws, "number of simulated events, instead of the config's")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", c.overrides.seed, "seed, instead of the config's")->check(CLI::NonNegativeNumber);
  app.add_option("--faults-per-point", c.overrides.faults_per_point,
                 "faults simulated for each databank point, instead of the config's")
      ->check(CLI::PositiveNumber);
  app.add_option("--draws-per-shard", c.overrides.draws_per_shard, "instead of the config's")
      ->check(CLI::PositiveNumber);
  app.add_option("--writer-ranks", c.options.writer_ranks,
                 "ranks that make and write a shard together (default 1)")
      ->check(CLI::PositiveNumber);
  app.add_option("--lease-timeout", c.options.lease_timeout,
                 "the run ends if a shard takes longer [s] (default 600; 0: never)")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--dedicated-master", c.options.dedicated_master, "rank 0 only leads; for many ranks");
  app.add_flag("--repair", c.options.repair, "check every shard there is and make bad ones anew");
  app.add_option("--progress", c.options.progress, "auto, bar, lines or none")
      ->transform(CLI::CheckedTransformer(kModes));
  app.add_option("--verify", c.verify, "only check this dataset folder: every shard's hash and config");
}

int verify(const std::string& folder) {
  const Dataset d = open_dataset(folder, true);
  verify_dataset(d);
  fmt::print("{}every shard is as it was written\n", describe(d));
  return d.complete ? 0 : kSubmitAgain;
}

int make(const Command& c) {
  DatasetConfig config;
  agree(MPI_COMM_WORLD, c.config, [&] {
    if (c.config.empty() || c.options.folder.empty())
      throw InputError({"nothing to do", "command line", "CONFIG and --out are needed, or --verify",
                        "see swingbank generate --help"});
    config = read_dataset_config(c.config, c.overrides);
  });
  return generate(config, c.options, MPI_COMM_WORLD);
}

int run(const Command& c, bool first) {
  if (!c.verify.empty()) return first ? verify(c.verify) : 0;
  catch_stop_signals();
  const int code = make(c);
  if (first) {
    fmt::print("{}", describe(open_dataset(c.options.folder, true)));
    if (code == kSubmitAgain)
      fmt::print("stopped on a signal; finished shards are safe: run the same command again to continue\n");
  }
  return code;
}
}  // namespace

int main(int argc, char** argv) {
  MpiSession session(&argc, &argv);
  const bool first = session.rank() == 0;
  spdlog::set_default_logger(spdlog::stderr_color_mt("generate"));
  spdlog::set_pattern("%H:%M:%S %^%l%$ %v");
  CLI::App app;
  Command command;
  declare(app, command);
  try {
    app.parse(argc, argv);
    return run(command, first);
  } catch (const CLI::ParseError& e) {
    return (first ? app.exit(e) : e.get_exit_code()) == 0 ? 0 : 1;
  } catch (const std::exception& e) {  // the same on all ranks, or MPI has ended the others
    if (first) fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
