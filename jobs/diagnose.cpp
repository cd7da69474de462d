// swingbank diagnose: which physical effect does the model of a plant lack?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "jobs/event_records.hpp"
#include "validate/diagnosis_report.hpp"
#include "validate/diagnosis_text.hpp"
#include "validate/write_file.hpp"

namespace {

using namespace swingbank;
using namespace swingbank::validate;

constexpr int kNotAdequate = 3;

int run(const std::string& model_file, const std::vector<std::string>& record_files, const std::string& out,
        bool json, DiagnoseOptions options, const std::string& command_line) {
  const PlantModel model = load_plant_model(model_file);
  std::vector<Record> records = jobs::read_events(record_files, model);
  options.progress = jobs::progress_line();
  const Diagnosis d = diagnose(model, std::move(records), options);
  const Provenance provenance = diagnosis_provenance(model, d, command_line);
  const auto result = diagnosis_json(model, d, provenance);
  const std::filesystem::path folder = out;
  write_file(folder / "diagnosis.json", result.dump(1) + "\n");
  write_file(folder / "report.html", diagnosis_html(model, d, provenance));
  if (json)
    fmt::print("{}\n", result.dump(1));
  else
    fmt::print("{}\nreport: {}\n", diagnosis_text(d), (folder / "report.html").string());
  return d.verdict == Verdict::adequate ? 0 : kNotAdequate;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY};
  std::string model_file, out = "diagnosis";
  std::vector<std::string> record_files;
  bool json = false;
  DiagnoseOptions options;
  app.add_option("--model", model_file, "plant file (configs/plants/README.md)")->required();
  app.add_option("--records,--record", record_files, "records of the events (validate/README.md)")
      ->required();
  app.add_option("--out", out, "folder for report.html and diagnosis.json")->capture_default_str();
  app.add_option("--spread", options.spread, "relative uncertainty believed of the model's parameters")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 2.0));
  app.add_option("--threads", options.threads, "0: one per core")
      ->capture_default_str()
      ->check(CLI::Range(0, 4096));
  app.add_flag("!--power-only", options.measured_states,
               "leave recorded speed, Efd and Ifd aside: compare P and Q only");
  app.add_flag("--json", json, "print the result as JSON instead of text");
  app.footer("Exit codes: 0 adequate, 3 something is missing or unexplained, 1 bad input.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  return jobs::guarded("diagnose", [&] {
    return run(model_file, record_files, out, json, options, jobs::command_line("diagnose", argc, argv));
  });
}
