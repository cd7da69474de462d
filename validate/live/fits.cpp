#include "validate/live/fits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/shell_word.hpp"
#include "base/stop_signal.hpp"
#include "validate/add/at_once.hpp"
#include "validate/calibrate/response_band.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/hypothesis/posterior.hpp"
#include "validate/live/detail/number.hpp"

namespace swingbank::validate::live {
namespace {

using nlohmann::json;

json block_json(const sim::plant::Block& b) {
  return b.effect == nullptr ? json(nullptr) : json{{"effect", std::string(b.effect->name)}, {"p", b.p}};
}

sim::plant::Block block_of(const json& j, const sim::library::EffectLibrary& library) {
  if (j.is_null()) return {};
  const std::string name = j.at("effect");
  const sim::Effect* effect = library.find(name);
  if (effect == nullptr)
    throw InputError({"effect " + name, "the live page", "it is unknown", "reload the page"});
  return {effect, j.at("p").get<std::vector<double>>()};
}

json parameters_json(const std::vector<fit::FittedParameter>& parameters) {
  json all = json::array();
  for (const auto& p : parameters)
    all.push_back({{"name", p.full_name()}, {"low", number(p.low)}, {"high", number(p.high)}});
  return all;
}

event::Progress progress_of(const Emit& emit) {
  return [emit](event::Phase phase, const std::string& item, int done, int total) {
    emit({{"type", "progress"},
          {"phase", static_cast<int>(phase)},
          {"item", item},
          {"done", done},
          {"total", total}});
  };
}

/// Returns the inferred inputs of each diagnosed event, with the event's index among all records.
json inputs_json(const Setup& setup, const diagnose::Diagnosis& d) {
  json all = json::array();
  for (std::size_t e = 0; e < d.events.size(); ++e) {
    const auto at = std::ranges::find(setup.records, d.events[e].record.name, &record::Record::name);
    json one = {{"event", at - setup.records.begin()}};
    for (const auto& [name, input] : {std::pair("torque", &d.torque), {"field", &d.field}}) {
      if (e >= input->fit.events.size()) continue;
      const auto& curve = input->of(e);
      one[name] = {{"t", curve.t}, {"value", curve.value}};
    }
    all.push_back(std::move(one));
  }
  return all;
}

/// Returns the side whose inferred input explains more; empty before the inference.
std::string side_of(const diagnose::Diagnosis& d) {
  if (d.torque.fit.events.empty() || d.field.fit.events.empty()) return "";
  return d.field.evidence > d.torque.evidence ? "excitation" : "mechanical";
}

/// Returns the candidates with their probabilities. Before the verdict, these follow from the evidence so
/// far.
json candidates_json(const diagnose::Diagnosis& d) {
  std::vector<hypothesis::Explanation> all = d.probabilities;
  if (all.empty() && !d.ranked.empty()) {
    for (std::size_t k = 0; k < d.ranked.size(); ++k)
      if (d.ranked[k].fitted)
        all.push_back({hypothesis::full_name(d.ranked[k].hypothesis), d.ranked[k].gain, static_cast<int>(k)});
    all = hypothesis::posterior(std::move(all), 0);
  }
  constexpr std::size_t kCandidatesShown = 8;
  json shown = json::array();
  for (const auto& e : all) {
    if (shown.size() == kCandidatesShown) break;
    json one = {{"name", e.name}, {"probability", number(e.probability)}};
    if (e.place >= 0 && e.place < static_cast<int>(d.ranked.size())) {
      const auto& j = d.ranked[static_cast<std::size_t>(e.place)];
      one["what"] = j.hypothesis.what;
      one["side"] = std::string(hypothesis::side_name(j.hypothesis.side));
      one["chi2"] = number(j.fit.reduced_chi2());
      one["effect"] = hypothesis::full_name(j.hypothesis);
    }
    shown.push_back(std::move(one));
  }
  return shown;
}

void run_diagnosis(const Setup& setup, const plant::PlantModel& model,
                   const std::vector<record::Record>& records, const Emit& emit) {
  diagnose::DiagnoseOptions options;
  options.prior_sd = setup.prior_sd;
  options.events = setup.events;
  options.progress = progress_of(emit);
  options.preliminary_result = [&](const std::string& sentence, const diagnose::Diagnosis& d) {
    emit({{"type", "preliminary"},
          {"sentence", sentence},
          {"side", side_of(d)},
          {"inputs", inputs_json(setup, d)},
          {"candidates", candidates_json(d)}});
  };
  const diagnose::Diagnosis d = diagnose::diagnose(model, records, options);
  json next = json::array();
  for (const auto& n : d.would_decide.next)
    next.push_back({{"what", n.what}, {"expected", number(n.expected)}});
  emit({{"type", "diagnosis"},
        {"verdict", std::string(diagnose::verdict_name(d.verdict))},
        {"sentence", d.sentence},
        {"side", side_of(d)},
        {"effects", d.effects},
        {"inputs", inputs_json(setup, d)},
        {"candidates", candidates_json(d)},
        {"now", d.would_decide.now},
        {"next", next}});
  emit({{"type", "end"}});
}

calibrate::CalibrateOptions fitting(const Setup& setup, const json& request, const Emit& emit) {
  calibrate::CalibrateOptions o;
  o.prior_sd = setup.prior_sd;
  o.events = setup.events;
  o.held_out = request.value("held_out", std::vector<std::string>{});
  o.progress = progress_of(emit);
  return o;
}

/// Returns the values [pu], rounded to 1e-5, less than the width of a line on the page.
json curve_json(const std::vector<double>& curve) {
  json values = json::array();
  for (const double v : curve) values.push_back(number(std::round(1e5 * v) / 1e5));
  return values;
}

/// Returns the 95 % bands of the fitted model's response.
json bands_json(const Setup& setup, const plant::PlantModel& fitted,
                const std::vector<fit::FittedParameter>& parameters,
                const calibrate::CalibrateOptions& options) {
  std::vector<fit::FreeParameter> free;
  for (const auto& p : parameters) free.push_back(p.where);
  return calibrate::response_bands(fitted, setup.records, free, options);
}

/// Returns the modelled curves of each fitted event.
json curves_json(const fit::Fit& f, const std::vector<bool>& held_out) {
  json all = json::array();
  std::size_t fitted = 0;
  for (std::size_t e = 0; e < held_out.size() && fitted < f.events.size(); ++e) {
    if (held_out[e]) continue;
    json channels = json::array();
    for (const auto& channel : f.events[fitted].model) channels.push_back(curve_json(channel));
    all.push_back({{"event", e}, {"channels", std::move(channels)}});
    ++fitted;
  }
  return all;
}

void run_addition(const Setup& setup, const plant::PlantModel& model, const json& request, const Emit& emit) {
  const std::string effect = request.at("effect");
  const auto out = calibrate::held_out_events(setup.records, fitting(setup, request, emit).held_out);
  const auto reached = [&](const fit::Fit& f) {
    if (std::isfinite(f.chi2) && f.values > 0)
      emit({{"type", "reached"}, {"chi2", f.reduced_chi2()}, {"events", curves_json(f, out)}});
  };
  const add::AddOptions options{.calibrate = fitting(setup, request, emit), .reached = reached};
  std::optional<add::Addition> quick;
  if (add::effect_names({effect}).size() == 1)
    quick =
        add::add_at_once(model, add::find_hypothesis(model, effect, setup.records), setup.records, options);
  const add::Addition a = quick ? *quick : add::add_effects(model, {effect}, setup.records, options);
  emit({{"type", "step"},
        {"kind", "added"},
        {"effect", effect},
        {"label", "+ " + effect},
        {"plant", plant_json(a.model)},
        {"parameters", parameters_json(a.parameters)},
        {"bands", bands_json(setup, a.model, a.parameters, options.calibrate)},
        {"held_out", request.value("held_out", std::vector<std::string>{})},
        {"evidence", quick ? json(nullptr) : number(a.evidence)},
        {"sentence", a.sentence}});
}

void run_calibration(const Setup& setup, const plant::PlantModel& model, const json& request,
                     const Emit& emit) {
  const calibrate::CalibrateOptions options = fitting(setup, request, emit);
  const calibrate::Calibration c = calibrate::calibrate(model, setup.records, options);
  std::vector<fit::FittedParameter> parameters;
  for (const auto& p : c.parameters) parameters.push_back(p.fit);
  emit({{"type", "step"},
        {"kind", "calibrated"},
        {"label", "fitted parameters"},
        {"plant", plant_json(c.model)},
        {"parameters", parameters_json(parameters)},
        {"bands", bands_json(setup, c.model, parameters, options)},
        {"held_out", request.value("held_out", std::vector<std::string>{})},
        {"sentence", c.sentence}});
}

}  // namespace

json plant_json(const plant::PlantModel& model) {
  json controls = json::array(), measurements = json::array();
  for (const auto& b : model.plant.controls) controls.push_back(block_json(b));
  for (const auto& b : model.plant.measurements) measurements.push_back(block_json(b));
  const sim::Conventions& c = model.conventions;
  return {{"machine", block_json(model.plant.machine)},
          {"transformer", block_json(model.plant.transformer)},
          {"controls", controls},
          {"measurements", measurements},
          {"conventions", {{"speed_voltage", c.speed_voltage}, {"mechanical_power", c.mechanical_power}}}};
}

plant::PlantModel with_plant(plant::PlantModel model, const json& plant) {
  auto& p = model.plant;
  p.machine = block_of(plant.at("machine"), model.library);
  p.transformer = block_of(plant.at("transformer"), model.library);
  p.controls.clear();
  for (const auto& b : plant.at("controls")) p.controls.push_back(block_of(b, model.library));
  p.measurements.clear();
  for (const auto& b : plant.at("measurements")) p.measurements.push_back(block_of(b, model.library));
  model.conventions.speed_voltage = plant.at("conventions").at("speed_voltage");
  model.conventions.mechanical_power = plant.at("conventions").at("mechanical_power");
  return model;
}

/// Returns the message with the values that a stopped fit has reached.
json step_so_far(const json& request, plant::PlantModel model, const fit::Fit& reached) {
  model.plant = reached.plant;
  return {{"type", "step"},
          {"kind", request.at("kind") == "add" ? "added" : "calibrated"},
          {"stopped", true},
          {"label", "Stopped fit"},
          {"plant", plant_json(model)},
          {"parameters", json::array()},
          {"bands", calibrate::ResponseBands{}},
          {"held_out", request.value("held_out", std::vector<std::string>{})},
          {"sentence", fmt::format("Stopped. The step has the best values so far, without intervals: "
                                   "reduced chi-square {:.3g}.",
                                   reached.reduced_chi2())}};
}

void run_fit(const Setup& setup, const json& request, const Emit& emit) {
  const plant::PlantModel model = with_plant(setup.model, request.at("plant"));
  const std::string kind = request.at("kind");
  std::mutex lock;  // messages come from several threads
  const Emit one_at_a_time = [&](const json& message) {
    const std::lock_guard guard(lock);
    emit(message);
  };
  try {
    if (kind == "diagnose") {
      const auto out =
          calibrate::held_out_events(setup.records, request.value("held_out", std::vector<std::string>{}));
      std::vector<record::Record> seen;
      for (std::size_t k = 0; k < setup.records.size(); ++k)
        if (!out[k]) seen.push_back(setup.records[k]);
      run_diagnosis(setup, model, seen, one_at_a_time);
    } else if (kind == "add") {
      run_addition(setup, model, request, one_at_a_time);
    } else {
      run_calibration(setup, model, request, one_at_a_time);
    }
  } catch (const fit::InterruptedFit& stopped) {
    emit(step_so_far(request, model, stopped.reached));
  } catch (const Interrupted&) {
    emit({{"type", "failed"}, {"text", "Stopped. The model is unchanged."}});
  } catch (const std::exception& error) {
    emit({{"type", "failed"}, {"text", error.what()}});
  }
}

Step step_of_fit(const Setup& setup, const Step& from, int parent, const json& message) {
  Step s;
  const std::string kind = message.at("kind");
  s.kind = kind == "added" ? Step::Kind::added : Step::Kind::calibrated;
  s.parent = parent;
  s.label = message.at("label");
  s.sentence = message.at("sentence");
  s.held_out = message.at("held_out").get<std::vector<std::string>>();
  if (message.contains("evidence") && message["evidence"].is_number()) s.evidence = message["evidence"];
  for (const auto& p : message.at("parameters"))
    if (p.at("low").is_number() && p.at("high").is_number())
      s.intervals.push_back({p.at("name"), p.at("low"), p.at("high")});
  s.fitted = true;
  s.bands = message.at("bands").get<calibrate::ResponseBands>();
  s.model = with_plant(from.model, message.at("plant"));
  if (message.value("stopped", false)) return s;  // no command line gives these values
  std::string held_out;
  for (const auto& name : s.held_out) held_out += " --hold-out " + shell_word(name);
  const std::string effect = message.value("effect", "");
  s.command =
      fmt::format("swingbank {} --model {}{}{}", kind == "added" ? "add " + shell_word(effect) : "calibrate",
                  parent == 0 ? shell_word(setup.plant_file) : "model.toml", setup.options, held_out);
  return s;
}

}  // namespace swingbank::validate::live
