// swingbank diagnose: which physical effect does the model of a plant lack?
#include <fmt/format.h>

#include "base/json.hpp"
#include "base/output_folder.hpp"
#include "base/stop_signal.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "jobs/fleet_run.hpp"
#include "jobs/verdict.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/diagnose/text.hpp"
#include "validate/thresholds/list.hpp"

namespace {

using namespace swingbank;
using namespace swingbank::validate;

constexpr const char *kPage = "report.html", *kResult = "diagnosis.json";

/// The law that was found, as a file; its path, empty where none was.
std::filesystem::path write_law(const diagnose::Diagnosis& d, OutputFolder& folder) {
  const laws::LawFinding* law = d.laws.found();
  if (!law) return {};
  const auto file = folder.file(law->judgement.hypothesis.name + ".toml");
  write_file(file, law->toml);
  return file;
}

int run(const std::string& model_file, const std::vector<std::string>& record_files, const std::string& out,
        bool json, const jobs::Reading& reading, jobs::Judging& judging, diagnose::DiagnoseOptions options,
        const std::string& command_line) {
  judging.read();
  plant::PlantModel model = jobs::load_model_to_fit(model_file);
  const check::Preparing preparing = reading.apply(model, record_files);
  const check::RecordSet set = jobs::read_events(record_files, model, preparing);
  options.progress = jobs::progress_line(jobs::kDiagnoseCourse);
  if (!jobs::quiet)
    options.told = [](const std::string& sentence) { fmt::print(stderr, "\n{}\n", sentence); };
  interruption_point();
  OutputFolder results(out, "diagnose", {kPage, kResult}, judging.outputs());
  const diagnose::Diagnosis d = diagnose::diagnose(model, set.records, options);
  const bool adequate = d.verdict == diagnose::Verdict::adequate;
  compare::CompareOptions playing;
  playing.progress = options.progress;
  const auto played = diagnose::play_models(model, d, judging.by, playing);
  catch_stop_signals();  // results are written even after a stop signal
  report::Provenance provenance = diagnose::diagnosis_provenance(model, d, command_line);
  for (std::size_t k = 0; k < set.records.size(); ++k) {
    const record::Record& r = set.records[k];
    if (const auto begins = record::beginning(r); !begins.empty())
      provenance.emplace_back("begins", r.name + ": t = 0 is " + begins);
    for (const auto& note : set.warnings[k]) provenance.emplace_back("note", r.name + ": " + note);
  }
  jobs::sign(provenance, judging, model_file, record_files);
  auto result = diagnose::diagnosis_json(model, d, provenance);
  result["records"] = jobs::records_json(set);
  result["fitness"] = compare::fitness_json(played);
  result["statistically_complete"] = adequate;
  const auto page = results.file(kPage);
  const auto law_file = write_law(d, results);
  write_file(results.file(kResult), json_text(result, 1) + "\n");
  write_file(page, diagnose::diagnosis_html(model, d, provenance, played));
  results.finish();
  if (json) {
    fmt::print("{}\n", json_text(result, 1));
  } else {
    fmt::print("{}{}\nreport: {}\n", compare::fitness_text(played),
               compare::complete_text(adequate, diagnose::diagnosis_text(d)), page.string());
    if (!law_file.empty())
      fmt::print("law: {0} (swingbank add {1} --law {0} adds it)\n", law_file.string(),
                 law_file.stem().string());
  }
  judging.print(page);
  if (d.verdict == diagnose::Verdict::interrupted) return kSubmitAgain;
  return played.back().fitness.exit_code(adequate);
}

/// What a person may ask for.
struct Command {
  std::string model, out = "diagnosis", plant;
  std::vector<std::string> records;
  bool thresholds = false;
  jobs::Reading reading;
  jobs::Judging judging;
  diagnose::DiagnoseOptions options;
  jobs::FleetCommand fleet;
};

int print_thresholds(bool json) {
  if (json)
    fmt::print("{}\n", json_text(thresholds::thresholds_json(), 1));
  else
    fmt::print("{}", diagnose::thresholds_text());
  return 0;
}

void declare(jobs::CommandLine& line, Command& c) {
  const jobs::Option model =
      line.add("--model", c.model, "plant file, with [[event]] for staged tests (configs/plants/README.md)");
  const jobs::Option records =
      line.add("--records,--record", c.records, "records of the events (validate/record/README.md)");
  model.needs(records);
  records.needs(model);
  c.reading.add_to(line);
  c.reading.add_component(line);
  const jobs::Option point = c.reading.add_point(line), switches = c.reading.add_switch(line);
  const jobs::Option fleet =
      line.add("--fleet", c.fleet.fleet,
               "instead of both: a fleet file, many plants with their records "
               "(configs/fleet/README.md); under mpirun each rank takes one plant at a time")
          .excludes(model)
          .excludes(point)
          .excludes(switches);
  line.add(
          "--plant-timeout", c.fleet.limit,
          "of a fleet: a plant's diagnosis that takes longer [s] is ended and counts as failed (default 3600; 0: none)")
      .not_negative();
  line.add("--plant", c.plant, "of the fleet only this plant; its result as JSON, no table").needs(fleet);
  line.add("--out", c.out,
           "folder for report.html, diagnosis.json and, where one is found, the law file; of a fleet "
           "for fleet.html, fleet.json, fleet.csv and "
           "a folder per plant")
      .shows_default();
  line.add("--spread", c.options.spread,
           "relative uncertainty believed of the model's parameters; of a fleet it stands in its file")
      .shows_default()
      .between(0.001, 2.0)
      .excludes(fleet);
  line.add("--threads", c.fleet.threads,
           "of one diagnosis; 0: one per core (default: that, or 1 where several ranks share the machine)")
      .between(0, 4096);
  line.add_flag_off(
          "--power-only", c.options.measured_states,
          "leave recorded speed, Efd and Ifd aside: compare P and Q only; of a fleet it stands in its file")
      .excludes(fleet);
  c.judging.add_to(line).excludes(fleet);
  line.add_flag("--json", c.fleet.json, "print the result as JSON instead of text");
  line.add_flag(
          "--thresholds", c.thresholds,
          "print every number on which a verdict hangs, with unit and reason (with --json as JSON), and end")
      .excludes(model)
      .excludes(fleet);
  line.footer(
      std::string(thresholds::kExitCodes) +
      " Complete is a structure that lacks nothing; fit for purpose, the model with its parameters refitted. 2: interrupted (Ctrl-C, SIGTERM); report and JSON hold what was fitted until then, and nothing is judged; a second Ctrl-C ends at once. Of a fleet: 0 all plants are complete, 3 some plant is not, 1 some plant failed, 2 stopped by a signal (run it again to continue).");
}

}  // namespace

int main(int argc, char** argv) {
  interrupt_on_stop_signals();
  jobs::CommandLine line(SWINGBANK_SUMMARY, "swingbank diagnose");
  Command c;
  declare(line, c);
  if (!line.parse(argc, argv)) return line.end();
  if (!c.thresholds && c.model.empty() && c.fleet.fleet.empty())
    return line.lacks("--model with --records, or --fleet,");
  return jobs::guarded("diagnose", [&] {
    if (c.thresholds) return print_thresholds(c.fleet.json);
    c.fleet.out = c.out;
    if (!c.plant.empty()) return jobs::run_fleet_plant(c.fleet, c.plant);
    if (!c.fleet.fleet.empty()) return jobs::run_fleet(c.fleet, &argc, &argv);
    c.options.threads = std::max(c.fleet.threads, 0);
    return run(c.model, c.records, c.out, c.fleet.json, c.reading, c.judging, c.options,
               jobs::command_line("diagnose", argc, argv));
  });
}
