#pragma once
// Conversion of a measured record to a network's input, with the event time, base, rate and channels of the
// training dataset.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "train/run/saved_network.hpp"
#include "validate/check/signals.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank {

/// Input of a network.
struct NetworkInput {
  std::vector<float> values;  ///< channels x samples
  double event_s = 0.0;       ///< time of the event in the record [s]
  double padding_s = 0.0;     ///< duration before the record's start, filled with steady values [s]
};

namespace record_detail {

/// Returns the record's time series for a channel of the dataset, on the machine base; empty if it was not
/// measured.
inline std::vector<double> series_of(const std::string& channel, const validate::record::Record& r,
                                     const validate::plant::PlantModel& model,
                                     const train::run::NetworkInfo& network) {
  const std::map<std::string, const std::vector<double>*> direct = {
      {"P", &r.P},         {"Q", &r.Q},     {"V", &r.V},    {"theta", &r.theta},
      {"speed", &r.speed}, {"Efd", &r.Efd}, {"Ifd", &r.Ifd}};
  if (channel == "frequency" && network.frequency) {
    std::vector<double> f(r.t.size());
    sim::terminal_frequency(r.theta.data(), r.t.size(), r.rate(), model.conventions.frequency,
                            *network.frequency, f.data());
    return f;
  }
  const auto found = direct.find(channel);
  if (found == direct.end()) return {};
  std::vector<double> x = *found->second;
  if (channel == "P" || channel == "Q")
    for (double& value : x) value *= r.base.mva / model.plant.mva;
  return x;
}

/// Returns the linear interpolation of `x` at time `at` [s], which must lie inside the record.
inline double between(const validate::record::Record& r, const std::vector<double>& x, double at) {
  const double place = (at - r.t.front()) / r.step();
  const auto left = std::min(static_cast<std::size_t>(std::max(0.0, place + 1e-9)), x.size() - 2);
  const double part = std::clamp(place - static_cast<double>(left), 0.0, 1.0);
  return x[left] + part * (x[left + 1] - x[left]);
}

}  // namespace record_detail

/// Returns the record shifted to the event time of the network's dataset and resampled at the dataset's rate.
/// The records of a dataset begin in steady state. Therefore the first sample, and all samples before the
/// record's start, are set to the median before the event. Throws InputError if no event is found, fewer than
/// five samples precede it, no sample follows it, the network lacks the time of its faults, a channel is
/// missing, or the record ends too early.
inline NetworkInput network_input(const validate::record::Record& record,
                                  const validate::plant::PlantModel& model,
                                  const train::run::NetworkInfo& network, std::optional<double> event_s) {
  Problems problems;
  const validate::check::Signals signals = validate::check::record_signals(record);
  NetworkInput in;
  std::size_t quiet = signals.onset + 1;  // number of samples before the event
  in.event_s = event_s.value_or(record.t[signals.onset]);
  if (event_s)
    quiet = static_cast<std::size_t>(
        std::ranges::count_if(record.t, [&](double t) { return t <= *event_s + 0.5 * record.step(); }));
  if (!event_s && !signals.event)
    problems.add("no event", record.name, "no signal exceeds the noise",
                 "give --event with its time, or another record");
  else if (constexpr std::size_t few = 5; quiet < few || quiet >= record.t.size())
    problems.add(
        fmt::format("an event at {:g} s", in.event_s), record.name,
        fmt::format("the record must contain at least {} samples before the event, and some after it", few),
        "give a record that begins earlier, or one that ends later");
  if (!network.fault_start)
    problems.add("network without the time of its faults", network.run,
                 "its dataset has no time of the faults", "train it on a dataset that `generate` made");
  problems.raise();
  const double shift = in.event_s - *network.fault_start;
  const double last = shift + static_cast<double>(network.samples - 1) / network.rate;
  if (last > record.t.back() + 0.5 * record.step())
    problems.add(fmt::format("a record until {:g} s", record.t.back()), record.name,
                 fmt::format("the network needs samples until {:g} s ({:g} s after the event)", last,
                             last - in.event_s),
                 "give a longer record");
  in.padding_s = std::max(0.0, record.t.front() - shift);
  for (const auto& channel : network.channels) {
    const auto x = record_detail::series_of(channel, record, model, network);
    if (x.empty()) {
      problems.add("channel " + channel, record.name,
                   "the network reads it, and the record does not contain it",
                   "give a record with it, or a network trained without it");
      continue;
    }
    const double level =
        validate::check::median_of({x.begin(), x.begin() + static_cast<std::ptrdiff_t>(quiet)});
    for (std::size_t k = 0; k < network.samples; ++k) {
      const double t = shift + static_cast<double>(k) / network.rate;
      const bool before = k == 0 || t < record.t.front();
      in.values.push_back(static_cast<float>(before ? level : record_detail::between(record, x, t)));
    }
  }
  problems.raise();
  return in;
}

}  // namespace swingbank
