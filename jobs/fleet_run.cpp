#include "jobs/fleet_run.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>

#include "base/child.hpp"
#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/run_lock.hpp"
#include "base/stop_signal.hpp"
#include "base/write_file.hpp"
#include "jobs/event_records.hpp"
#include "jobs/item_progress.hpp"
#include "mpi/ranks/item_queue.hpp"
#include "mpi/ranks/session.hpp"
#include "validate/fleet/report.hpp"

namespace swingbank::jobs {
namespace {

namespace fs = std::filesystem;
using namespace validate;

constexpr double kLongerThanItsProgram = 60.0;  ///< time from a plant's limit to that of its rank [s]

std::unique_ptr<RunLock> lock_folder(const fs::path& folder) {
  make_folder(folder);
  return std::make_unique<RunLock>(
      folder / ".lock", LockWords{"a second run", folder.string(), "wait for it, or give another --out"},
      std::chrono::milliseconds(0));
}

/// Runs run_fleet_plant in a child process. Returns its output, or a failed row if it has none.
std::string plant_result(const jobs::FleetCommand& c, const fleet::FleetPlant& plant, int threads) {
  const auto failed = [&](const std::string& why) {
    return nlohmann::json{{"was_there", false}, {"row", fleet::row_json(fleet::failed_row(plant.name, why))}}
        .dump();
  };
  try {
    const ProgramEnd e = run_program("/proc/self/exe",
                                     {"swingbank-diagnose", "--fleet", c.fleet, "--plant", plant.name,
                                      "--out", c.out, "--threads", std::to_string(threads)},
                                     {.output = ProgramRun::Output::taken, .limit = c.limit});
    if (e.late)
      return failed(
          fmt::format("The diagnosis took longer than {:g} s (--plant-timeout) and was ended.", c.limit));
    if (WIFSIGNALED(e.status))
      return failed(fmt::format("The diagnosis was ended by signal {} ({}).", WTERMSIG(e.status),
                                strsignal(WTERMSIG(e.status))));
    if (nlohmann::json::accept(e.output)) return e.output;
    return failed(fmt::format("The diagnosis ended with code {} and no result.", WEXITSTATUS(e.status)));
  } catch (const std::exception& error) {
    return failed(error.what());
  }
}

std::string describe(const fleet::FleetRow& row, bool was_there) {
  std::string text = row.plant + ": " + row.verdict;
  if (row.failed()) text += ": " + row.sentence.substr(0, row.sentence.find('\n'));
  for (const auto& effect : row.effects) text += " " + effect;
  return text + (was_there ? " (existed already)" : "");
}

int write_reports(const jobs::FleetCommand& c, const fleet::Fleet& fleet,
                  const std::vector<fleet::FleetRow>& rows) {
  const fs::path folder = c.out;
  const std::string json = fleet::fleet_json(fleet, rows);
  write_file(folder / "fleet.json", json);
  write_file(folder / "fleet.csv", fleet::fleet_csv(rows));
  write_file(folder / "fleet.html", fleet::fleet_html(fleet, rows));
  if (c.json)
    fmt::print("{}", json);
  else
    fmt::print("{}report: {}\n", fleet::fleet_text(rows), (folder / "fleet.html").string());
  return fleet::fleet_code(rows);
}

}  // namespace

int run_fleet_plant(const jobs::FleetCommand& c, const std::string& name) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with its rank, so that it cannot write during the next run
  catch_stop_signals();                // switches interruption points off
  for (const int s : {SIGTERM, SIGINT, SIGUSR1}) std::signal(s, SIG_IGN);  // finishes in a graceful stop
  const fleet::Fleet fleet = fleet::load_fleet(c.fleet);
  const auto plant = std::ranges::find(fleet.plants, name, &fleet::FleetPlant::name);
  if (plant == fleet.plants.end())
    throw InputError(
        {"no plant " + name, c.fleet, "the fleet has no [plant." + name + "]", "name one of its plants"});
  diagnose::DiagnoseOptions options;
  options.threads = std::max(c.threads, 0);
  options.progress = [line = jobs::progress_line(), &name](jobs::Phase phase, const std::string& item,
                                                           int done, int total) {
    line(phase, item.empty() ? name : name + ": " + item, done, total);
  };
  const fleet::FleetOutcome o = fleet::diagnose_plant(fleet, *plant, c.out, options);
  fmt::print("{}\n", nlohmann::json{{"was_there", o.was_there}, {"row", fleet::row_json(o.row)}}.dump());
  return 0;
}

int run_fleet(const jobs::FleetCommand& c, int* argc, char*** argv) {
  std::optional<mpi::ranks::MpiSession> session;
  if (mpi::ranks::MpiSession::launched()) session.emplace(argc, argv);
  const mpi::ranks::Ranks ranks{session ? MPI_COMM_WORLD : MPI_COMM_NULL};
  const bool first = ranks.rank() == 0;
  catch_stop_signals();
  const int threads = c.threads >= 0 ? c.threads : ranks.on_this_machine() > 1 ? 1 : 0;
  fleet::Fleet fleet;
  std::unique_ptr<RunLock> lock;
  try {
    mpi::ranks::agree(ranks, c.fleet, [&] {
      fleet = fleet::load_fleet(c.fleet);
      if (first) lock = lock_folder(c.out);
    });
  } catch (const InputError& error) {  // the same on all ranks
    if (first) fmt::print(stderr, "{}\n", error.what());
    return 1;
  }

  std::vector<fleet::FleetRow> rows(fleet.plants.size());
  jobs::ItemProgress progress("plants", rows.size());
  mpi::ranks::SharedItems shared;
  for (std::size_t i = 0; i < rows.size(); ++i) shared.items.push_back(i);
  shared.work = [&](std::size_t i) { return plant_result(c, fleet.plants[i], threads); };
  shared.done = [&](std::size_t i, const std::string& result) {
    const auto j = nlohmann::json::parse(result);
    rows[i] = fleet::read_row(j.at("row").dump(), fleet.plants[i].name);
    progress.line(describe(rows[i], j.at("was_there")), j.at("was_there"));
  };
  shared.name = [&](std::size_t i) { return "plant " + fleet.plants[i].name; };
  shared.limit = c.limit > 0.0 ? c.limit + kLongerThanItsProgram : 0.0;
  if (!mpi::ranks::share_items(ranks, shared)) {
    if (first)
      fmt::print("stopped on a signal; finished plants are safe: run the same command again to continue\n");
    return kSubmitAgain;
  }
  int code = 0;
  if (first) code = jobs::guarded("diagnose", [&] { return write_reports(c, fleet, rows); });
  return ranks.from_first(code);
}

}  // namespace swingbank::jobs
