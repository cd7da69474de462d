#include "train/data/downsample.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/problem.hpp"

namespace swingbank::train::data {

void InputSelection::apply(const float* record, std::size_t record_samples, float* out) const {
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
  if (recipe.slice < 1)
    problems.add("slice 0", "slice", "every 0th sample is none", "use 1 to keep all samples");
  if (!(recipe.start_s >= 0.0 && recipe.start_s < recipe.end_s && recipe.end_s <= length + 1e-9))
    problems.add(fmt::format("window {} s to {} s", recipe.start_s, recipe.end_s), "start_s, end_s",
                 fmt::format("the records run from 0 to {} s", length), "choose a window inside");
  problems.raise();
  s.first = static_cast<std::size_t>(std::lround(recipe.start_s * dataset.rate));
  const auto end = static_cast<std::size_t>(std::lround(recipe.end_s * dataset.rate));
  s.step = recipe.slice;
  s.samples = (end - s.first + s.step - 1) / s.step;
  s.form = recipe.form;
  s.rate = dataset.rate / static_cast<double>(s.step);
  return s;
}

}  // namespace swingbank::train::data
