// swingbank diagnose: names the component (effect) that a plant model lacks.
#include <fmt/format.h>
#include <sys/prctl.h>

#include <csignal>

#include "base/json.hpp"
#include "base/launcher.hpp"
#include "base/own_command.hpp"
#include "base/stop_signal.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "jobs/fleet_run.hpp"
#include "mpi/items/one_process.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/diagnose/text.hpp"
#include "validate/fleet_plant/fleet_plant.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::jobs::diagnose_command {
namespace {

using namespace validate;

constexpr const char *kPage = "report.html", *kResult = "diagnosis.json";

/// Writes the file of the user-defined model that the search found. Returns its path; empty if none was
/// found.
std::filesystem::path write_user_model(const diagnose::Diagnosis& d, OutputFolder& folder) {
  const user_model_search::UserModelFinding* user_model = d.user_models.found();
  if (!user_model) return {};
  const auto file = folder.file(user_model->judgement.hypothesis.name + ".toml");
  write_file(file, user_model->toml);
  return file;
}

/// Arguments of the command.
struct Command {
  jobs::AnalysisOptions of{"diagnosis"};
  std::string plant, line;
  bool thresholds = false;
  jobs::FleetCommand fleet;
};

int run(Command& c) {
  c.of.judging.read();
  plant::PlantModel model = c.of.load_model(true);
  const check::Preparing preparing = c.of.reading.apply(model, c.of.records);
  const check::RecordSet set = jobs::read_events(c.of.records, model, preparing);
  diagnose::DiagnoseOptions options;
  options.prior_sd = c.of.prior_sd;
  options.events = c.of.events();
  options.progress = jobs::progress_line(jobs::kDiagnosePlan);
  if (!jobs::quiet)
    options.preliminary_result = [](const std::string& sentence, const diagnose::Diagnosis&) {
      fmt::print(stderr, "\n{}\n", sentence);
    };
  c.of.open_results("diagnose", {kPage, kResult});
  const diagnose::Diagnosis d = diagnose::diagnose(model, set.records, options);
  const bool adequate = d.verdict == diagnose::Verdict::adequate;
  compare::CompareOptions playing = c.of.comparing();
  playing.progress = options.progress;
  const auto played = diagnose::play_models(model, d, c.of.judging.by, playing);
  OutputFolder& results = c.of.results();
  report::Provenance provenance = diagnose::diagnosis_provenance(model, d, c.line);
  for (std::size_t k = 0; k < set.records.size(); ++k) {
    const record::Record& r = set.records[k];
    if (const auto begins = record::beginning(r); !begins.empty())
      provenance.emplace_back("begins", r.name + ": t = 0 is " + begins);
    for (const auto& note : set.warnings[k]) provenance.emplace_back("note", r.name + ": " + note);
  }
  jobs::sign(provenance, c.of.judging, c.of.model, c.of.records);
  auto result = diagnose::diagnosis_json(model, d, provenance);
  result["records"] = jobs::records_json(set);
  result["fitness"] = compare::fitness_json(played);
  result["statistically_complete"] = adequate;
  const auto page = results.file(kPage);
  const auto user_model_file = write_user_model(d, results);
  write_file(results.file(kResult), json_text(result, 1) + "\n");
  write_file(page, diagnose::diagnosis_html(model, d, provenance, played));
  results.finish();
  if (c.of.json) {
    fmt::print("{}\n", json_text(result, 1));
  } else {
    fmt::print("{}{}\nreport: {}\n", compare::fitness_text(played),
               compare::complete_text(adequate, diagnose::diagnosis_text(d)), page.string());
    if (!user_model_file.empty())
      fmt::print("user-defined model: {0} (swingbank add {1} --user-model {0} adds it)\n",
                 user_model_file.string(), user_model_file.stem().string());
  }
  if (const std::string next = diagnose::next_command(d, provenance); !c.of.json && !next.empty())
    fmt::print("next: {}\n", next);
  c.of.judging.print(page);
  if (d.verdict == diagnose::Verdict::interrupted) return kSubmitAgain;
  return played.back().fitness.exit_code(adequate);
}

/// Diagnoses one plant of the fleet in this process. Prints JSON to standard output: whether an earlier run
/// had diagnosed the plant ("was_there"), and the plant's row of the table ("row").
int diagnose_fleet_plant(const jobs::FleetCommand& c, const std::string& name) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with its rank, so that it does not write during the next run
  catch_stop_signals();                // disables interruption points
  for (const int s : {SIGTERM, SIGINT, SIGUSR1}) std::signal(s, SIG_IGN);  // finishes despite a graceful stop
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
  const fleet_plant::FleetOutcome o = fleet_plant::diagnose_plant(fleet, *plant, c.out, options);
  fmt::print("{}\n", nlohmann::json{{"was_there", o.was_there}, {"row", fleet::row_json(o.row)}}.dump());
  return 0;
}

