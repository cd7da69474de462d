// swingbank generate: simulates a dataset on one or more ranks, and continues an earlier run.
#include "mpi/ranks/generate.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "base/durable.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "jobs/software.hpp"
#include "mpi/draw/card.hpp"
#include "mpi/draw/shard_maker.hpp"
#include "mpi/ranks/session.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/summary.hpp"

namespace swingbank::jobs::generate_command {
namespace {

struct Command {
  std::string config, part, again;
  int mode = 0;  ///< --progress, as an index into Progress::words()
  mpi::draw::Overrides overrides;
  mpi::ranks::GenerateOptions options;
};

void declare(jobs::CommandLine& line, Command& c) {
  line.add("config", c.config, "the dataset's config (TOML)");
  line.add("--out", c.options.folder, "dataset folder; new, empty, or an unfinished one of the same config");
  line.add("--again", c.again,
           "a card.json, or a dataset's folder, instead of CONFIG: generates the same dataset again");
  line.add("--draws", c.overrides.draws, "number of simulated events, instead of the config's").positive();
  line.add("--seed", c.overrides.seed, "seed, instead of the config's").not_negative();
  line.add("--faults-per-point", c.overrides.faults_per_point,
           "faults simulated for each databank point, instead of the config's")
      .positive();
  line.add("--draws-per-shard", c.overrides.draws_per_shard,
           "number of events per shard, instead of the config's")
      .positive();
  line.add("--shard-megabytes", c.overrides.shard_megabytes, "size of a shard [MB], instead of the config's");
  line.add("--channels", c.overrides.channels, "channels to record, a subset of the config's");
  line.add("--rate", c.overrides.rate, "samples per second, instead of the config's");
  line.add_flag(
      "--int16", c.overrides.int16,
      "records as 16-bit numbers: half the bytes, with an error of at most 0.00076 % of a channel's range in its row");
  line.add("--writer-ranks", c.options.writer_ranks,
           "number of ranks that simulate and write one shard together (default 1)")
      .positive();
  line.add("--lease-timeout", c.options.lease_timeout,
           "time limit of a shard [s]; the run ends if one takes longer (default 600; 0: no limit)")
      .not_negative();
  line.add_flag("--dedicated-master", c.options.dedicated_master,
                "rank 0 only assigns shards and simulates none (always with 32 ranks or more)");
  const jobs::Option part =
      line.add("--part", c.part,
               "k/n: generate only the k-th of n parts of the shards; other runs generate the others");
  line.add("--databank", c.options.databank,
           "databank (.h5) that `swingbank databank` drew from this config");
  const jobs::Option repair = line.add_flag("--repair", c.options.repair,
                                            "check every existing shard and generate damaged ones again");
  repair.excludes(part);
  line.add_flag(
          "--trust", c.options.trust,
          "continue without reading existing shards (reading takes 0.15 s for 268 MB on one rank): only their lengths are "
          "checked, or the manifest alone if the dataset is complete")
      .excludes(repair);
  line.add_choice("--progress", c.mode, Progress::words(), "auto, bar, lines or none");
}

int describe_to(bool first, const std::filesystem::path& folder, const char* more) {
  bool complete = false;
  mpi::ranks::agree(MPI_COMM_WORLD, folder.string(), [&] {
    if (!first) return;
    const mpi::store::Dataset d = mpi::store::open_dataset(folder, true);
    fmt::print("{}{}", mpi::store::describe(d), more);
    complete = d.complete;
    if (complete && d.rows == 0)
      throw InputError({"a dataset without rows", folder.string(),
                        "all simulated events were unstable or failed; the list above counts how they ended",
                        "play one of them with swingbank simulate, or give a config of milder events"});
  });
  return complete || !first ? 0 : kSubmitAgain;
}

/// Parses "k/n"; an empty text means all shards. Throws InputError if it is invalid.
mpi::store::Part part_of(const std::string& text) {
  mpi::store::Part part;
  if (text.empty()) return part;
  const char *at = text.data(), *end = at + text.size();
  const auto number = std::from_chars(at, end, part.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto of = slash ? std::from_chars(number.ptr + 1, end, part.of) : number;
  if (!slash || of.ec != std::errc{} || of.ptr != end || part.number < 1 || part.number > part.of)
    throw InputError(
        {"'" + text + "'", "--part", "it is not of the form k/n with 1 <= k <= n", "write for example 3/16"});
  return part;
}

/// Temporary folder with the config and input files of a dataset card (mpi/draw/card.hpp). Each rank has its
/// own.
class Unpacked {
 public:
  explicit Unpacked(const mpi::draw::Card& card) {
    std::string name = (std::filesystem::temp_directory_path() / "swingbank-card-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) raise_file_error(name, errno, "cannot unpack the card");
    folder_ = name;
    config = mpi::draw::unpack(card, folder_);
  }
  ~Unpacked() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;
  std::filesystem::path config;

 private:
  std::filesystem::path folder_;
};

/// Throws InputError if config hash or kernel variant differ from those of the card, because the dataset
/// would then differ too.
void require_card_kept(const mpi::draw::Card& card, const mpi::draw::DatasetConfig& config) {
  const std::string kernel = mpi::draw::kernel_variant(mpi::draw::load_study(config));
  if (mpi::draw::config_hash(config, kernel) == card.config_hash) return;
  throw InputError(
      {"this machine or build cannot reproduce the dataset exactly", "--again",
       fmt::format("the card's kernel is {} and its config hash {}; here they are {} and {}", card.kernel,
                   card.config_hash, kernel, mpi::draw::config_hash(config, kernel)),
       "run it on such a processor with such a build; the card's made_by names both"});
}

int make(Command c) {
  std::optional<Unpacked> unpacked;
  mpi::draw::DatasetConfig config;
  mpi::ranks::agree(MPI_COMM_WORLD, c.config, [&] {
    if (!c.again.empty() && !c.config.empty())
      throw InputError({"CONFIG in addition", "--again", "the card contains the config", "leave CONFIG out"});
    if ((c.config.empty() && c.again.empty()) || c.options.folder.empty())
      throw InputError({"nothing to do", "command line", "CONFIG (or --again) and --out are needed",
                        "see swingbank generate --help"});
    c.options.part = part_of(c.part);
    c.options.software = std::string("swingbank ") + jobs::version() + ", commit " + jobs::commit();
    if (c.again.empty()) {
      config = mpi::draw::read_dataset_config(c.config, c.overrides);
      return;
    }
    const mpi::draw::Card card = mpi::draw::read_card(c.again);
    unpacked.emplace(card);
    config = mpi::draw::read_dataset_config(unpacked->config, card.overrides);
    require_card_kept(card, config);
  });
  return mpi::ranks::generate(config, c.options, MPI_COMM_WORLD);
}

int run(const Command& c, bool first) {
  catch_stop_signals();
  const int code = make(c);
  const bool stopped = code == kSubmitAgain;
  describe_to(first, c.options.folder,
              stopped
                  ? "stopped on a signal; finished shards are safe: run the same command again to continue\n"
                  : "");
  return code;
}

/// Parses the command line on all ranks, whose arguments may differ. If any rank was asked for help or has an
/// invalid option, returns the exit code, the same on all ranks. Otherwise returns nothing.
std::optional<int> parse(jobs::CommandLine& line, int argc, char** argv,
                         const mpi::ranks::MpiSession& session) {
  const bool works = line.parse(argc, argv);
  int ends = works ? session.size() : session.rank(), first = ends;
  MPI_Allreduce(&ends, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (first == session.size()) return std::nullopt;
  int code = first == session.rank() ? line.end() : 0;
  MPI_Bcast(&code, 1, MPI_INT, first, MPI_COMM_WORLD);
  return code;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  mpi::ranks::MpiSession session(&argc, &argv);
  const bool first = session.rank() == 0;
  spdlog::set_default_logger(spdlog::stderr_color_mt("generate"));
  spdlog::set_pattern("%H:%M:%S %^%l%$ %v");
  line.describe(
      "Simulates the dataset that a config describes into a folder of HDF5 shards (docs/reference/formats.md).\n"
      "  swingbank generate configs/datasets/ieee39_gencls.toml --draws 4000 --out data/gencls\n"
      "  mpirun -np 8 swingbank generate ... on more cores: the data are the same to the last byte.\n"
      "  swingbank generate ... --part 3/16 in a job array without MPI; with all parts generated, the bytes are the same.\n"
      "A repeated run generates the missing shards. SIGTERM, SIGUSR1 or Ctrl-C stop it with exit "
      "code 2; run it again to continue.");
  Command command;
  declare(line, command);
  return mpi::ranks::run_on_all_ranks(session, [&] {
    const auto ended = parse(line, argc, argv, session);
    if (ended) return *ended;
    command.options.progress = static_cast<Progress::Mode>(command.mode);
    return run(command, first);
  });
}

}  // namespace swingbank::jobs::generate_command
