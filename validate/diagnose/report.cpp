#include "validate/diagnose/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/diagnose/detail/false_positives.hpp"
#include "validate/diagnose/detail/report_user_models.hpp"
#include "validate/diagnose/detail/verdict.hpp"
#include "validate/noise/voltage_doubt.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::validate::diagnose {
namespace {

/// Returns the accepted effect, or else the accepted user-defined model; nullptr if there is none.
const hypothesis::Judgement* accepted_effect(const Diagnosis& d) {
  if (d.verdict == Verdict::adequate) return nullptr;
  if (!d.ranked.empty() && d.ranked.front().accepted && !d.ranked.front().fit.events.empty())
    return &d.ranked.front();
  return d.user_models.found() ? &d.user_models.found()->judgement : nullptr;
}

/// Returns modelled - measured [pu].
std::vector<double> difference(const std::vector<double>& model, const std::vector<double>& measured) {
  std::vector<double> r(measured.size());
  std::ranges::transform(model, measured, r.begin(), std::minus<>());
  return r;
}
double share_inside(const event::FitEvent& e, const std::vector<double>& residual, double band) {
  int inside = 0, compared = 0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (!e.compared(k)) continue;
    ++compared;
    inside += std::abs(residual[k]) <= band ? 1 : 0;
  }
  return static_cast<double>(inside) / compared;
}
/// Returns the residual shapes of one channel.
std::vector<std::vector<double>> shapes_of(const noise::VoltageDoubt& doubt, std::size_t channel) {
  std::vector<std::vector<double>> shapes;
  for (const auto& shape : doubt.shapes) shapes.push_back(shape[channel]);
  return shapes;
}

/// Residuals that errors of the played-in voltage may cause, for the models before and after the addition.
struct Doubts {
  noise::VoltageDoubt before, after;
};

ReportChannel channel_of(const Diagnosis& d, const fit::Fit* after, std::size_t e, std::size_t c,
                         const std::vector<compare::Window>& windows, const Doubts& doubts) {
  const event::FitEvent& event = d.events[e];
  const playin::Output output = event.channels[c];
  const compare::ChannelUnit unit = compare::channel_unit(output, event.record.base);
  ReportChannel r;
  r.name = playin::output_name(output);
  r.unit = unit.name;
  r.scale = unit.scale;
  r.size = unit.name == "MW" || unit.name == "Mvar" ? d.base.plant.mva / event.record.base.mva : 1.0;
  r.measured = event.measured(output);
  const auto quiet = static_cast<std::size_t>(event.start.samples);
  // The pre-event residual is the channel's noise, unless a fit biases the initial state to compensate for a
  // missing effect. The lower of the two estimates is used.
  const auto noise_of = [&](const fit::Fit& fit) {
    const auto residual = difference(fit.events[e].model[c], r.measured);
    return compare::estimate_noise(std::span(residual).first(quiet), unit.floor);
  };
  compare::ChannelNoise noise = noise_of(d.base);
  if (after)
    if (compare::ChannelNoise other = noise_of(*after); other.sigma < noise.sigma) noise = std::move(other);
  r.noise = noise.sigma;
  const auto judge_one = [&](const fit::Fit& fit, const noise::VoltageDoubt& doubt,
                             std::vector<double>& model, compare::ErrorMap& map, double& inside) {
    model = fit.events[e].model[c];
    const auto residual = difference(model, r.measured);
    inside = share_inside(event, residual, constants::normal99 * r.noise);
    const auto shapes = shapes_of(doubt, c);
    map = compare::error_map(event.record.t, residual, windows, noise,
                             {.quiet = static_cast<int>(quiet), .shapes = &shapes});
  };
  judge_one(d.base, doubts.before, r.before, r.map_before, r.inside_before);
  if (after) judge_one(*after, doubts.after, r.after, r.map_after, r.inside_after);
  return r;
}

void bound(std::vector<ReportEvent>& events, compare::ErrorMap ReportChannel::*which) {
  std::vector<compare::ErrorMap*> maps;
  for (auto& e : events)
    for (auto& c : e.channels) maps.push_back(&(c.*which));
  compare::set_bounds(maps, thresholds::adequacy.false_alarm);
}

nlohmann::json parameters_json(const fit::Fit& fit) {
  auto rows = nlohmann::json::array();
  for (const auto& p : fit.parameters) rows.push_back(parameter_json(p));
  return rows;
}

nlohmann::json input_json(const Diagnosis& d, const reduced::FreeInput& input) {
  if (input.fit.events.empty()) return nullptr;
  nlohmann::json j = {{"normalised_rms", std::sqrt(input.reduced_chi2())},
                      {"evidence", input.evidence},
                      {"events", nlohmann::json::array()}};
  for (std::size_t e = 0; e < input.fit.events.size(); ++e)
    j["events"].push_back({{"record", d.events[e].record.name},
                           {"t_s", input.of(e).t},
                           {"value_pu", input.of(e).value},
                           {"standard_deviation_pu",
                            std::vector<double>(input.deviation[e].begin(), input.deviation[e].end())}});
  return j;
}

