#include "validate/calibrate/side_by_side.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "base/constants.hpp"
#include "base/durable.hpp"
#include "base/in_parallel.hpp"
#include "base/inputs_kept.hpp"
#include "validate/calibrate/report.hpp"

namespace swingbank::validate::calibrate {
namespace {

using nlohmann::json;

Way::Value value_of(const fit::FittedParameter& p) { return {p.full_name(), p.unit, p.value, p.low, p.high}; }

Truth truth_of(const sim::plant::Plant& plant) {
  Truth truth;
  for (int block = 0; block < sim::plant::first_measurement(plant); ++block)
    for (const sim::plant::ParameterId id : sim::plant::parameters_of(plant, block))
      truth[sim::plant::parameter_name(plant, id).text()] = sim::plant::parameter_value(plant, id);
  return truth;
}

void require_base(double mva, const plant::PlantModel& model, const std::string& where) {
  if (std::abs(mva - model.plant.mva) > 1e-6 * model.plant.mva)
    throw InputError({fmt::format("true values on {:g} MVA", mva), where,
                      fmt::format("the model's parameters are on {:g} MVA", model.plant.mva),
                      "give the true values of the same machine"});
}

/// Reads a truth file of `blind-test`.
Truth blind_truth(const std::filesystem::path& file, const plant::PlantModel& model) {
  note_input(file);
  const json j = json::parse(read_text(file), nullptr, false);
  const InputError wrong({"no file of true values", file.string(), "it is not a truth file of blind-test",
                          "give a plant file (.toml) or a truth file of blind-test (.json)"});
  if (!j.is_object() || !j.contains("true_plant")) throw wrong;
  Truth truth;
  try {
    require_base(j.at("machine_mva").get<double>(), model, file.string());
    const auto take = [&](const json& block) {
      for (const auto& [name, value] : block.at("parameters").items())
        truth[sim::plant::ParameterName{block.at("effect").get<std::string>(), name}.text()] =
            value.get<double>();
    };
    take(j.at("true_plant").at("machine"));
    for (const auto& block : j.at("true_plant").at("controls")) take(block);
  } catch (const json::exception&) {
    throw wrong;
  }
  return truth;
}

std::string interval(const Way::Value& v) {
  if (!std::isfinite(v.low) || !std::isfinite(v.high)) return "none";
  return v.high > v.low ? fmt::format("{:.4g} to {:.4g}", v.low, v.high) : "";
}
bool has_interval(const Way& way) {
  return std::ranges::any_of(way.values, [](const auto& v) { return !interval(v).empty(); });
}
const Way::Value* find(const Way& way, const std::string& parameter) {
  const auto at = std::ranges::find(way.values, parameter, &Way::Value::parameter);
  return at == way.values.end() ? nullptr : &*at;
}
/// Returns all parameters of all methods in order of occurrence.
std::vector<const Way::Value*> all_parameters(const std::vector<Way>& ways) {
  std::vector<const Way::Value*> all;
  for (const auto& way : ways)
    for (const auto& v : way.values)
      if (std::ranges::none_of(all, [&](const auto* known) { return known->parameter == v.parameter; }))
        all.push_back(&v);
  return all;
}

/// Evaluates every event of the calibration with another plant's parameters; each event's state is fitted.
std::vector<EventScore> try_plant(const sim::plant::Plant& plant, const Calibration& c) {
  std::vector<EventScore> events = c.events;
  in_parallel(
      c.prepared.size(),
      [&](std::size_t e) {
        const fit::Fit own = fit::fit({plant, c.model.conventions}, c.prepared.alone(e), {});
        EventScore& to = events[e];
        if (!own.failed.empty()) {
          to.after = std::numeric_limits<double>::infinity();
          return;
        }
        const EventScore score = score_event(c.prepared.whitened(e), own.events.front(), own.events.front(),
                                             to.seen, pre_event_samples(c.prepared), 1.0);
        to.after = score.after;
      },
      [](int) {});
  return events;
}

}  // namespace

Truth read_truth(const std::filesystem::path& file, const plant::PlantModel& model) {
  if (file.extension() == ".json") return blind_truth(file, model);
  const plant::PlantModel truth = plant::load_plant_model(file);
  require_base(truth.plant.mva, model, file.string());
  return truth_of(truth.plant);
}

Way way_of_model(const Calibration& c) {
  Way way{"model", {}, c.events};
  for (const auto& p : c.parameters)
    way.values.push_back({p.fit.full_name(), p.fit.unit, p.fit.start, p.fit.start, p.fit.start});
  for (auto& e : way.events) e.after = e.before;
  return way;
}

Way way_of(const Calibration& c) {
  Way way{"calibrate", {}, c.events};
  for (const auto& p : c.parameters) way.values.push_back(value_of(p.fit));
  return way;
}

Way way_of(const CurveFit& f, const Calibration& c) {
  Way way{"curve fit", {}, try_plant(f.model.plant, c)};
  for (const auto& p : f.parameters) way.values.push_back(value_of(p));
  return way;
}

Way way_of(const NetworkEstimate& estimate, const sim::plant::Plant& plant, const Calibration& c) {
  Way way{"network", {}, try_plant(plant, c)};
  for (const auto& p : estimate.parameters)
    if (p.learnt())
      way.values.push_back({p.full(), p.unit, p.value, p.value - constants::normal95 * p.rms_error,
                            p.value + constants::normal95 * p.rms_error});
  return way;
}

Distance distance(const Way& way, const Truth& truth) {
  Distance d;
  double squares = 0;
  int relative = 0;
  for (const auto& v : way.values) {
    const auto at = truth.find(v.parameter);
    if (at == truth.end()) continue;
    ++d.parameters;
    if (std::isfinite(v.low) && std::isfinite(v.high)) {
      ++d.intervals;
      d.covering += v.low <= at->second && at->second <= v.high;
    }
    d.mse += std::pow(v.value - at->second, 2);
    if (at->second == 0) continue;
    squares += std::pow((v.value - at->second) / at->second, 2);
    ++relative;
  }
  if (d.parameters > 0) d.mse /= d.parameters;
  if (relative > 0) d.relative = std::sqrt(squares / relative);
  return d;
}

report::Table parameters_beside(const std::vector<Way>& ways, const Truth& truth) {
  report::Table t{"Parameters", {"parameter", "unit"}, {}};
  for (const auto& way : ways) {
    t.header.push_back(way.name);
    if (has_interval(way)) t.header.push_back("95 % interval");
    if (!truth.empty()) t.header.push_back("error");
  }
  if (!truth.empty()) t.header.push_back("truth");
  for (const auto* p : all_parameters(ways)) {
    const auto known = truth.find(p->parameter);
    std::vector<report::Cell> row = {p->parameter, p->unit};
    for (const auto& way : ways) {
      const Way::Value* v = find(way, p->parameter);
      row.emplace_back(v ? fmt::format("{:.4g}", v->value) : "");
      if (has_interval(way)) row.emplace_back(v ? interval(*v) : "");
      if (truth.empty()) continue;
      const bool is_comparable = v != nullptr && known != truth.end() && known->second != 0;
      row.emplace_back(
          is_comparable ? fmt::format("{:+.2g} %", 100 * (v->value - known->second) / std::abs(known->second))
                        : "");
    }
    if (!truth.empty()) row.emplace_back(known == truth.end() ? "" : fmt::format("{:.4g}", known->second));
    t.rows.push_back(std::move(row));
  }
  return t;
}

report::Table events_beside(const std::vector<Way>& ways) {
  report::Table t{"Events", {"event", "use"}, {}};
  for (const auto& way : ways) t.header.push_back(way.name);
  for (std::size_t e = 0; e < ways.front().events.size(); ++e) {
    const EventScore& first = ways.front().events[e];
    std::vector<report::Cell> row = {first.record, use_name(first)};
    for (const auto& way : ways) row.emplace_back(fmt::format("{:.3g}", way.events[e].after));
    t.rows.push_back(std::move(row));
  }
  return t;
}

std::string beside_report(const std::vector<Way>& ways, const Truth& truth) {
  std::string text =
      "Comparison, reduced chi-square (switching times and initial state fitted for each event; "
      "the methods differ only in parameters):\n" +
      report::padded(events_beside(ways), 1) + "\n" + report::padded(parameters_beside(ways, truth), 1);
  if (truth.empty()) return text;
  text += "\n";
  for (const auto& way : ways) {
    const Distance d = distance(way, truth);
    text += fmt::format(
        "{}: RMS relative error {:.3g} %, mean squared error {:.3g} (parameters in their own units)",
        way.name, 100 * d.relative, d.mse);
    if (has_interval(way))
      text += fmt::format(", {} of {} intervals contain the true value", d.covering, d.intervals);
    text += "\n";
  }
  return text;
}

json beside_json(const std::vector<Way>& ways, const Truth& truth) {
  json all = json::array();
  for (const auto& way : ways) {
    json j = {{"method", way.name}, {"parameters", json::array()}, {"events", json::array()}};
    for (const auto& v : way.values) {
      const auto known = truth.find(v.parameter);
      j["parameters"].push_back({{"parameter", v.parameter},
                                 {"unit", v.unit},
                                 {"value", v.value},
                                 {"low_95", v.low},
                                 {"high_95", v.high},
                                 {"truth", known == truth.end() ? json(nullptr) : json(known->second)}});
    }
    for (const auto& e : way.events)
      j["events"].push_back({{"record", e.record}, {"seen", e.seen}, {"reduced_chi2", e.after}});
    if (!truth.empty()) {
      const Distance d = distance(way, truth);
      j["truth"] = {{"parameters", d.parameters},
                    {"intervals", has_interval(way) ? json(d.intervals) : json(nullptr)},
                    {"inside_interval", has_interval(way) ? json(d.covering) : json(nullptr)},
                    {"rms_relative", d.relative},
                    {"mse_raw_units", d.mse}};
    }
    all.push_back(j);
  }
  return all;
}

std::string terminal_report(const CurveFit& f, const Truth& truth) {
  const Way way{"curve fit",
                [&] {
                  std::vector<Way::Value> values;
                  for (const auto& p : f.parameters) values.push_back(value_of(p));
                  return values;
                }(),
                f.events};
  std::string text = f.sentence + "\n\n" + report::padded(event_table(f.events), 1) + "\n" +
                     report::padded(parameters_beside({way}, truth), 1);
  for (const auto& p : f.parameters)
    if (p.at_bound) text += p.full_name() + " ended at its bound.\n";
  if (truth.empty()) return text;
  const Distance d = distance(way, truth);
  return text +
         fmt::format(
             "\nRMS relative error {:.3g} %, mean squared error {:.3g} (parameters in their own units), {} of {} "
             "intervals contain the true value\n",
             100 * d.relative, d.mse, d.covering, d.intervals);
}

json curve_fit_json(const CurveFit& f, const Truth& truth) {
  json j = {
      {"format", "swingbank-curve-fit-4"}, {"version", SWINGBANK_VERSION},  {"model", f.model.origin},
      {"model_sha256", f.model.sha256},    {"sentence", f.sentence},        {"reduced_chi2_before", f.before},
      {"reduced_chi2_after", f.after},     {"reduced_chi2_limit", f.limit}, {"adequate", f.adequate},
      {"converged", f.converged},          {"iterations", f.iterations},    {"seconds", f.seconds},
      {"events", json::array()},           {"parameters", json::array()}};
  for (const auto& e : f.events) j["events"].push_back(event_json(e));
  for (const auto& p : f.parameters) {
    const auto known = truth.find(p.full_name());
    j["parameters"].push_back({{"effect", p.block},
                               {"name", p.name},
                               {"unit", p.unit},
                               {"start", p.start},
                               {"value", p.value},
                               {"standard_error", p.error},
                               {"low_95", p.low},
                               {"high_95", p.high},
                               {"at_bound", p.at_bound},
                               {"truth", known == truth.end() ? json(nullptr) : json(known->second)}});
  }
  return j;
}

std::vector<std::string> provenance_lines(const CurveFit& f, const plant::PlantModel& from,
                                          const std::string& command_line) {
  std::string fitted;
  for (const auto& e : f.events)
    if (e.seen) fitted += (fitted.empty() ? "" : ", ") + e.record;
  return {fmt::format(
              "Fitted by least squares of the curves (baseline) by swingbank {} on {:%Y-%m-%d %H:%M} UTC.",
              SWINGBANK_VERSION, fmt::gmtime(std::time(nullptr))),
          "Command: " + command_line,
          fmt::format("From the model {} (SHA-256 {}).", from.origin, from.sha256), "Fitted to: " + fitted,
          f.sentence};
}

}  // namespace swingbank::validate::calibrate
