#include "validate/fleet_plant/fleet_plant.hpp"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/sha256.hpp"
#include "base/write_file.hpp"
#include "validate/check/record_set.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::fleet_plant {
namespace {

namespace fs = std::filesystem;
using fleet::Fleet;
using fleet::FleetPlant;
using fleet::FleetRow;
using nlohmann::json;

/// Returns the sorted files of a name or glob. The terminal of "RUN.h5#TERMINAL" is appended to each file.
std::vector<std::string> matching(const std::string& text, const fs::path& folder, Problems& problems) {
  const std::string whole = (folder / text).string();
  if (whole.find_first_of("*?[") == std::string::npos || fs::exists(whole)) return {whole};
  const auto mark = whole.rfind('#');
  const bool marked = mark != std::string::npos && whole.find('/', mark) == std::string::npos;
  const std::string pattern = marked ? whole.substr(0, mark) : whole,
                    terminal = marked ? whole.substr(mark) : "";
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i) files.push_back(found.gl_pathv[i] + terminal);
  ::globfree(&found);
  if (files.empty())
    problems.add("no record", "records '" + text + "'", "no file matches " + pattern,
                 "check folder and pattern");
  return files;
}

/// Model and records of one plant.
struct Loaded {
  plant::PlantModel model;
  std::vector<std::string> files;
  std::vector<record::Record> records;
  std::vector<std::string> notes;
};

Loaded load(const Fleet& fleet, const FleetPlant& plant) {
  Loaded l;
  Problems problems;
  try {
    l.model = plant::as_submitted(plant::load_plant_model(plant.model));
  } catch (const InputError& error) {
    problems.add(error);
  }
  for (const auto& text : plant.records)
    for (auto& file : matching(text, fleet.folder, problems)) l.files.push_back(std::move(file));
  auto [records, warnings] = check::read_records(l.files, l.model, problems);
  problems.raise();
  l.records = std::move(records);
  for (const auto& some : warnings) std::ranges::copy(some, std::back_inserter(l.notes));
  return l;
}

json block_json(const sim::plant::Block& b) {
  if (b.effect == nullptr) return nullptr;
  json values = json::array();  // hexadecimal, so that no digit is lost
  for (const double v : b.p) values.push_back(fmt::format("{:a}", v));
  return {std::string(b.effect->name), values};
}

/// Returns the hash of all inputs of the diagnosis. A plant file may refer to other files (user-defined
/// models, a grid); their values and the bytes of the user-defined models are included.
std::string inputs_of(const Loaded& l, const FleetPlant& plant) {
  const plant::PlantModel& m = l.model;
  json j = {fleet::kPlantFormat, SWINGBANK_VERSION, plant.name, m.sha256};
  j.push_back({plant.prior_sd, plant.power_only});
  j.push_back({m.plant.mva, m.conventions.speed_voltage, m.conventions.mechanical_power,
               m.conventions.frequency, m.record_base.mva, m.record_base.frequency, m.record_base.kv});
  j.push_back(block_json(m.plant.machine));
  j.push_back(block_json(m.plant.transformer));
  for (const auto& b : m.plant.controls) j.push_back(block_json(b));
  for (const auto& b : m.plant.measurements) j.push_back(block_json(b));
  for (const auto& user_model : m.user_models) {
    const std::string bytes = record::read_bytes(user_model);
    j.push_back(sha256(bytes));
  }
  for (const auto& r : l.records) j.push_back({r.name, r.terminal, r.sha256});
  const std::string text = json_text(j);
  return sha256(text);
}

/// Returns the largest error of the submitted model and its verdict on fitness for purpose.
fleet::SubmittedError submitted_error(const compare::Fitness& f) {
  fleet::SubmittedError worst{constants::nan, {}, {}, {}};
  if (!f.not_judged.empty()) return worst;
  worst.fit = f.fit ? "yes" : "no";
  for (const auto& row : f.rows)
    if (!(row.errors.mxe <= worst.percent))  // NaN is replaced by any error
      worst = {row.errors.mxe, row.channel, std::string(row.window()), row.event, worst.fit};
  return worst;
}

FleetRow row_of(const diagnose::Diagnosis& d, const compare::Fitness& submitted) {
  FleetRow row;
  row.error = submitted_error(submitted);
  row.verdict = diagnose::verdict_name(d.verdict);
  row.effects = d.effects;
  row.equivalent = d.equivalent;
  for (std::size_t k = 0; k < hypothesis::credible(d.probabilities); ++k)
    row.probabilities[d.probabilities[k].name] = d.probabilities[k].probability;
  row.side = hypothesis::side_name(d.side);
  row.left = std::sqrt(d.base.reduced_chi2());
  row.events = static_cast<int>(d.events.size());
  row.sentence = d.sentence;
  row.evidence = row.unseen_before = row.unseen_after = row.chance = constants::nan;
  if (d.ranked.empty() || d.verdict == diagnose::Verdict::adequate) return row;
  const hypothesis::Judgement& best = d.ranked.front();
  if (!best.accepted) return row;
  row.evidence = best.gain;
  const int tried = static_cast<int>(d.ranked.size());
  row.chance = chance_of(fit::gain(d.base, best.fit), best.fit.fitted - d.base.fitted, tried);
  const auto [before, after] = hypothesis::mean_reduced_chi2(best.held_out);
  if (!best.held_out.empty()) row.unseen_before = std::sqrt(before), row.unseen_after = std::sqrt(after);
  return row;
}