nlohmann::json event_json(const ReportEvent& e, bool with_after) {
  const record::Record& r = e.event->record;
  nlohmann::json j = {{"record", r.name},
                      {"record_sha256", r.sha256},
                      {"samples", r.samples()},
                      {"rate_per_s", r.rate()},
                      {"normalised_rms_before", e.before},
                      {"normalised_rms_after", with_after ? nlohmann::json(e.after) : nullptr},
                      {"unseen_normalised_rms_before", e.unseen_before},
                      {"unseen_normalised_rms_after", e.unseen_after},
                      {"channels", nlohmann::json::array()}};
  for (const auto& c : e.channels) {
    nlohmann::json k = {{"name", c.name},
                        {"unit", c.unit},
                        {"units_in_pu", c.scale},
                        {"noise_pu", c.noise},
                        {"inside_99_before", c.inside_before},
                        {"map_before", compare::map_json(e.windows, c.map_before)}};
    if (with_after) {
      k["inside_99_after"] = c.inside_after;
      k["map_after"] = compare::map_json(e.windows, c.map_after);
    }
    j["channels"].push_back(std::move(k));
  }
  return j;
}

nlohmann::json probabilities_json(const Diagnosis& d) {
  auto rows = nlohmann::json::array();
  const std::size_t set = hypothesis::credible(d.probabilities);
  for (const auto& e : d.probabilities)
    rows.push_back({{"name", e.name}, {"probability", e.probability}, {"in_set", rows.size() < set}});
  return rows;
}

nlohmann::json decision_json(const hypothesis::Decision& d) {
  auto next = nlohmann::json::array();
  for (const auto& n : d.next) next.push_back({{"record", n.what}, {"expected_set", n.expected}});
  return {{"set", d.now}, {"next", next}};
}

nlohmann::json hypothesis_json(const hypothesis::Judgement& h) {
  nlohmann::json j = {
      {"name", hypothesis::full_name(h.hypothesis)},
      {"what", h.hypothesis.what},
      {"side", hypothesis::side_name(h.hypothesis.side)},
      {"accepted", h.accepted},
      {"why_not", h.why_not},
      {"evidence", h.gain},
      {"size", h.size},
      {"normalised_rms", h.fit.values > 0 ? nlohmann::json(std::sqrt(h.fit.reduced_chi2())) : nullptr},
      {"unseen", nlohmann::json::array()}};
  for (const auto& u : h.held_out)
    j["unseen"].push_back({{"record", u.record},
                           {"normalised_rms_before", std::sqrt(u.before)},
                           {"normalised_rms_after", std::sqrt(u.after)},
                           {"cost_per_value_before", u.cost_before},
                           {"cost_per_value_after", u.cost_after}});
  return j;
}

}  // namespace

const reduced::FreeInput* better_input(const Diagnosis& d) {
  const bool torque = !d.torque.fit.events.empty(), field = !d.field.fit.events.empty();
  if (torque && (!field || d.torque.reduced_chi2() <= d.field.reduced_chi2())) return &d.torque;
  return field ? &d.field : nullptr;
}

ReportFigures report_figures(const Diagnosis& d) {
  ReportFigures figures;
  const hypothesis::Judgement* best = accepted_effect(d);
  if (best) {
    figures.after = &best->fit;
    figures.after_name = hypothesis::full_name(best->hypothesis);
  } else if (d.verdict == Verdict::unexplained) {
    if (const reduced::FreeInput* input = better_input(d)) {
      figures.after = &input->fit;
      figures.after_name =
          input->kind == fit::InputKind::torque ? "the inferred torque" : "the inferred field voltage";
    }
  }
  for (std::size_t e = 0; e < d.events.size(); ++e) {
    ReportEvent r;
    r.event = &d.events[e];
    r.windows = compare::event_windows(r.event->record, r.event->switchings,
                                       event::FitEventOptions{}.pre_event, r.event->filtered_samples);
    Doubts doubts{noise::voltage_doubt({d.base.plant, d.conventions}, d.events.whitened(e)), {}};
    if (figures.after)
      doubts.after = noise::voltage_doubt(
          {figures.after->plant, best ? best->hypothesis.conventions : d.conventions}, d.events.whitened(e));
    for (std::size_t c = 0; c < r.event->channels.size(); ++c)
      r.channels.push_back(channel_of(d, figures.after, e, c, r.windows, doubts));
    r.before = std::sqrt(d.base.events[e].reduced_chi2());
    r.after = figures.after ? std::sqrt(figures.after->events[e].reduced_chi2()) : constants::nan;
    r.unseen_before = r.unseen_after = constants::nan;
    if (best && figures.after == &best->fit && e < best->held_out.size()) {
      r.unseen_before = std::sqrt(best->held_out[e].before);
      r.unseen_after = std::sqrt(best->held_out[e].after);
    }
    figures.events.push_back(std::move(r));
  }
  bound(figures.events, &ReportChannel::map_before);
  if (figures.after) bound(figures.events, &ReportChannel::map_after);
  return figures;
}

