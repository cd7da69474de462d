// swingbank calibrate: fits the parameters of a plant model to records of several events.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "jobs/event_records.hpp"
#include "validate/calibrate_report.hpp"
#include "validate/plant_file.hpp"
#include "validate/write_file.hpp"

namespace {

using namespace swingbank;
using namespace swingbank::validate;

constexpr int kNotAdequate = 3;

int run(const std::string& model_file, const std::vector<std::string>& record_files, const std::string& out,
        bool json, CalibrateOptions options, const std::string& command_line) {
  const PlantModel model = load_plant_model(model_file);
  std::vector<Record> records = jobs::read_events(record_files, model);
  options.progress = jobs::progress_line();
  const Calibration c = calibrate(model, std::move(records), options);
  const std::filesystem::path folder = out;
  nlohmann::json result = calibration_json(c);
  result["command"] = command_line;
  write_plant_file(folder / "model.toml", c.model, provenance_lines(c, command_line));
  write_file(folder / "calibrate.json", result.dump(1) + "\n");
  if (json)
    fmt::print("{}\n", result.dump(1));
  else
    fmt::print("{}\nmodel: {}\n", terminal_report(c), (folder / "model.toml").string());
  return c.adequacy == Adequacy::structure_poor ? kNotAdequate : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY};
  std::string model_file, out = "calibration";
  std::vector<std::string> record_files;
  bool json = false, inner = true;
  CalibrateOptions options;
  app.add_option("--model", model_file, "plant file (configs/plants/README.md)")->required();
  app.add_option("--records,--record", record_files, "records of the events (validate/README.md)")
      ->required();
  app.add_option("--out", out, "folder for model.toml and calibrate.json")->capture_default_str();
  app.add_option("--hold-out", options.held_out,
                 "record (name or number from 1) left out of the fit and used to judge it; may be repeated");
  app.add_option("--spread", options.spread, "relative uncertainty believed of the model's parameters")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 2.0));
  app.add_option("--fix", options.fixed, "parameter that stays as it is (GENROU.Xl); may be repeated");
  app.add_option("--draws", options.draws, "parameter sets tried as starts")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  app.add_option("--starts", options.starts, "how many of them are refined, beside the model's own values")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_option("--seed", options.seed, "of the draws")->capture_default_str();
  app.add_option("--jump-threshold", options.events.jump_threshold,
                 "smallest jump of the voltage taken for switching [pu]")
      ->capture_default_str();
  app.add_option("--pre-event", options.events.pre_event, "steady stretch of records without switching [s]")
      ->capture_default_str();
  app.add_flag("!--power-only", inner, "leave recorded speed, Efd and Ifd aside: compare P and Q only");
  app.add_flag("--json", json, "print the result as JSON instead of tables");
  app.footer("Exit codes: 0 the structure holds, 3 something is missing in it, 1 bad input.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  options.events.measured_states = inner;
  return jobs::guarded("calibrate", [&] {
    return run(model_file, record_files, out, json, options, jobs::command_line("calibrate", argc, argv));
  });
}