/// Reads the row of an earlier run. Returns whether its inputs are the same and its result files exist.
bool finished(const fs::path& folder, const std::string& inputs, FleetRow& row) {
  if (!fs::exists(folder / "diagnosis.json") || !fs::exists(folder / "report.html")) return false;
  try {
    row = fleet::read_row(record::read_bytes(folder / "plant.json"), (folder / "plant.json").string());
  } catch (const InputError&) {
    return false;
  }
  return row.inputs == inputs && !row.failed();
}

/// Replaces the folder of an earlier run by the temporary folder.
void put_in_place(const fs::path& temporary, const fs::path& folder) {
  const fs::path old = folder.parent_path() / ("." + folder.filename().string() + ".old");
  fs::remove_all(old);
  if (fs::exists(folder)) fs::rename(folder, old);
  fs::rename(temporary, folder);
  fs::remove_all(old);
}

/// Throws InputError if the folder was not written by a fleet run, so that only such folders are replaced.
void check_ours(const fs::path& folder) {
  if (!fs::exists(folder) || fs::exists(folder / "plant.json")) return;
  throw InputError({"the folder was not written by a fleet run", folder.string(), "it has no plant.json",
                    "move it away, or give another --out"});
}

std::string plant_json(const FleetRow& row) { return json_text(fleet::row_json(row), 1) + "\n"; }

std::string command_of(const FleetPlant& plant, const std::vector<std::string>& files) {
  std::string text = fmt::format("swingbank diagnose --model {} --records", plant.model.string());
  for (const auto& file : files) text += " " + file;
  text += fmt::format(" --prior-sd {:g}", plant.prior_sd);
  return text + (plant.power_only ? " --power-only" : "");
}

}  // namespace

double chance_of(double fall, int added, int hypotheses) {
  using boost::math::chi_squared;
  const double x = std::max(fall, 0.0);
  const double chance = added <= 0 ? std::exp(-x / 2) : cdf(complement(chi_squared(added), x));
  return std::min(1.0, chance * hypotheses);
}

FleetOutcome diagnose_plant(const Fleet& fleet, const FleetPlant& plant, const fs::path& out,
                            const diagnose::DiagnoseOptions& given) {
  const fs::path folder = out / plant.name, temporary = out / ("." + plant.name + ".part");
  try {
    check_ours(folder);
    Loaded l = load(fleet, plant);
    const std::string inputs = inputs_of(l, plant);
    FleetOutcome o;
    if (finished(folder, inputs, o.row)) {
      o.was_there = true;
      return o;
    }
    diagnose::DiagnoseOptions options = given;
    options.prior_sd = plant.prior_sd;
    options.events.measured_states = !plant.power_only;
    const diagnose::Diagnosis d = diagnose::diagnose(l.model, std::move(l.records), options);
    const auto played = diagnose::play_models(l.model, d, thresholds::read_acceptance(""));
    o.row = row_of(d, played.front().fitness);
    o.row.plant = plant.name;
    o.row.inputs = inputs;
    const report::Provenance rows = diagnose::diagnosis_provenance(l.model, d, command_of(plant, l.files));
    fs::remove_all(temporary);
    write_file(temporary / "diagnosis.json", json_text(diagnose::diagnosis_json(l.model, d, rows), 1) + "\n");
    write_file(temporary / "report.html", diagnose::diagnosis_html(l.model, d, rows, played));
    std::string notes;
    for (const auto& note : l.notes) notes += note + "\n";
    if (!notes.empty()) write_file(temporary / "notes.txt", notes);
    write_file(temporary / "plant.json", plant_json(o.row));
    put_in_place(temporary, folder);
    return o;
  } catch (const std::exception& error) {  // including internal errors, so that the other plants continue
    const FleetRow row = fleet::failed_row(plant.name, error.what());
    try {  // results of an earlier run with other inputs must not remain
      check_ours(folder);
      fs::remove_all(temporary);
      write_file(temporary / "plant.json", plant_json(row));
      put_in_place(temporary, folder);
    } catch (const std::exception&) {  // without effect on the row, which is returned in any case
    }
    return {row, false};
  }
}

}  // namespace swingbank::validate::fleet_plant
