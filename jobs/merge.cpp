// swingbank merge: joins datasets with some of the shards each, generated without a common disk.
#include "mpi/store/merge.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "mpi/store/summary.hpp"

namespace swingbank::jobs::merge_command {
namespace {
namespace store = mpi::store;

int run(const std::vector<std::string>& from, const std::string& into, Progress::Mode mode) {
  catch_stop_signals();
  const std::vector<std::filesystem::path> folders(from.begin(), from.end());
  std::uint64_t shards = 0;
  for (const auto& folder : folders) shards += store::read_journals(folder).size();
  Progress progress(mode, "shards", shards, 0);
  store::merge_datasets(folders, into, [&] { progress.add(1); });
  progress.finish();
  const store::Dataset dataset = store::open_dataset(into, true);
  fmt::print("{}", store::describe(dataset));
  return dataset.complete ? 0 : kSubmitAgain;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("merge"));
  spdlog::set_pattern("%H:%M:%S %^%l%$ %v");
  line.describe(
      "Joins datasets of one config, made in parts on machines that share no disk, into one folder.\n"
      "  swingbank merge node1/data node2/data node3/data --out data\n"
      "Each shard is copied and compared with its journal; killed, it goes on when run again.\n"
      "Exit codes: 0 all shards are there, 1 a folder or shard at fault, 2 shards are still missing.");
  std::vector<std::string> from;
  std::string into;
  int mode = 0;
  line.add("folders", from, "the datasets to join").required();
  line.add("--out", into, "folder of the whole; new, empty, or of the same config").required();
  line.add_choice("--progress", mode, Progress::words(), "auto, bar, lines or none");
  if (!line.parse(argc, argv)) return line.end();
  return run(from, into, static_cast<Progress::Mode>(mode));
}

}  // namespace swingbank::jobs::merge_command