/// Diagnoses the fleet in this process or, under a launcher, by the program with MPI, which replaces this
/// process.
int diagnose_fleet(const jobs::FleetCommand& c) {
  if (!launched()) return jobs::run_fleet(c, mpi::items::OneProcess());
  try {
    const auto program = jobs::own_command(
        "diagnose-fleet", "install swingbank-train, or start the command without mpirun or srun");
    jobs::replace_by(program, jobs::fleet_words(c));
  } catch (const InputError& error) {  // the same on all ranks
    if (is_first_rank()) fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

int print_thresholds(bool json) {
  if (json)
    fmt::print("{}\n", json_text(thresholds::thresholds_json(), 1));
  else
    fmt::print("{}", diagnose::thresholds_text());
  return 0;
}

void declare(jobs::CommandLine& line, Command& c) {
  auto of_one_plant = c.of.declare(
      line,
      "report.html, diagnosis.json and the file of a user-defined model if one is found; with --fleet: "
      "fleet.html, fleet.json, fleet.csv and a folder per plant");
  for (const jobs::Option& option : c.of.declare_fit(line)) of_one_plant.push_back(option);
  line.group("Fleet");
  const jobs::Option fleet = line.add("--fleet", c.fleet.fleet,
                                      "instead of --model and --records: a fleet file, many plants with "
                                      "their records (configs/fleet/README.md); under mpirun each rank "
                                      "takes one plant at a time");
  line.add("--plant-timeout", c.fleet.limit,
           "time limit per plant [s]; a plant that takes longer counts as failed (default 3600; 0: none)")
      .not_negative();
  line.add("--plant", c.plant, "diagnose only this plant of the fleet; its result as JSON, no table")
      .needs(fleet);
  for (const jobs::Option& option : of_one_plant) option.excludes(fleet);
  line.group("Expert");
  line.add_flag("--thresholds", c.thresholds,
                "print every number on which a verdict depends, with unit and reason (with --json as JSON), "
                "and exit")
      .excludes(of_one_plant.front())
      .excludes(fleet);
  line.example("swingbank diagnose --model plant.toml --records fault1.csv fault2.csv --out diagnosis");
  line.footer(std::string(thresholds::kExitCodes) +
              " Complete: no component is missing. Fit for purpose: judged with refitted parameters. "
              "2: interrupted (Ctrl-C, SIGTERM); report and JSON contain the fits so far, without a "
              "verdict; a second Ctrl-C ends at once. Of a fleet: 0 all plants are complete, 3 some "
              "plant is not, 1 some plant failed, 2 stopped by a signal (run it again to continue).");
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Command c;
  declare(line, c);
  if (!line.parse(argc, argv)) return line.end();
  if (!c.thresholds && c.of.model.empty() && c.fleet.fleet.empty())
    return line.lacks("--model with --records, or --fleet,");
  c.line = jobs::command_line("diagnose", argc, argv);
  if (c.thresholds) return print_thresholds(c.of.json);
  c.fleet.out = c.of.out;
  c.fleet.json = c.of.json;
  c.fleet.threads = c.of.threads;
  if (!c.plant.empty()) return diagnose_fleet_plant(c.fleet, c.plant);
  if (!c.fleet.fleet.empty()) return diagnose_fleet(c.fleet);
  c.of.limit_threads();
  return run(c);
}

}  // namespace swingbank::jobs::diagnose_command
