#include "jobs/fleet_run.hpp"

#include <sys/wait.h>

#include <chrono>
#include <cstring>
#include <memory>

#include "base/child.hpp"
#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/own_command.hpp"
#include "base/run_lock.hpp"
#include "base/stop_signal.hpp"
#include "base/write_file.hpp"
#include "jobs/guarded.hpp"
#include "jobs/item_progress.hpp"
#include "validate/fleet/report.hpp"

namespace swingbank::jobs {
namespace {

namespace fs = std::filesystem;
using namespace validate;

constexpr double kLongerThanItsProgram = 60.0;  ///< rank's time limit per plant minus --plant-timeout [s]

std::unique_ptr<RunLock> lock_folder(const fs::path& folder) {
  make_folder(folder);
  return std::make_unique<RunLock>(
      folder / ".lock", LockWords{"folder in use", folder.string(), "wait for it, or give another --out"},
      std::chrono::milliseconds(0));
}

/// Diagnoses a plant in a child process (swingbank diagnose --plant). Returns its JSON output, or a row with
/// the verdict "failed" if the process gives none.
std::string plant_result(const FleetCommand& c, const fleet::FleetPlant& plant, int threads) {
  const auto failed = [&](const std::string& why) {
    return nlohmann::json{{"was_there", false}, {"row", fleet::row_json(fleet::failed_row(plant.name, why))}}
        .dump();
  };
  try {
    const std::string program = own_command("diagnose", "install all parts of Swingbank").string();
    const ProgramEnd e = run_program(program,
                                     {program, "--fleet", c.fleet, "--plant", plant.name, "--out", c.out,
                                      "--threads", std::to_string(threads)},
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

int write_reports(const FleetCommand& c, const fleet::Fleet& fleet, std::vector<fleet::FleetRow> rows) {
  fleet::sort_worst_first(rows);
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

void declare_fleet(CommandLine& line, FleetCommand& c) {
  line.add("--fleet", c.fleet, "fleet file (configs/fleet/README.md)").required();
  line.add("--out", c.out, "folder for the table and a folder per plant").required();
  line.add("--threads", c.threads,
           "threads for one plant; 0: one per core (default: 0, or 1 if several ranks share "
           "the machine)")
      .between(0, 4096);
  line.add("--plant-timeout", c.limit, "time limit per plant [s]; 0: none").not_negative();
  line.add_flag("--json", c.json, "print the result as JSON instead of text");
}

std::vector<std::string> fleet_words(const FleetCommand& c) {
  std::vector<std::string> words = {"--fleet", c.fleet,           "--out",
                                    c.out,     "--plant-timeout", fmt::format("{}", c.limit)};
  if (c.threads >= 0) words.insert(words.end(), {"--threads", std::to_string(c.threads)});
  if (c.json) words.emplace_back("--json");
  return words;
}

int run_fleet(const FleetCommand& c, const mpi::items::Ranks& ranks) {
  const bool first = ranks.rank() == 0;
  catch_stop_signals();
  const int threads = c.threads >= 0 ? c.threads : ranks.on_this_machine() > 1 ? 1 : 0;
  fleet::Fleet fleet;
  std::unique_ptr<RunLock> lock;
  try {
    ranks.agree(c.fleet, [&] {
      fleet = fleet::load_fleet(c.fleet);
      if (first) lock = lock_folder(c.out);
    });
  } catch (const InputError& error) {  // the same on all ranks
    if (first) fmt::print(stderr, "{}\n", error.what());
    return 1;
  }

  std::vector<fleet::FleetRow> rows(fleet.plants.size());
  ItemProgress progress("plants", rows.size());
  mpi::items::SharedItems shared;
  for (std::size_t i = 0; i < rows.size(); ++i) shared.items.push_back(i);
  shared.work = [&](std::size_t i) { return plant_result(c, fleet.plants[i], threads); };
  shared.done = [&](std::size_t i, const std::string& result) {
    const auto j = nlohmann::json::parse(result);
    rows[i] = fleet::read_row(j.at("row").dump(), fleet.plants[i].name);
    progress.line(describe(rows[i], j.at("was_there")), j.at("was_there"));
  };
  shared.name = [&](std::size_t i) { return "plant " + fleet.plants[i].name; };
  shared.limit = c.limit > 0.0 ? c.limit + kLongerThanItsProgram : 0.0;
  if (!ranks.share_items(shared)) {
    if (first)
      fmt::print("stopped on a signal; finished plants are safe: run the same command again to continue\n");
    return kSubmitAgain;
  }
  int code = 0;
  if (first) code = guarded("diagnose", [&] { return write_reports(c, fleet, std::move(rows)); });
  return ranks.from_first(code);
}

}  // namespace swingbank::jobs
