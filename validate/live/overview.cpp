#include "validate/live/overview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/shell_word.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/fit/axis.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/live/detail/number.hpp"

namespace swingbank::validate::live {
namespace {

using nlohmann::json;

/// The slider of a positive parameter extends at most from 1/kSliderReach to kSliderReach times its value.
constexpr double kSliderReach = 30;

/// Returns the sliders of a model: one for every parameter that is not a code.
json sliders(const Setup& setup, const Step& step) {
  json all = json::array();
  const auto& plant = step.model.plant;
  const auto free = fit::free_parameters(plant, setup.prior_sd);
  for (int block = 0; block < sim::plant::block_count(plant); ++block)
    for (const auto id : sim::plant::parameters_of(plant, block)) {
      const sim::Parameter& p = parameter_record(plant, id);
      if (p.is_code()) continue;
      const double value = parameter_value(plant, id);
      const auto name = parameter_name(plant, id);
      const fit::Axis axis = fit::make_axis(plant, {id, setup.prior_sd});
      double low = std::min(axis.low, value), high = std::max(axis.high, value);
      if (axis.logarithmic)
        low = std::max(low, value / kSliderReach), high = std::min(high, value * kSliderReach);
      const auto interval = std::ranges::find(step.intervals, name.text(), &Interval::name);
      const auto submitted = sim::plant::same_parameter(setup.model.plant, plant, id);
      json s = {{"name", name.text()},
                {"block", name.effect},
                {"key", std::string(p.name)},
                {"symbol", std::string(p.symbol)},
                {"unit", p.unit == "-" ? std::string() : std::string(p.unit)},
                {"meaning", std::string(p.meaning)},
                {"value", value},
                {"low", low},
                {"high", high},
                {"usual", {number(p.low), number(p.high)}},
                {"log", axis.logarithmic},
                {"fitted", std::ranges::any_of(free, [&](const auto& f) { return f.id == id; })}};
      if (submitted) s["submitted"] = parameter_value(setup.model.plant, *submitted);
      if (interval != step.intervals.end()) s["interval"] = {number(interval->low), number(interval->high)};
      all.push_back(std::move(s));
    }
  return all;
}

/// Returns the windows of a channel's error map. Each bin contains the normalised RMS, its bound, and the RMS
/// [unit of the channel]; an empty bin is null.
json map_of(const compare::EventComparison& e, const compare::ChannelComparison& c) {
  json rows = json::array();
  for (std::size_t w = 0; w < c.map.rows.size(); ++w) {
    const auto bin = [&](const compare::TimeFrequencyBin& b) {
      return b.empty() ? json(nullptr)
                       : json::array({number(b.normalised), number(b.bound), number(b.rms * c.scale)});
    };
    json bands = json::array({bin(c.map.rows[w].all)});
    for (const auto& b : c.map.rows[w].bands) bands.push_back(bin(b));
    rows.push_back({{"window", e.windows[w].name},
                    {"from", e.windows[w].from},
                    {"to", e.windows[w].to},
                    {"bins", bands}});
  }
  return rows;
}

/// Returns the maximum errors (MXE) that the limits allow before, in and after the fault [unit of the
/// channel].
json allowed_errors(const compare::Fitness& fitness, const compare::EventComparison& event,
                    const compare::ChannelComparison& c) {
  json all = json::array({nullptr, nullptr, nullptr});
  bool any = false;
  for (const auto& row : fitness.rows)
    if (row.event == event.record.name && row.channel == c.name && row.switched) {
      all[static_cast<std::size_t>(row.phase)] = number(row.limits.mxe / 100 * fitness.mva);
      any = true;
    }
  return any ? all : json(nullptr);
}

/// Returns the errors of each channel of each event, for the chips of the page.
json chips(const Step& step) {
  json all = json::array();
  for (std::size_t e = 0; e < step.played->events.size(); ++e) {
    const auto& event = step.played->events[e];
    for (std::size_t k = 0; k < event.channels.size(); ++k) {
      const auto& c = event.channels[k];
      const compare::ChannelError error = compare::channel_error(step.played->fitness, event, c);
      all.push_back({{"event", e},
                     {"channel", k},
                     {"name", c.name},
                     {"unit", c.unit},
                     {"scale", c.scale},
                     {"rms", number(c.whole.rms * c.scale)},
                     {"noise", number(c.noise * c.scale)},
                     {"ratio", number(c.whole.in_noise)},
                     {"worst", number(c.whole.worst * c.scale)},
                     {"worst_at", c.whole.worst_at},
                     {"judged", c.judged},
                     {"bound", number(error.bound)},
                     {"limit", number(error.limit)},
                     {"window", error.window},
                     {"size", number(c.size * c.scale)},
                     {"allowed", allowed_errors(step.played->fitness, event, c)},
                     {"map", map_of(event, c)}});
    }
  }
  return all;
}

std::string kind_name(Step::Kind kind) {
  switch (kind) {
    case Step::Kind::submitted:
      return "submitted";
    case Step::Kind::manual:
      return "manual";
    case Step::Kind::added:
      return "added";
    case Step::Kind::calibrated:
      return "calibrated";
  }
  return "";
}

}  // namespace

nlohmann::json setup_json(const Setup& setup, const Step& submitted) {
  json events = json::array();
  for (std::size_t k = 0; k < submitted.played->events.size(); ++k) {
    const auto& e = submitted.played->events[k];
    json one = {{"name", e.record.name},
                {"title", compare::event_title(e)},
                {"notes", e.notes},
                {"samples", e.record.samples()}};
    if (k < setup.warnings.size())
      for (const auto& w : setup.warnings[k]) one["notes"].push_back(w);
    events.push_back(std::move(one));
  }
  json bands = json::array({"all"});
  for (const auto& b : compare::error_bands()) bands.push_back(std::string(b.name));
  return {{"name", setup.model.name},
          {"mva", setup.model.plant.mva},
          {"subject", plant::subject(setup.model)},
          {"file", shell_word(setup.plant_file)},
          {"limits", setup.by.name},
          {"events", events},
          {"bands", bands},
          {"options", setup.options}};
}

nlohmann::json step_json(const Setup& setup, const Step& step, int number_of) {
  json blocks = json::array();
  for (int k = 0; k < sim::plant::block_count(step.model.plant); ++k) {
    const sim::Effect& effect = sim::plant::block_effect(step.model.plant, k);
    blocks.push_back({{"name", std::string(effect.name)}, {"title", std::string(effect.title)}});
  }
  json switchings = json::array();
  for (const auto& e : step.played->events) {
    json times = json::array();
    for (const auto& s : e.switchings) times.push_back(s.time);
    switchings.push_back(times);
  }
  return {{"step", number_of},
          {"parent", step.parent},
          {"kind", kind_name(step.kind)},
          {"label", step.label},
          {"command", step.command},
          {"sentence", step.sentence},
          {"verdict", compare::headline(step.complete, step.played->fitness)},
          {"reason", step.provisional ? "Preliminary: the switching times are still being fitted."
                                      : step.played->fitness.sentence},
          {"provisional", step.provisional},
          {"complete", step.complete},
          {"bands", !step.bands.empty()},
          {"fit", step.played->fitness.fit},
          {"ratio", compare::largest_rms_over_noise(*step.played).first},
          {"evidence", number(step.evidence)},
          {"held_out", step.held_out},
          {"blocks", blocks},
          {"switchings", switchings},
          {"sliders", sliders(setup, step)},
          {"chips", chips(step)}};
}

std::vector<float> curves(const Step& step, std::size_t event) {
  const auto& e = step.played->events.at(event);
  std::vector<float> all(e.record.t.begin(), e.record.t.end());
  const std::vector<double> none(e.record.t.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& c : e.channels) {
    const std::vector<double>* band = &none;
    if (event < step.bands.size())
      if (const auto found = step.bands[event].find(c.name);
          found != step.bands[event].end() && found->second.size() == none.size())
        band = &found->second;
    for (const auto* values : {&c.measured, &c.modelled, band})
      for (const double v : *values) all.push_back(static_cast<float>(v * c.scale));
  }
  return all;
}

std::vector<float> preview_floats(const Preview& preview, const compare::EventComparison& event) {
  std::vector<float> all;
  for (std::size_t k = 0; k < preview.channels.size(); ++k) {
    const auto& c = preview.channels[k];
    const double scale = event.channels[k].scale;
    all.push_back(static_cast<float>(c.whole.rms * scale));
    all.push_back(static_cast<float>(c.noise * scale));
    for (const double v : c.modelled) all.push_back(static_cast<float>(v * scale));
  }
  return all;
}

std::vector<float> ribbon(const Step& step, std::size_t event, const Values& values,
                          const std::string& name) {
  const plant::PlantModel model = with_values(step.model, values);
  const auto id = find_parameter(model.plant, name);
  const double value = parameter_value(model.plant, id);
  const sim::Parameter& p = parameter_record(model.plant, id);
  const double tenth = 0.1 * (value != 0 ? std::abs(value) : p.high - p.low);
  std::vector<Preview> both;
  for (const double moved : {value - tenth, value + tenth}) {
    Values changed = values;
    std::erase_if(changed, [&](const auto& v) { return v.first == name; });
    changed.emplace_back(name, moved);
    both.push_back(preview(step, event, changed));
  }
  std::vector<float> all;
  for (std::size_t k = 0; k < both.front().channels.size(); ++k)
    for (const Preview& one : both)
      for (const double v : one.channels[k].modelled)
        all.push_back(static_cast<float>(v * step.played->events[event].channels[k].scale));
  return all;
}

nlohmann::json effects_json(const Step& step) {
  json all = json::array();
  const hypothesis::RecordContents recorded{
      step.model.reading.component,
      std::ranges::any_of(step.played->events, [](const compare::EventComparison& e) {
        return e.record.angle == record::AngleSource::integrated;
      })};
  for (const auto& h : hypothesis::all_hypotheses(step.model.under_test(), step.model.library, recorded))
    all.push_back({{"name", h.name}, {"what", h.what}, {"side", std::string(hypothesis::side_name(h.side))}});
  return all;
}

}  // namespace swingbank::validate::live
