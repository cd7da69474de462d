#include "mpi/ranks/generate.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <span>

#include "base/stop_signal.hpp"
#include "mpi/draw/card.hpp"
#include "mpi/draw/databank.hpp"
#include "mpi/draw/databank_file.hpp"
#include "mpi/draw/dataset_header.hpp"
#include "mpi/ranks/detail/master.hpp"
#include "mpi/ranks/detail/provenance.hpp"
#include "mpi/ranks/detail/run_folder.hpp"
#include "mpi/ranks/detail/shard_audit.hpp"
#include "mpi/ranks/detail/worker.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/attempts.hpp"
#include "mpi/store/manifest.hpp"

namespace swingbank::mpi::ranks {

namespace fs = std::filesystem;

namespace {

/// Smallest number of ranks for which rank 0 only schedules. A simulating rank 0 cannot reply while it writes
/// a shard.
constexpr int kLedFrom = 32;

/// Throws InputError if a rank has another config or another variant of the SIMD kernel than rank 0.
void require_one_variant(MPI_Comm world, const std::string& hash, const std::string& kernel) {
  int rank;
  MPI_Comm_rank(world, &rank);
  char mine[160] = {}, first[160] = {};
  fmt::format_to_n(mine, sizeof mine - 1, "config {}, kernel {}", hash, kernel);
  std::copy_n(mine, sizeof mine, first);
  MPI_Bcast(first, sizeof first, MPI_CHAR, 0, world);
  agree(world, "start", [&] {
    if (std::string(mine) != first)
      throw InputError({"ranks with different configs or builds", fmt::format("rank {}", rank),
                        fmt::format("it has {}, rank 0 has {}", mine, first),
                        "start the same build with the same config on every node, or a build for the common "
                        "instruction set (preset portable)"});
  });
}

void allocate_values(std::vector<double>& values, std::size_t count, int rank) {
  try {
    values.resize(count);
  } catch (const std::bad_alloc&) {
    throw InputError({"too little memory for the databank", fmt::format("rank {}", rank),
                      fmt::format("every rank holds all of it, {:.1f} MB",
                                  static_cast<double>(count * sizeof(double)) * 1e-6),
                      "start fewer ranks on a machine, ask for more memory, or lower `draws`"});
  }
}

/// Returns the databank, which rank 0 draws or reads and broadcasts; nothing after a stop signal. Collective.
std::optional<draw::Databank> shared_databank(const draw::Study& study, const fs::path& file,
                                              MPI_Comm world) {
  int rank;
  MPI_Comm_rank(world, &rank);
  draw::Databank bank;
  bank.dimensions = study.config.box.size();
  const auto& base = study.grid.plants[static_cast<std::size_t>(study.plants[0])];
  agree(world, "databank", [&] {  // allocate before the sampling, which may take long
    if (rank != 0) allocate_values(bank.values, study.config.points() * bank.dimensions, rank);
  });
  agree(world, "databank", [&] {
    if (rank != 0) return;
    const std::uint64_t points = study.config.points();
    bank = file.empty() ? draw::draw_databank(study.config, base, points)
                        : draw::read_databank(file, study.config, base, points);
  });
  int whole = rank != 0 || bank.points() >= study.config.points() ? 1 : 0;
  MPI_Bcast(&whole, 1, MPI_INT, 0, world);
  if (whole == 0) return std::nullopt;
  constexpr std::size_t piece = std::size_t{1} << 26;  // the count of MPI_Bcast is an int
  for (std::size_t at = 0; at < bank.values.size(); at += piece)
    MPI_Bcast(bank.values.data() + at, static_cast<int>(std::min(piece, bank.values.size() - at)), MPI_DOUBLE,
              0, world);
  return bank;
}

std::uint64_t draws_in(const std::deque<std::uint64_t>& shards, const draw::DatasetConfig& c) {
  std::uint64_t n = 0;
  for (const auto s : shards) n += std::min(c.draws_per_shard, c.draws - s * c.draws_per_shard);
  return n;
}

/// Sends a report to rank 0 and returns the next lease. For leaders other than rank 0.
Shards ask_master(MPI_Comm world, const Report& report, double timeout) {
  const std::string text = pack(report);
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, kReportTag, world);
  if (!wait_for(world, 0, kLeaseTag, timeout)) {
    fmt::print(stderr,
               "no reply from rank 0 for {:.0f} s (it hangs or has ended): the run ends; finished shards are "
               "safe, run the command again to continue\n",
               timeout);
    MPI_Abort(world, 1);
  }
  return receive_shards(world, 0);
}

/// Partition of the working ranks into groups of writers; a dedicated master belongs to none.
struct Groups {
  MPI_Comm mine = MPI_COMM_NULL;
  int count = 0;
  Groups(MPI_Comm world, int rank, int size, int writers, bool dedicated) {
    const int first = dedicated ? 1 : 0, workers = size - first;
    writers = std::min(writers, workers);
    count = (workers + writers - 1) / writers;
    MPI_Comm_split(world, rank < first ? MPI_UNDEFINED : (rank - first) / writers, rank, &mine);
  }
  ~Groups() {  // MPI_Comm_free is collective: no call while only this rank unwinds its stack
    if (mine != MPI_COMM_NULL && std::uncaught_exceptions() == 0) MPI_Comm_free(&mine);
  }
  Groups(const Groups&) = delete;
  Groups& operator=(const Groups&) = delete;
};

/// Runs the master on rank 0 and, unless the master is dedicated, a worker that polls the master between its
/// draws.
void lead(Worker* worker, Master& master, Progress& progress) {
  if (worker != nullptr) {
    std::uint64_t counted = 0;  // draws of the current shard that this rank has already displayed
    worker->exchange = [&](const Report& r) {
      for (const auto& line : r.finished) progress.add(line.draws - std::min(counted, line.draws));
      counted = 0;
      return master.exchange(r);
    };
    worker->tick = [&](std::uint64_t n) {
      counted += n;
      progress.add(n);
      master.poll();
    };
    worker->run();
  }
  master.serve_to_the_end();
}

}  // namespace

