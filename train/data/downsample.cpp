#include "train/data/downsample.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/problem.hpp"
#include "train/data/noise.hpp"

namespace swingbank::train::data {

void InputSelection::apply(const float* record, std::size_t record_samples, double level, double reactance,
                           float* out) const {
  if (swing) {
    swing->apply(record, record_samples, level, reactance, out);
    out[values() - 1] = static_cast<float>(level);
    return;
  }
  if (shows_level) out[values() - 1] = level_input(level);
  if (physics) return physics->apply(record, record_samples, out);
  const auto copy = [&](bool deviation, float* to) {
    for (const std::size_t c : channels) {
      const float* series = record + c * record_samples;
      const float base = deviation ? series[0] : 0.0f;
      for (std::size_t i = 0; i < samples; ++i) *to++ = series[first + i * step] - base;
    }
  };
  if (form == InputForm::absolute || form == InputForm::both) copy(false, out);
  if (form == InputForm::absolute) return;
  float* deviations = form == InputForm::both ? out + channels.size() * samples : out;
  copy(true, deviations);
  if (form == InputForm::deviation) return;
  double square = 0.0;
  for (std::size_t i = 0; i < samples; ++i) square += static_cast<double>(deviations[i]) * deviations[i];
  const auto rms = static_cast<float>(std::sqrt(square / static_cast<double>(samples)));
  if (rms > 0.0f)
    for (std::size_t i = 0; i < channels.size() * samples; ++i) deviations[i] /= rms;
}

namespace {

/// Returns the reactance between the terminal and the internal voltage E: the middle of the interval of X''d
/// or X'd, or a typical value.
double shown_reactance(const mpi::store::DatasetHeader& d) {
  // A typical value of X'd and X''d suffices, because E is only an input.
  constexpr double kTypical = 0.3;
  for (const char* name : {"Xdpp", "Xdp"}) {
    const auto at = std::ranges::find(d.parameter_names, name) - d.parameter_names.begin();
    const auto i = static_cast<std::size_t>(at);
    if (i < d.parameter_names.size()) return 0.5 * (d.parameter_low[i] + d.parameter_high[i]);
  }
  return kTypical;
}

/// Returns the fault time of the dataset [s], before which its records are steady. Throws InputError if there
/// is none, or several.
double event_time(const mpi::store::DatasetHeader& d) {
  const auto event = mpi::store::config_numbers(d, "fault.start");
  if (event.size() != 1)
    throw InputError({"no fault time", "form",
                      "the dataset's config has no fault.start, and the steady state is measured before it",
                      "choose another form, or generate the dataset with a config that has fault.start"});
  return event.front();
}

/// Returns the names of the record's channels, with an empty name for each channel that is not requested.
std::vector<std::string> requested(const InputRecipe& recipe, const mpi::store::DatasetHeader& d) {
  std::vector<std::string> names = d.channel_names;
  for (auto& name : names)
    if (std::ranges::find(recipe.channels, name) == recipe.channels.end()) name.clear();
  return names;
}

Physics physics_of(const InputRecipe& recipe, const mpi::store::DatasetHeader& d) {
  PhysicsWindow window{d.rate, recipe.start_s, recipe.end_s, event_time(d), shown_reactance(d)};
  if (recipe.shows_level) window.least_voltage = kNoisyLeastVoltage;
  return {requested(recipe, d), window};
}

SwingIntegrals swing_of(const InputRecipe& recipe, const mpi::store::DatasetHeader& d) {
  if (std::ranges::find(d.held_names, "Xdp") == d.held_names.end())
    throw InputError({"X'd is not fixed", "form", "the rotor's angle follows from the voltage behind X'd",
                      "choose another form, or a dataset of GENCLS"});
  return {requested(recipe, d),
          {d.rate, event_time(d), recipe.start_s, recipe.end_s, d.frequency, frequency_filter(d)}};
}

}  // namespace

InputSelection select_input(const InputRecipe& recipe, const mpi::store::DatasetHeader& dataset) {
  Problems problems;
  InputSelection s;
  if (recipe.channels.empty())
    problems.add("no input channels", "channels", "a network needs at least one",
                 "name some of the dataset's channels");
  for (const auto& name : recipe.channels) {
    const auto found = std::find(dataset.channel_names.begin(), dataset.channel_names.end(), name);
    if (found == dataset.channel_names.end())
      problems.add("channel '" + name + "' is not in the dataset", "channels",
                   fmt::format("it has {}", fmt::join(dataset.channel_names, ", ")),
                   "choose among these or generate the dataset with that channel");
    s.channels.push_back(static_cast<std::size_t>(found - dataset.channel_names.begin()));
  }
  const double length = static_cast<double>(dataset.samples) / dataset.rate;
  if (recipe.slice > 1 && (recipe.form == InputForm::physics || recipe.form == InputForm::swing))
    problems.add(fmt::format("slice {}", recipe.slice), "slice",
                 "the forms physics and swing read every sample", "set slice = 1");
  if (recipe.slice < 1)
    problems.add("slice 0", "slice", "a slice keeps every n-th sample, n at least 1",
                 "use 1 to keep all samples");
  if (!(recipe.start_s >= 0.0 && recipe.start_s < recipe.end_s && recipe.end_s <= length + 1e-9))
    problems.add(fmt::format("window {} s to {} s", recipe.start_s, recipe.end_s), "start_s, end_s",
                 fmt::format("the records run from 0 to {} s", length), "choose a window within the records");
  problems.raise();
  s.first = static_cast<std::size_t>(std::lround(recipe.start_s * dataset.rate));
  const auto end = static_cast<std::size_t>(std::lround(recipe.end_s * dataset.rate));
  s.step = recipe.slice;
  s.samples = (end - s.first + s.step - 1) / s.step;
  s.form = recipe.form;
  s.seconds_as_steps = recipe.seconds_as_steps;
  s.rate = dataset.rate / static_cast<double>(s.step);
  if (s.form == InputForm::physics) {
    s.physics = physics_of(recipe, dataset);
    s.samples = s.physics->bins();
    s.shows_level = recipe.shows_level;
    s.regressions = recipe.regressions;
  }
  if (s.form == InputForm::swing) {
    s.swing = swing_of(recipe, dataset);
    s.samples = s.swing->functions();
    s.shows_level = true;
  }
  return s;
}

}  // namespace swingbank::train::data
