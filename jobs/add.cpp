// swingbank add: adds physical effects (or user-defined models) to a plant model, fits them together, and
// shows every event before and after. With --retrain, also shows the effect's influence on a trained network.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/json.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "jobs/results.hpp"
#include "jobs/retrain_run.hpp"
#include "validate/add/report.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/compare/report_json.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::jobs::add_command {
namespace {

using namespace validate;

constexpr const char *kModel = "model.toml", *kDyr = "model.dyr", *kRetrained = "retrain.json";

struct Arguments {
  jobs::AnalysisOptions of{"added"};
  std::vector<std::string> effects;
  std::string truth, command;
  bool until_adequate = false, retrain = false;
  nlohmann::json metadata;  ///< metadata of the records
  add::AddOptions options;
  retrain::RetrainOptions training;
  std::optional<fit::Fit> fitted;  ///< result of the fit, once it has ended
};

/// Adds the result of one addition to the page: parameters, held-out events and evidence of each effect.
void say_on(compare::CommandPage& page, const add::Addition& added) {
  const auto rows = jobs::page_parameters(added.parameters, added.model.plant);
  page.parameters.assign(rows.begin(), rows.end());
  for (int i = 0; i < added.own; ++i) page.parameters[static_cast<std::size_t>(i)].note = "added";
  page.use = {true};
  for (const auto& e : added.events)
    if (!e.score.seen) page.use.held_out.push_back(e.score.record);
  for (const auto& e : added.effects)
    page.tried.push_back(fmt::format("{}: evidence{} {:.1f}, required {:g}; {}.", e.what,
                                     added.effects.size() > 1 ? " beside the others" : "", e.evidence,
                                     thresholds::addition.strong.value,
                                     added.earns ? "accepted" : "not accepted"));
}
/// Returns "added" with the content of the residual, such as ": only noise remains".
std::string added_text(bool adequate, const compare::CommandPage& page, const compare::Played& played) {
  if (!adequate) return "added: errors remain";
  return "added" + compare::remainder_text(compare::remainder_of(played, page.noise_alone));
}
/// Returns whether the residuals of all events are within the noise limit.
bool is_noise(const add::Addition& added) {
  return std::ranges::all_of(added.events, [](const auto& e) { return e.score.is_noise(); });
}
compare::CommandPage page_of(const add::Addition& added, const std::vector<compare::Played>& played) {
  compare::CommandPage page;
  page.complete = added.adequate && added.earns;
  page.noise_alone = is_noise(added);
  page.sentence = added.sentence;
  page.headline = fmt::format("{} {}", added.hypothesis.name,
                              added.earns ? added_text(added.adequate, page, played.back()) : "not accepted");
  say_on(page, added);
  return page;
}
compare::CommandPage page_of(const add::Completion& c, const std::vector<compare::Played>& played) {
  compare::CommandPage page;
  page.complete = c.adequate;
  page.noise_alone = c.added.empty() || is_noise(c.added.back());
  page.sentence = c.sentence;
  std::size_t count = 0;
  for (const auto& one : c.added) count += one.effects.size();
  page.headline = fmt::format("{} {} {}", count, count == 1 ? "effect" : "effects",
                              added_text(c.adequate, page, played.back()));
  for (const auto& one : c.added) say_on(page, one);
  for (const auto& r : c.removed)
    page.tried.push_back(fmt::format("{} removed: its evidence fell to {:.1f}.", r.effect, r.evidence));
  return page;
}

void write(const Arguments& a, const plant::PlantModel& before, plant::PlantModel model,
           const std::vector<std::string>& provenance, nlohmann::json result, const std::string& text,
           const std::vector<compare::Played>& played, compare::CommandPage page) {
  page.title = "Added effect: " + before.name;
  page.subtitle =
      fmt::format("{} of {:g} MVA; the submitted and the completed model, compared with the records.",
                  plant::subject(before), before.plant.mva);
  page.played = played;
  result["default_values"] = before.defaults;
  result["records"] = a.metadata;
  const std::string errors = compare::error_text(played, page.use);
  const std::string usable =
      jobs::write_results(a.of, "add", a.command, before, model, std::move(page), result);
  const plant::PlantModel whole_before = event::whole_model(before);
  model = event::whole_model(std::move(model));
  model.submitted.reset();
  const auto file = a.of.results().file(kModel);
  plant::write_plant_file(file, model, provenance);
  const plant::WrittenRecords records = plant::write_records_beside(file, whole_before, model);
  if (!records.file.empty()) a.of.results().file(records.file.filename());
  jobs::finish_results(a.of, result,
                       compare::fitness_text(played) + usable + text + "\n" + errors +
                           "\nmodel: " + file.string() + "\n" + records.line);
}

/// Throws InputError if options contradict each other; called before any computation.
void check_options(const Arguments& a) {
  Problems problems;
  if (a.effects.empty() != a.until_adequate)
    problems.add(a.effects.empty() ? "no effect" : "an effect together with --until-adequate",
                 "swingbank add", "effects are either named or searched for",
                 "give either EFFECT or --until-adequate");
  if (a.retrain && a.until_adequate)
    problems.add("--retrain together with --until-adequate", "swingbank add",
                 "networks are trained for one effect", "name the effect");
  if (a.retrain && add::effect_names(a.effects).size() > 1)
    problems.add("--retrain together with several effects", "swingbank add",
                 "two networks show the influence of one effect",
                 "add the other effects first, and retrain with the completed model");
  if (a.retrain && a.options.calibrate.held_out.empty())
    problems.add("no event held out", "--retrain", "networks are judged on held-out events",
                 "hold out at least one with --hold-out");
  problems.raise();
}

/// Trains the two networks unless they exist, and compares their estimates. Returns nothing if a signal
/// stopped the training.
std::optional<retrain::Retrained> retrain(const Arguments& a, const jobs::RetrainPrograms& programs,
                                          const plant::PlantModel& before, const add::Addition& added,
                                          const std::vector<record::Record>& records) {
  const std::filesystem::path folder = a.of.out;
  const calibrate::Truth truth =
      a.truth.empty() ? calibrate::Truth{} : calibrate::read_truth(a.truth, before);
  const auto sides = retrain::write_retrain_configs(folder / "retrain", before, added, records, a.training);
  for (const auto& side : sides)
    if (!jobs::make_network(programs, side)) return std::nullopt;
  const std::array<calibrate::NetworkEstimate, 2> estimates = {
      jobs::ask_network(programs, sides[0], a.of.model, a.of.records, a.of.reading.words()),
      jobs::ask_network(programs, sides[1], (folder / kModel).string(), a.of.records, a.of.reading.words())};
  return retrain::compare_networks(estimates, before, added, truth);
}

int run_retrain(const Arguments& a, const jobs::RetrainPrograms& programs, const plant::PlantModel& before,
                const add::Addition& done, const std::vector<record::Record>& records) {
  const auto networks = retrain(a, programs, before, done, records);
  if (!networks) {
    fmt::print(stderr, "stopped on a signal; run the same command again to continue\n");
    return jobs::kStopped;
  }
  nlohmann::json result = retrain::retrained_json(*networks);
  result["command"] = a.command;
  write_file(a.of.results().file(kRetrained), json_text(result, 1) + "\n");
  a.of.results().finish();
  if (!a.of.json) fmt::print("\n{}\n", terminal_report(*networks));
  return 0;
}

int run(Arguments& a, plant::PlantModel& model) {
  jobs::RetrainPrograms programs;
  if (a.retrain) programs = jobs::retrain_programs();
  const check::Preparing preparing = a.of.reading.apply(model, a.of.records);
  const check::RecordSet set = jobs::read_events(a.of.records, model, preparing);
  const std::vector<record::Record>& records = set.records;
  a.metadata = jobs::records_json(set);
  calibrate::held_out_events(records, a.options.calibrate.held_out);
  for (const std::filesystem::path& file : std::vector<std::filesystem::path>{a.training.dataset, a.truth})
    if (!file.empty()) note_input(file);
  a.of.open_results("add", {kModel, kDyr, jobs::kPage, "add.json", kRetrained, jobs::kInterruptedModel,
                            "add-interrupted.json"});
  a.options.calibrate.progress =
      a.until_adequate ? jobs::progress_line() : jobs::progress_line(jobs::kAddPlan);
  if (a.until_adequate) {
    add::Completion c = add::add_until_adequate(model, records, a.options);
    if (!c.added.empty()) a.fitted = c.added.back().with;
    a.of.keep_user_models(c.model);
    std::vector<std::string> provenance = {"Command: " + a.command};
    for (const auto& one : c.added)
      for (const auto& line : provenance_lines(one, model, a.command)) provenance.push_back(line);
    provenance.push_back(c.sentence);
    const auto played =
        jobs::play_both(a.of, model, "completed", c.model, records, a.options.calibrate.progress);
    write(a, model, c.model, provenance, add::completion_json(c),
          compare::complete_text(c.adequate, terminal_report(c)), played, page_of(c, played));
    return played.back().fitness.exit_code(c.adequate);
  }
  add::Addition done = add::add_effects(model, a.effects, records, a.options);
  a.fitted = done.with;
  a.of.keep_user_models(done.model);
  const bool complete = done.adequate && done.earns;
  const auto played =
      jobs::play_both(a.of, model, "completed", done.model, records, a.options.calibrate.progress);
  write(a, model, done.model, provenance_lines(done, model, a.command), add::addition_json(done),
        compare::complete_text(complete, terminal_report(done)), played, page_of(done, played));
  if (a.retrain)
    if (const int code = run_retrain(a, programs, model, done, records); code != 0) return code;
  return played.back().fitness.exit_code(complete);
}

int run_interruptible(Arguments& a) {
  check_options(a);
  a.of.judging.read();
  plant::PlantModel model = a.of.load_model(true);
  return jobs::keep_reached(a.of, "add", a.command, model, a.fitted, [&] { return run(a, model); });
}

void declare(jobs::CommandLine& line, Arguments& a) {
  line.group("Input");
  line.add(
      "effect", a.effects,
      "effects, user-defined models or parameter groups (SEXS, GENROU:S10,S12), which are fitted together; "
      "'swingbank effects' lists them");
  a.of.declare(line, "model.toml, model.dyr, report.html and add.json");
  a.of.declare_fit(line);
  a.of.declare_hold_out(line);
  line.group("Fit");
  line.add_flag("--until-adequate", a.until_adequate,
                "diagnose and add the effect found, repeatedly, until the residual is only noise");
  line.group("Network");
  line.add_flag("--retrain", a.retrain,
                "train a network on the plant without and one with the effect, and compare them on these "
                "records (folder OUT/retrain; run again to continue)");
  line.add("--dataset", a.training.dataset,
           "--retrain: config of a dataset about this plant in its grid, without the effect "
           "(default: the plant behind three lines and a large machine)")
      .existing_file();
  line.add("--train-draws", a.training.draws, "--retrain: events simulated for each network")
      .shows_default()
      .between(50, 100'000'000);
  line.add("--train-epochs", a.training.epochs, "--retrain: number of training epochs")
      .shows_default()
      .between(1, 100'000);
  line.add("--train-network", a.training.network, "--retrain: cnn, gru or lstm")
      .shows_default()
      .one_of({"cnn", "gru", "lstm"});
  line.add("--train-range", a.training.range,
           "--retrain: the effect's parameters are drawn from 1/RANGE to RANGE times the fitted values; "
           "without --dataset the machine's too, about the model's values")
      .shows_default()
      .between(1.05, 100.0);
  line.add("--truth", a.truth,
           "--retrain: plant file with the true values (or the truth file of a blind test), with "
           "which the networks' estimates are compared");
  line.example("swingbank add SEXS --model plant.toml --records fault1.csv fault2.csv --hold-out fault2");
  line.footer(std::string(thresholds::kExitCodes) +
              " Complete: the effect is accepted, and the residual is noise. 2: a training stopped on "
              "a signal; run again to continue.");
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Arguments a;
  declare(line, a);
  if (!line.parse(argc, argv)) return line.end();
  if (a.of.model.empty()) return line.lacks("--model with --records");
  auto& c = a.options.calibrate;
  c.events = a.of.events();
  c.prior_sd = a.of.prior_sd;
  c.held_out = a.of.held_out;
  a.of.limit_threads();
  a.command = jobs::command_line("add", argc, argv);
  return run_interruptible(a);
}

}  // namespace swingbank::jobs::add_command