nlohmann::json parameter_json(const fit::FittedParameter& p) {
  return {{"effect", p.block},      {"name", p.name},
          {"unit", p.unit},         {"start", p.start},
          {"value", p.value},       {"standard_error", p.error},
          {"low_95", p.low},        {"high_95", p.high},
          {"at_bound", p.at_bound}, {"variance_reduction", p.decided}};
}

nlohmann::json diagnosis_json(const plant::PlantModel& model, const Diagnosis& d,
                              const report::Provenance& rows) {
  const ReportFigures figures = report_figures(d);
  nlohmann::json j = {
      {"format", "swingbank-diagnosis-3"},
      {"verdict", verdict_name(d.verdict)},
      {"sentence", d.sentence},
      {"adequacy", thresholds::ruling_json(d.ruling)},
      {"false_positives", {{"given_an_effect", kFalsePositives.hits}, {"nothing_hidden", kFalsePositives.n}}},
      {"side", hypothesis::side_name(d.side)},
      {"effects", d.effects},
      {"equivalent", d.equivalent},
      {"probabilities", probabilities_json(d)},
      {"next_measurement", decision_json(d.would_decide)},
      {"seconds", d.seconds},
      {"model",
       {{"name", model.name}, {"file", model.origin}, {"sha256", model.sha256}, {"mva", model.plant.mva}}}};
  j["before"] = {
      {"normalised_rms", std::sqrt(d.base.reduced_chi2())},
      {"parameters", d.verdict == Verdict::interrupted && !d.ruling.adequate ? nlohmann::json::array()
                                                                             : parameters_json(d.base)}};
  if (figures.after)
    j["after"] = {{"with", figures.after_name},
                  {"normalised_rms", std::sqrt(figures.after->reduced_chi2())},
                  {"parameters", parameters_json(*figures.after)}};
  else
    j["after"] = nullptr;
  const auto wrong = wrong_parameters(d);
  j["wrong_parameters"] = wrong ? calibrate::wrong_json(*wrong) : nlohmann::json();
  j["missing_torque"] = input_json(d, d.torque);
  j["missing_field_voltage"] = input_json(d, d.field);
  j["user_defined_models"] = user_models_json(d);
  j["hypotheses"] = nlohmann::json::array();
  for (const auto& h : d.ranked) j["hypotheses"].push_back(hypothesis_json(h));
  j["events"] = nlohmann::json::array();
  for (const auto& e : figures.events) j["events"].push_back(event_json(e, figures.after != nullptr));
  for (const auto& [name, value] : rows) j["provenance"].push_back({{"what", name}, {"value", value}});
  return j;
}

std::vector<compare::Played> play_models(const plant::PlantModel& model, const Diagnosis& d,
                                         const thresholds::Acceptance& by,
                                         const compare::CompareOptions& options) {
  if (d.verdict == Verdict::interrupted)
    return {{"submitted", {}, compare::not_judged(by, model.plant.mva, "the diagnosis was interrupted")}};
  std::vector<record::Record> records;
  for (const auto& e : d.events) records.push_back(e.record);
  if (std::ranges::all_of(d.events, [](const event::FitEvent& e) { return e.channels.size() <= 2; }))
    records = compare::power_only(std::move(records));
  const auto measured = compare::measurements(records, options, model.plant.mva);
  const auto play = [&](const std::string& name, const sim::plant::Plant& plant,
                        const sim::Conventions& conventions) {
    plant::PlantModel other = model;
    other.plant = plant;
    other.conventions = conventions;
    return compare::play_and_judge(name, other, measured, options, by);
  };
  std::vector<compare::Played> played = {play("submitted", model.plant, model.conventions)};
  if (const hypothesis::Judgement* best = accepted_effect(d))
    played.push_back(play("with " + hypothesis::full_name(best->hypothesis), best->fit.plant,
                          best->hypothesis.conventions));
  played.push_back(play("refitted", d.base.plant, model.conventions));
  return played;
}

report::Provenance diagnosis_provenance(const plant::PlantModel& model, const Diagnosis& d,
                                        const std::string& command_line) {
  report::Provenance rows = {
      {"command", command_line}, {"software", "swingbank " SWINGBANK_VERSION}, {"model", model.origin}};
  if (!model.defaults.empty())
    rows.emplace_back("default values", fmt::format("{}", fmt::join(model.defaults, ", ")));
  for (const auto& e : d.events) rows.emplace_back("record", e.record.name);
  return rows;
}

}  // namespace swingbank::validate::diagnose
