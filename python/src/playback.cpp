// Python's Playback and Comparison: records played into a plant, with measured and modelled channels and
// verdicts.
#include <fmt/format.h>

#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/compare/report.hpp"

namespace swingbank::python {
namespace {

using compare::ChannelComparison, compare::EventComparison, compare::WindowError;

compare::CompareOptions options_of(const PlayOptions& asked) {
  if (asked.input != "voltage" && asked.input != "pq")
    throw InputError({"input '" + asked.input + "'", "input", "there is no such input",
                      "choose \"voltage\" (P and Q are compared) or \"pq\" (the reverse)"});
  compare::CompareOptions options;
  options.input = asked.input == "pq" ? compare::PlaybackInput::power : compare::PlaybackInput::voltage;
  options.fit_switchings = asked.fit_switchings;
  options.play_in.pre_event = asked.pre_event;
  return options;
}

/// Adds the warnings about a record to the notes of its playback, as `swingbank compare` does.
void add_warnings(const Record& record, EventComparison& event) {
  event.notes.insert(event.notes.begin(), record.warnings.begin(), record.warnings.end());
}

/// Channel of a playback; shares ownership of the playback.
struct Channel {
  std::shared_ptr<const Playback> of;
  std::size_t index;
  [[nodiscard]] const ChannelComparison& get() const { return of->event.channels[index]; }
};

std::shared_ptr<Channel> channel(const std::shared_ptr<Playback>& of, const std::string& name) {
  for (std::size_t k = 0; k < of->event.channels.size(); ++k)
    if (of->event.channels[k].name == name) return std::make_shared<Channel>(of, k);
  throw py::key_error(name);
}

std::vector<std::shared_ptr<Channel>> channels(const std::shared_ptr<Playback>& of) {
  std::vector<std::shared_ptr<Channel>> all;
  for (std::size_t k = 0; k < of->event.channels.size(); ++k) all.push_back(std::make_shared<Channel>(of, k));
  return all;
}

py::dict windows(const Channel& c) {
  py::dict all;
  for (std::size_t k = 0; k < c.get().windows.size(); ++k) {
    const WindowError& w = c.get().windows[k];
    const double scale = c.get().scale;
    py::dict row;
    row["samples"] = w.samples;
    row["rms"] = w.rms * scale;
    row["mean"] = w.mean * scale;
    row["worst"] = w.worst * scale;
    row["worst_at"] = w.worst_at;
    all[py::str(c.of->event.windows[k].name)] = row;
  }
  return all;
}

std::vector<double> switching_times(const Playback& p) {
  std::vector<double> times;
  for (const auto& s : p.event.switchings) times.push_back(s.time);
  return times;
}

/// Returns copies of the events, because the reports take them by value.
std::vector<EventComparison> events_of(const Comparison& c) {
  std::vector<EventComparison> events;
  for (const auto& e : c.events) events.push_back(e->event);
  return events;
}

std::string json_of(const Comparison& c) {
  const auto events = events_of(c);
  return compare::json_report(*c.plant, events, c.adequacy, c.fitness, compare::handed_in(*c.plant, events),
                              compare::provenance(*c.plant, events, "swingbank.Plant.compare"));
}

std::string page_of(const Comparison& c) {
  const auto events = events_of(c);
  return compare::html_report(*c.plant, events, c.adequacy, c.fitness, compare::handed_in(*c.plant, events),
                              compare::provenance(*c.plant, events, "swingbank.Plant.compare"));
}

void bind_channel(py::module_& module) {
  const auto scaled = [](std::vector<double> ChannelComparison::*values) {
    return [values](const Channel& c) { return array(c.get().*values, c.get().scale); };
  };
  const auto error = [](double WindowError::*value) {
    return [value](const Channel& c) { return c.get().whole.*value * c.get().scale; };
  };
  py::class_<Channel, std::shared_ptr<Channel>>(module, "Channel",
                                                "Measured and modelled samples of one channel of a playback.")
      .def_property_readonly("name", [](const Channel& c) { return c.get().name; })
      .def_property_readonly("unit", [](const Channel& c) { return c.get().unit; })
      .def_property_readonly("measured", scaled(&ChannelComparison::measured),
                             "Measured samples, shape (samples,) [unit].")
      .def_property_readonly("modelled", scaled(&ChannelComparison::modelled),
                             "Modelled samples, shape (samples,) [unit].")
      .def_property_readonly("residual", scaled(&ChannelComparison::residual),
                             "Modelled minus measured, shape (samples,) [unit].")
      .def_property_readonly(
          "noise", [](const Channel& c) { return c.get().noise * c.get().scale; },
          "Standard deviation of the residual before the event [unit].")
      .def_property_readonly("rms", error(&WindowError::rms), "RMS error of the whole record [unit].")
      .def_property_readonly("worst", error(&WindowError::worst), "Largest error of the record [unit].")
      .def_property_readonly(
          "worst_at", [](const Channel& c) { return c.get().whole.worst_at; },
          "Time of the largest error [s].")
      .def_property_readonly(
          "ratio", [](const Channel& c) { return c.get().whole.in_noise; },
          "RMS error / noise [-]; NaN if the record has no noise.")
      .def_property_readonly("windows", &windows,
                             "Errors by time window: samples, rms, mean, worst [unit], worst_at [s].")
      .def("__repr__", [](const Channel& c) {
        return fmt::format("<swingbank.Channel {}: RMS error {:.4g} {}, {:.3g} times the noise>",
                           c.get().name, c.get().whole.rms * c.get().scale, c.get().unit,
                           c.get().whole.in_noise);
      });
}

void bind_playback_class(py::module_& module) {
  py::class_<Playback, std::shared_ptr<Playback>>(module, "Playback", "One record played into a plant.")
      .def_property_readonly("name", [](const Playback& p) { return p.event.record.name; })
      .def_property_readonly(
          "title", [](const Playback& p) { return compare::event_title(p.event); },
          "Description of the event: \"fault at 2.000 s, 100 ms\".")
      .def_property_readonly(
          "t", [](const Playback& p) { return array(p.event.record.t); }, "Times, shape (samples,) [s].")
      .def_property_readonly("switching_times", &switching_times, "Switching times that were used [s].")
      .def_property_readonly(
          "channels", &channels,
          "Compared channels: P and Q (with input=\"pq\": V and its angle), then recorded states.")
      .def_readonly("complete", &Playback::complete,
                    "Whether only noise remains in this event; of a Comparison: in all its events.")
      .def_property_readonly(
          "notes", [](const Playback& p) { return p.event.notes; },
          "Notes on the record and on its playback.")
      .def("__getitem__", &channel, py::arg("channel"), "Returns a channel by name: playback[\"Q\"].")
      .def("_repr_html_", [](const Playback& p) { return html_of(p); })
      .def("__repr__", [](const Playback& p) {
        std::string text = "<swingbank.Playback " + p.event.record.name + ":";
        for (const auto& c : p.event.channels)
          text += fmt::format(" {} {:.3g} times the noise,", c.name, c.whole.in_noise);
        text.back() = '>';
        return text;
      });
}

void bind_comparison(py::module_& module) {
  py::class_<Comparison, std::shared_ptr<Comparison>>(
      module, "Comparison", "Several records played into a plant, and its verdicts.")
      .def_readonly("events", &Comparison::events, "One Playback for each record.")
      .def_property_readonly(
          "complete", [](const Comparison& c) { return c.adequacy.adequate; },
          "Whether the model is statistically complete: only noise remains.")
      .def_property_readonly(
          "fit_for_purpose",
          [](const Comparison& c) {
            return c.fitness.not_judged.empty() ? std::optional<bool>(c.fitness.fit) : std::nullopt;
          },
          "Whether every error is within its engineering limit; None if nothing was judged.")
      .def_property_readonly(
          "sentence", [](const Comparison& c) { return c.fitness.sentence + "\n" + c.adequacy.sentence; },
          "Both verdicts in words.")
      .def(
          "to_dict", [](const Comparison& c) { return from_json(json_of(c)); },
          "Returns the content of compare.json: verdicts, errors, bins, provenance; values in pu.")
      .def("to_html", &page_of, "Returns report.html of `swingbank compare`, a self-contained page.")
      .def("_repr_html_", [](const Comparison& c) { return html_of(c); })
      .def("__repr__",
           [](const Comparison& c) { return "<swingbank.Comparison: " + c.fitness.sentence + ">"; });
}

}  // namespace

std::shared_ptr<Playback> play(const std::shared_ptr<const Plant>& plant, const Record& record,
                               const PlayOptions& asked) {
  const compare::CompareOptions options = options_of(asked);
  auto samples = samples_of({record}, asked.power_only);
  return without_lock([&] {
    std::vector<EventComparison> one = {compare::compare_event(*plant, std::move(samples.front()), options)};
    const bool complete = compare::judge(one).adequate;
    add_warnings(record, one.front());
    return std::make_shared<Playback>(Playback{plant, std::move(one.front()), complete});
  });
}

std::shared_ptr<Comparison> compare_all(const std::shared_ptr<const Plant>& plant,
                                        const std::vector<Record>& records, const PlayOptions& asked,
                                        const std::string& accept) {
  const compare::CompareOptions options = options_of(asked);
  const auto samples = samples_of(records, asked.power_only);
  return without_lock([&] {
    const auto by = thresholds::read_acceptance(accept);
    compare::Played played = compare::play_and_judge(
        "model", *plant, compare::measurements(samples, options, plant->plant.mva), options, by);
    if (played.events.empty())
      throw InputError({"the model cannot be simulated with the records", plant->origin,
                        played.fitness.not_judged, "correct the model's parameters or the record"});
    auto result = std::make_shared<Comparison>();
    result->plant = plant;
    result->adequacy = compare::judge(played.events);
    result->fitness = std::move(played.fitness);
    for (std::size_t k = 0; k < played.events.size(); ++k) {
      add_warnings(records[k], played.events[k]);
      result->events.push_back(std::make_shared<Playback>(
          Playback{plant, std::move(played.events[k]), result->adequacy.adequate}));
    }
    return result;
  });
}

void bind_playback(py::module_& module, PlantClass& of) {
  bind_channel(module);
  bind_playback_class(module);
  bind_comparison(module);
  of.def(
        "play",
        [](const std::shared_ptr<Plant>& self, const py::object& record, const std::string& input,
           bool power_only, bool fit_switchings, double pre_event) {
          const auto records = records_of(*self, record);
          if (records.size() != 1) throw py::value_error("play takes one record; compare takes several");
          return play(self, records.front(), {power_only, fit_switchings, input, pre_event});
        },
        py::arg("record"), py::kw_only(), py::arg("input") = "voltage", py::arg("power_only") = false,
        py::arg("fit_switchings") = true, py::arg("pre_event") = 1.0,
        "Plays a record (or its path) into the plant, as `swingbank compare` does.\n\n"
        "`input`: \"voltage\" plays V and its angle in and compares P and Q; \"pq\" does the reverse.\n"
        "`power_only`: the recorded speed, Efd and Ifd are not compared.\n"
        "`fit_switchings`: detected switching times are fitted within their sample interval.\n"
        "`pre_event`: length of the steady window of a record without switchings [s].")
      .def(
          "compare",
          [](const std::shared_ptr<Plant>& self, const py::object& records, const std::string& input,
             bool power_only, bool fit_switchings, double pre_event, const std::string& accept) {
            return compare_all(self, records_of(*self, records),
                               {power_only, fit_switchings, input, pre_event}, accept);
          },
          py::arg("records"), py::kw_only(), py::arg("input") = "voltage", py::arg("power_only") = false,
          py::arg("fit_switchings") = true, py::arg("pre_event") = 1.0, py::arg("accept") = "",
          "Plays records (or their paths) into the plant and judges it, as `swingbank compare` does.\n\n"
          "`accept`: preset or file with the engineering limits; others as for `play`.");
}

}  // namespace swingbank::python
