// swingbank merge: merges partial datasets generated on machines without a shared file system.
#include "mpi/store/merge.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "mpi/store/summary.hpp"

namespace swingbank::jobs::merge_command {
namespace {
namespace store = mpi::store;

/// Throws InputError with every folder that does not exist.
void require_folders(const std::vector<std::filesystem::path>& folders) {
  Problems problems;
  for (const auto& folder : folders)
    if (std::error_code none; !std::filesystem::is_directory(folder, none))
      problems.add("no dataset", folder.string(), "the folder does not exist",
                   "give a folder that `swingbank generate` wrote");
  problems.raise();
}

int run(const std::vector<std::string>& from, const std::string& into, Progress::Mode mode) {
  catch_stop_signals();
  const std::vector<std::filesystem::path> folders(from.begin(), from.end());
  require_folders(folders);
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
      "Merges partial datasets of one config, generated on machines without a shared file system, into one folder.\n"
      "  swingbank merge node1/data node2/data node3/data --out data\n"
      "Copies each shard and verifies it against its journal. An interrupted merge resumes when the command is "
      "repeated.\n"
      "Exit codes: 0 all shards are present, 1 invalid folder or shard, 2 shards are missing.");
  std::vector<std::string> from;
  std::string into;
  int mode = 0;
  line.add("folders", from, "folders of the partial datasets").required();
  line.add("--out", into, "output folder: new, empty, or a partial merge of the same config").required();
  line.add_choice("--progress", mode, Progress::words(), "auto, bar, lines or none");
  if (!line.parse(argc, argv)) return line.end();
  return run(from, into, static_cast<Progress::Mode>(mode));
}

}  // namespace swingbank::jobs::merge_command
