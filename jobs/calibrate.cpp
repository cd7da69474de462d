// swingbank calibrate: fits the parameters of a plant model to records of several events, by a multistart fit
// with priors, by plain curve fitting, or by both side by side. It also selects the smallest set of
// parameters that must change.
#include <fmt/format.h>

#include <optional>

#include "base/json.hpp"
#include "base/own_command.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "jobs/results.hpp"
#include "validate/calibrate/network.hpp"
#include "validate/calibrate/report.hpp"
#include "validate/calibrate/side_by_side.hpp"
#include "validate/calibrate/wrong_parameters.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/report_json.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::jobs::calibrate_command {
namespace {

using namespace validate;

constexpr const char *kModel = "model.toml", *kBiasedModel = "model-not-adequate.toml", *kDyr = "model.dyr",
                     *kCurveFit = "curve-fit.toml";

struct Arguments {
  jobs::AnalysisOptions of{"calibration"};
  std::string method = "fit", truth, network, start, command;
  bool sparse = false;
  calibrate::CalibrateOptions options;
  std::optional<fit::Fit> fitted;  ///< result of the fit, once it has ended
};

calibrate::CurveFit fit_curves(const Arguments& a, const plant::PlantModel& model,
                               std::vector<record::Record> records) {
  calibrate::CurveFitOptions options;
  options.held_out = a.options.held_out;
  options.fixed = a.options.fixed;
  options.events = a.options.events;
  options.adequate = a.options.adequate;
  return calibrate::curve_fit(model, std::move(records), options);
}

/// Returns the use of each record: fit, or verification if it is held out.
compare::EventUse use_of(const Arguments& a, const std::vector<record::Record>& records) {
  const auto out = calibrate::held_out_events(records, a.options.held_out);
  compare::EventUse use{true};
  for (std::size_t k = 0; k < records.size(); ++k)
    if (out[k]) use.held_out.push_back(records[k].name);
  return use;
}

/// Returns the recommended next command: a comparison of the calibrated model, or a diagnosis if it is not
/// adequate.
std::string next_command(const Arguments& a, bool adequate) {
  if (!adequate) return fmt::format("swingbank diagnose --model {}{}", a.of.model, a.of.inputs());
  return fmt::format("swingbank compare --model {}{}", (std::filesystem::path(a.of.out) / kModel).string(),
                     a.of.inputs());
}

/// Writes an adequate model to `kModel`, with its .dyr records beside it, or an inadequate model to
/// `kBiasedModel`, with a warning at the file's head. Returns the lines for the terminal.
std::string write_model(const Arguments& a, plant::PlantModel before, plant::PlantModel model, bool adequate,
                        const std::vector<std::string>& provenance) {
  before = event::whole_model(std::move(before));
  model = event::whole_model(std::move(model));
  const auto file = a.of.results().file(adequate ? kModel : kBiasedModel);
  model.submitted.reset();
  if (!adequate) model.submitted = before.plant;
  std::vector<std::string> head = provenance;
  if (!adequate)
    head.insert(
        head.begin(),
        "NOT ADEQUATE: a component is missing in this model, and its parameters are biased. Do not use them.");
  plant::write_plant_file(file, model, head);
  if (!adequate)
    return fmt::format("model: {} (not adequate: its parameters are biased, do not use them)\nnext: {}",
                       file.string(), next_command(a, adequate));
  const plant::WrittenRecords dyr = plant::write_records_beside(file, before, model);
  if (!dyr.file.empty()) a.of.results().file(dyr.file.filename());
  return fmt::format("model: {}\n{}\nnext: {}", file.string(), dyr.line, next_command(a, adequate));
}

/// Result of one method.
struct Calibrated {
  const plant::PlantModel& model;
  bool adequate;
  const std::string& sentence;
  std::string report, comparison = {};  ///< text on the fit, and on its comparison with the other method
  std::vector<std::string> provenance;  ///< comment at the head of the model file
  std::vector<fit::FittedParameter> parameters;
  nlohmann::json json;
  std::vector<std::string> notes = {};  ///< notes on the page
  bool noise_alone = true;              ///< whether the residuals of all events are within the noise limit
};

/// Plays the events with the submitted and the calibrated model.
std::vector<compare::Played> play_both(const Arguments& a, const plant::PlantModel& before,
                                       const plant::PlantModel& after,
                                       const std::vector<record::Record>& records) {
  return jobs::play_both(a.of, before, "calibrated", after, records, a.options.progress);
}

/// Writes all files and prints the result. Returns the exit code.
int write(const Arguments& a, const plant::PlantModel& model, const check::RecordSet& set,
          const std::vector<compare::Played>& played, Calibrated c) {
  compare::CommandPage page;
  page.title = "Calibration: " + model.name;
  page.subtitle = fmt::format("{} of {:g} MVA; its parameters fitted to the records.", plant::subject(model),
                              model.plant.mva);
  page.complete = c.adequate;
  page.noise_alone = c.noise_alone;
  page.sentence = c.sentence;
  page.played = played;
  page.parameters = jobs::page_parameters(c.parameters, c.model.plant);
  page.use = use_of(a, set.records);
  page.tried = {"calibrate does not test the structure; “swingbank diagnose” names missing components."};
  page.tried.insert(page.tried.end(), c.notes.begin(), c.notes.end());
  page.next = next_command(a, c.adequate);
  c.json["records"] = jobs::records_json(set);
  const std::string errors = compare::error_text(played, page.use);
  const std::string usable =
      jobs::write_results(a.of, "calibrate", a.command, model, c.model, std::move(page), c.json);
  const std::string written = write_model(a, model, c.model, c.adequate, c.provenance);
  jobs::finish_results(a.of, c.json,
                       compare::fitness_text(played) + usable + compare::complete_text(c.adequate, c.report) +
                           "\n" + errors + c.comparison + "\n" + written);
  return played.back().fitness.exit_code(c.adequate);
}

int run_baseline(Arguments& a, const plant::PlantModel& model, const check::RecordSet& set,
                 const calibrate::Truth& truth) {
  const calibrate::CurveFit f = fit_curves(a, model, set.records);
  a.fitted.emplace();
  a.fitted->plant = f.model.plant;
  a.fitted->parameters = f.parameters;
  a.fitted->chi2 = f.after;
  a.fitted->values = 1;
  nlohmann::json result = calibrate::curve_fit_json(f, truth);
  result["default_values"] = model.defaults;
  return write(a, model, set, play_both(a, model, f.model, set.records),
               {.model = f.model,
                .adequate = f.adequate,
                .sentence = f.sentence,
                .report = calibrate::terminal_report(f, truth),
                .provenance = calibrate::provenance_lines(f, model, a.command),
                .parameters = f.parameters,
                .json = std::move(result)});
}

/// Returns the network's estimate from the fitted events, by `swingbank predict` or from the file of --start.
/// Returns nothing if neither --network nor --start is given.
std::optional<calibrate::NetworkEstimate> ask_network(const Arguments& a,
                                                      const std::vector<record::Record>& records) {
  const auto out = calibrate::held_out_events(records, a.options.held_out);
  if (!a.start.empty()) {
    calibrate::NetworkEstimate given = calibrate::read_estimate(a.start);
    calibrate::require_unseen(given, records, out);
    return given;
  }
  if (a.network.empty()) return std::nullopt;
  const auto predict = jobs::own_command(
      "predict",
      "install swingbank-train, or run 'swingbank predict --out FILE' where it is installed and give --start FILE");
  const jobs::Scratch scratch;
  const auto file = scratch.folder() / "estimate.json";
  std::vector<std::string> words = {"--network", a.network,     "--model",  a.of.model,
                                    "--out",     file.string(), "--records"};
  for (std::size_t k = 0; k < records.size(); ++k)
    if (!out[k]) words.push_back(a.of.records[k]);
  for (const auto& word : a.of.reading.words()) words.push_back(word);
  if (jobs::run_own(predict, words) != 0)
    throw InputError({"no estimate of the network", a.network, "see the message of swingbank predict above",
                      "correct that, or calibrate without --network"});
  return calibrate::read_estimate(file);
}

/// Runs the sparse parameter selection (--sparse) and writes the model with the changed parameters.
int run_sparse(Arguments& a, const plant::PlantModel& model, const check::RecordSet& set) {
  const calibrate::WrongParameters w = calibrate::wrong_parameters(model, set.records, a.options);
  a.fitted = w.found.fit;
  return write(a, model, set, play_both(a, model, w.model, set.records),
               {.model = w.model,
                .adequate = w.is_adequate(),
                .sentence = w.sentence,
                .report = calibrate::wrong_text(w),
                .provenance = {"command: " + a.command, w.sentence},
                .parameters = w.found.fit.parameters,
                .json = calibrate::wrong_json(w)});
}

int run(Arguments& a, plant::PlantModel& model) {
  const check::Preparing preparing = a.of.reading.apply(model, a.of.records);
  const calibrate::Truth truth = a.truth.empty() ? calibrate::Truth{} : calibrate::read_truth(a.truth, model);
  const check::RecordSet set = jobs::read_events(a.of.records, model, preparing);
  const std::vector<record::Record>& records = set.records;
  if (!a.start.empty()) note_input(a.start);
  a.of.open_results("calibrate", {kModel, kBiasedModel, kDyr, kCurveFit, jobs::kPage, "calibrate.json",
                                  jobs::kInterruptedModel, "calibrate-interrupted.json"});
  if (a.method == "curve-fit" && !(a.network.empty() && a.start.empty()))
    throw InputError({"a start from a network", "--method curve-fit",
                      "curve fitting starts from the model's own values", "give --method fit or both"});
  if (a.sparse && (a.method != "fit" || !(a.network.empty() && a.start.empty())))
    throw InputError({"a method or start with --sparse", "--sparse",
                      "the selection uses its own method and starts",
                      "leave --method, --network and --start out"});
  if (a.method == "curve-fit") return run_baseline(a, model, set, truth);
  if (a.sparse) return run_sparse(a, model, set);
  const bool both = a.method == "both";
  const auto estimate = ask_network(a, records);
  sim::plant::Plant estimated;
  if (estimate) {
    estimated = calibrate::estimated_plant(*estimate, model, a.options.prior_sd);
    a.options.given.push_back({"network", estimated});
  }
  const calibrate::Calibration c = calibrate::calibrate(model, records, a.options);
  a.fitted = c.fit;
  const bool adequate = c.adequacy != calibrate::Adequacy::structure_poor;
  std::optional<calibrate::CurveFit> curve;
  if (both) curve = fit_curves(a, model, records);
  const auto played = play_both(a, model, c.model, records);
  nlohmann::json result = calibrate::calibration_json(c);
  result["default_values"] = model.defaults;
  std::vector<calibrate::Way> ways = {calibrate::way_of_model(c)};
  if (curve) {
    plant::write_plant_file(a.of.results().file(kCurveFit), event::whole_model(curve->model),
                            calibrate::provenance_lines(*curve, model, a.command));
    result["curve_fit"] = calibrate::curve_fit_json(*curve, truth);
    ways.push_back(calibrate::way_of(*curve, c));
  }
  if (estimate) ways.push_back(calibrate::way_of(*estimate, estimated, c));
  ways.push_back(calibrate::way_of(c));
  std::string comparison;
  if (ways.size() > 2 || !truth.empty()) {
    comparison = "\n" + calibrate::beside_report(ways, truth);
    result["side_by_side"] = calibrate::beside_json(ways, truth);
  }
  std::vector<fit::FittedParameter> fitted;
  for (const auto& p : c.parameters) fitted.push_back(p.fit);
  std::vector<std::string> notes;
  for (const auto& combination : c.unidentified) notes.push_back(calibrate::describe(c, combination));
  return write(a, model, set, played,
               {.model = c.model,
                .adequate = adequate,
                .sentence = c.sentence,
                .report = calibrate::terminal_report(c),
                .comparison = comparison,
                .provenance = calibrate::provenance_lines(c, a.command),
                .parameters = fitted,
                .json = std::move(result),
                .notes = notes,
                .noise_alone = std::ranges::all_of(c.events, [](const auto& e) { return e.is_noise(); })});
}

int run_interruptible(Arguments& a) {
  a.of.judging.read();
  plant::PlantModel model = a.of.load_model(true);
  return jobs::keep_reached(a.of, "calibrate", a.command, model, a.fitted, [&] { return run(a, model); });
}

void declare(jobs::CommandLine& line, Arguments& a) {
  auto& o = a.options;
  a.of.declare(line, "model.toml (or model-not-adequate.toml), model.dyr, report.html and calibrate.json");
  a.of.declare_fit(line);
  a.of.declare_hold_out(line);
  line.group("Fit");
  line.add(
          "--method", a.method,
          "fit: multistart with priors (maximum a posteriori); curve-fit: least squares of P and Q from the model's own "
          "values, as a baseline; both: comparison of the two")
      .shows_default()
      .one_of({"fit", "curve-fit", "both"});
  line.add_flag("--sparse", a.sparse,
                "select the smallest set of parameters that must change for the model to explain the "
                "records; all others keep their values; writes the model with these changes");
  line.add("--fix", o.fixed, "parameter that keeps its value (GENROU.Xl); may be repeated");
  const jobs::Option network = line.add("--network", a.network,
                                        "trained network (file.network, or a folder with one): its estimate "
                                        "is one of the starts, and is shown beside the fit");
  line.add("--start", a.start,
           "estimate as with --network, from a file that 'swingbank predict --out FILE' wrote")
      .excludes(network);
  line.add("--truth", a.truth, "plant file (or blind-test's truth) to compare the parameters with");
  line.group("Expert");
  line.add("--draws", o.draws, "number of random parameter sets tried as starts")
      .shows_default()
      .between(0, 100000);
  line.add("--starts", o.starts,
           "number of these sets that are refined, in addition to the model's own values")
      .shows_default()
      .between(0, 1000);
  line.add("--seed", o.seed, "seed of these parameter sets").shows_default();
  line.example("swingbank calibrate --model plant.toml --records fault1.csv fault2.csv --hold-out fault2");
  line.footer(std::string(thresholds::kExitCodes) +
              " Complete: the structure is adequate after calibration (curve-fit: the residual is noise).");
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Arguments a;
  declare(line, a);
  if (!line.parse(argc, argv)) return line.end();
  if (a.of.model.empty()) return line.lacks("--model with --records");
  a.options.progress = jobs::progress_line(a.sparse ? jobs::kSparsePlan : jobs::kCalibratePlan);
  a.options.events = a.of.events();
  a.options.prior_sd = a.of.prior_sd;
  a.options.held_out = a.of.held_out;
  a.of.limit_threads();
  a.command = jobs::command_line("calibrate", argc, argv);
  return run_interruptible(a);
}

}  // namespace swingbank::jobs::calibrate_command
