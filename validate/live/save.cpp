#include "validate/live/save.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/shell_word.hpp"
#include "base/write_file.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/page_parts.hpp"
#include "validate/event/component_model.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::live {
namespace {

constexpr const char *kModel = "model.toml", *kDyr = "model.dyr", *kDyd = "model.dyd", *kPage = "report.html";

using nlohmann::json;

/// Returns the numbers of the steps from the submitted model to this one.
std::vector<int> path_to(const Session& session, int step) {
  std::vector<int> path;
  for (int k = step; k >= 0; k = session.step(k)->parent) path.push_back(k);
  std::ranges::reverse(path);
  return path;
}

/// Returns the parameters that the submitted model lacks or has with another value.
std::vector<compare::PageParameter> changed(const Setup& setup, const Step& step) {
  std::vector<compare::PageParameter> rows;
  const auto& plant = step.model.plant;
  for (int block = 0; block < sim::plant::block_count(plant); ++block)
    for (const auto id : sim::plant::parameters_of(plant, block)) {
      const auto before = sim::plant::same_parameter(setup.model.plant, plant, id);
      const double value = parameter_value(plant, id), nan = std::numeric_limits<double>::quiet_NaN();
      const double was = before ? parameter_value(setup.model.plant, *before) : nan;
      if (was == value) continue;
      const sim::Parameter& p = parameter_record(plant, id);
      const auto name = parameter_name(plant, id);
      const auto fitted = std::ranges::find(step.intervals, name.text(), &Interval::name);
      const bool has = fitted != step.intervals.end();
      rows.push_back({name.effect, std::string(p.symbol), std::string(p.unit), was, value,
                      has ? fitted->low : nan, has ? fitted->high : nan, nan, before ? "" : "added"});
    }
  return rows;
}

}  // namespace

std::vector<std::string> saved_files() { return {kModel, kDyr, kDyd, kPage}; }

nlohmann::json save(const Session& session, int step, OutputFolder& folder,
                    const report::Provenance& provenance) {
  const auto path = path_to(session, step);
  const auto kept = session.step(step);
  const Step& last = *kept;
  const Setup& setup = session.setup();
  plant::PlantModel model = event::whole_model(last.model);
  model.submitted.reset();
  std::vector<std::string> head;
  compare::CommandPage page;
  for (const int k : path) {
    const auto s = session.step(k);
    head.push_back(s->label + (s->command.empty() ? "" : ": " + s->command));
    page.tried.push_back(s->label + (s->sentence.empty() ? "" : ": " + s->sentence));
    if (const std::string diagnosis = session.diagnosis_of(k); !diagnosis.empty())
      page.tried.push_back("Diagnosis of the " + s->label + ": " + diagnosis);
  }
  const auto file = folder.file(kModel);
  plant::write_plant_file(file, model, head);
  json files = {file.string()}, notes = json::array();
  for (const auto format : {plant::RecordFormat::dyr, plant::RecordFormat::dyd}) {
    const auto records = plant::write_records_beside(file, event::whole_model(setup.model), model, format);
    if (records.file.empty()) {
      notes.push_back(records.line);
    } else {
      folder.file(records.file.filename());
      files.push_back(records.file.string());
    }
  }
  page.title = "Live page: " + setup.model.name;
  page.subtitle =
      fmt::format("{} of {:g} MVA; the submitted and the completed model, compared with the records.",
                  plant::subject(setup.model), setup.model.plant.mva);
  page.complete = last.complete;
  page.sentence = last.sentence.empty() ? last.label : last.sentence;
  page.played = {*session.step(0)->played};
  page.played.front().name = "submitted";
  if (path.size() > 1) {
    page.played.push_back(*last.played);
    page.played.back().name = "completed";
  }
  page.parameters = changed(setup, last);
  page.use = {last.fitted || !last.held_out.empty(), last.held_out};
  page.handed_in = compare::handed_in(last.model, last.played->events);
  page.provenance = provenance;
  page.figures = json_text(
      {{"format", "swingbank-live-1"}, {"steps", head}, {"fitness", compare::fitness_json(page.played)}});
  const auto html = folder.file(kPage);
  write_file(html, compare::command_html(page));
  files.push_back(html.string());
  return {
      {"files", files},
      {"notes", notes},
      {"model", file.string()},
      {"command", fmt::format("swingbank compare --model {}{}", shell_word(file.string()), setup.options)}};
}

}  // namespace swingbank::validate::live
