// swingbank verify: compares every shard of a dataset with journal and header, on all cores, without MPI.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <string>
#include <thread>

#include "base/progress.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "mpi/store/shard_check.hpp"
#include "mpi/store/summary.hpp"

namespace swingbank::jobs::verify_command {
namespace {
namespace store = mpi::store;

void require_whole(const std::string& folder, const store::DatasetHeader& header, int processes,
                   Progress::Mode mode) {
  const auto lines = store::read_journals(folder);
  Progress progress(mode, "shards", lines.size(), 0);
  Problems problems;
  for (const auto& [shard, p] : store::bad_shards(folder, header, lines, processes, [&] { progress.add(1); }))
    problems.add(p.what, p.where, p.why, p.remedy);
  progress.finish();
  problems.raise();
}

int run(const std::string& folder, int processes, Progress::Mode mode) {
  require_whole(folder, store::read_header(folder), processes, mode);
  const store::Dataset dataset = store::open_dataset(folder, true);
  fmt::print("{}{}every shard agrees with its journal\n", store::describe(dataset),
             store::describe_attempts(folder));
  return dataset.complete ? 0 : kSubmitAgain;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("verify"));
  spdlog::set_pattern("%H:%M:%S %^%l%$ %v");
  line.describe(
      "Reads every shard of a dataset and compares it with journal and header: hash, shapes, rows, outcomes.\n"
      "  swingbank verify data/gencls\n"
      "Exit codes: 0 complete and correct, 1 a shard is damaged, 2 all existing shards are correct but\n"
      "some are missing.");
  std::string folder;
  int processes = static_cast<int>(std::max(1U, std::thread::hardware_concurrency())), mode = 0;
  line.add("folder", folder, "the dataset's folder").required();
  line.add("--processes", processes, "number of processes that read shards (default: one per core)")
      .positive();
  line.add_choice("--progress", mode, Progress::words(), "auto, bar, lines or none");
  if (!line.parse(argc, argv)) return line.end();
  return run(folder, processes, static_cast<Progress::Mode>(mode));
}

}  // namespace swingbank::jobs::verify_command