int generate(const draw::DatasetConfig& config, const GenerateOptions& o, MPI_Comm world) {
  int rank, size;
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &size);
  std::optional<draw::Study> loaded;
  std::string kernel, hash;
  store::ShardAttributes attributes;
  store::DatasetHeader header;
  agree(world, config.file.string(), [&] {
    loaded = draw::load_study(config);
    kernel = draw::kernel_variant(*loaded);
    hash = draw::config_hash(config, kernel);
    attributes = draw::shard_attributes(*loaded, hash, kernel);
    header = draw::dataset_header(*loaded, attributes);
    store::header_text(header);  // throws on invalid names before the folder is changed
  });
  const draw::Study& study = *loaded;
  require_one_variant(world, hash, kernel);

  FolderLocks locks;  // declared first, so released last
  std::vector<store::JournalLine> lines;
  bool archive = false;
  agree(world, o.folder.string(), [&] {
    if (rank != 0) return;
    archive = is_archive(o.folder) && !o.repair;
    if (archive)
      require_same_config(o.folder, header);
    else
      locks = enter(o, header, [&] {
        if (!fs::exists(o.folder / "card.json"))
          draw::write_card(o.folder, draw::card_of(config, kernel, made_by(o.software)));
      });
    lines = journalled(o);
    // With --trust, the manifest of a complete dataset replaces the check of each file.
    if (o.trust && store::read_manifest(o.folder)) lines.clear();
  });
  const ShardAudit audit = audit_shards(world, o.folder, header, lines, o.repair || !o.trust);
  if (audit.stopped) return kSubmitAgain;

  std::optional<store::Journal> journal;
  std::optional<store::AttemptLog> attempt;  // rank 0 only; its destructor logs a failure
  std::deque<std::uint64_t> missing;
  agree(world, o.folder.string(), [&] {
    if (rank != 0) return;
    settle(o.folder, audit.bad, o.repair);
    missing = missing_shards(o, header);
    if (missing.empty() && !archive) finish(o);
    if (missing.empty()) return;
    journal.emplace(o.folder / o.part.journal_name());  // throws for an incomplete read-only dataset
    attempt.emplace(o.folder, attempt_of(o, size, lines.size(), audit.bad.size()));
    const auto left = draws_in(missing, config);
    spdlog::info("{}: {} of {} draws to make in {} shards, {} ranks, kernel {}, config {}", o.folder.string(),
                 left, config.draws, missing.size(), size, kernel, hash);
  });
  std::uint64_t to_make = missing.size();
  MPI_Bcast(&to_make, 1, MPI_UINT64_T, 0, world);
  if (to_make == 0) return 0;

  const std::optional<draw::Databank> bank = shared_databank(study, o.databank, world);
  if (!bank) {
    if (attempt) attempt->end("stopped");
    return kSubmitAgain;
  }
  if (attempt) attempt->add_property("databank", draw::values_hash(*bank));
  const Groups groups(world, rank, size, o.writer_ranks, o.dedicated_master ? size > 1 : size >= kLedFrom);
  draw::ShardMaker maker(study, *bank);
  Worker worker{study,
                maker,
                attributes,
                o.folder,
                groups.mine,
                [&](const Report& r) { return ask_master(world, r, o.lease_timeout); },
                [](std::uint64_t) {}};
  bool complete = true;
  Problems problems;
  if (rank == 0) {
    Progress progress(o.progress, "draws", config.draws, config.draws - draws_in(missing, config));
    const bool works = groups.mine != MPI_COMM_NULL;
    JournalKeeper keeper([&](std::span<const store::JournalLine> made) { journal->append(made); });
    Master master(world, keeper, progress, missing, groups.count - (works ? 1 : 0), o.lease_timeout);
    lead(works ? &worker : nullptr, master, progress);
    progress.finish();
    problems = master.problems();
    complete = master.all_made();
    const double spent = progress.seconds();
    spdlog::info("{:.0f} draws in {:.1f} s: {:.0f} draws/s", progress.rate() * spent, spent, progress.rate());
  } else {
    worker.run();
  }
  agree(world, o.folder.string(), [&] {
    problems.raise();
    if (rank == 0 && complete) finish(o);
    if (rank == 0) attempt->end(complete ? "made" : "stopped");
  });
  int done = complete ? 1 : 0;
  MPI_Bcast(&done, 1, MPI_INT, 0, world);
  return done != 0 ? 0 : kSubmitAgain;
}

}  // namespace swingbank::mpi::ranks
