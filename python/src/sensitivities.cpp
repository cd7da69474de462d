// Python's Sensitivities: derivatives of the compared channels with respect to parameters, over one event.
#include <fmt/format.h>

#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/event/play.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::python {
namespace {

using playin::SensitivityParameter, sim::plant::ParameterId;

/// Derivatives [parameter][channel][sample] in channel unit per parameter unit.
struct Sensitivities {
  std::vector<double> t;
  std::vector<std::string> parameters, parameter_units, channels, channel_units;
  std::vector<double> values;
};

std::vector<ParameterId> chosen(const Plant& plant, const std::vector<std::string>& names) {
  std::vector<ParameterId> free, all;
  for (const auto& f : fit::free_parameters(plant.plant, thresholds::parameters.prior_sd))
    free.push_back(f.id);
  if (names.empty()) return free;
  for (int block = 0; block < sim::plant::block_count(plant.plant); ++block)
    for (const ParameterId id : parameters_of(plant.plant, block)) all.push_back(id);
  Problems problems;
  auto found = find_parameters(plant.plant, all, names, "Plant.sensitivities",
                               "the plant has no such parameter", problems);
  problems.raise();
  return found;
}

Sensitivities sensitivities(const Playback& p, const std::vector<ParameterId>& along) {
  std::vector<SensitivityParameter> parameters;
  for (const ParameterId id : along)
    parameters.push_back({.kind = SensitivityParameter::Kind::parameter, .parameter = id});
  const auto response = event::play(p.plant->under_test(), *p.event.prepared, p.event.state, parameters);
  Sensitivities s;
  s.t = p.event.record.t;
  for (const ParameterId id : along) {
    s.parameters.push_back(parameter_name(p.plant->plant, id).text());
    s.parameter_units.emplace_back(parameter_record(p.plant->plant, id).unit);
  }
  for (const playin::Output o : p.event.prepared->channels) {
    s.channels.emplace_back(playin::output_name(o));
    s.channel_units.push_back(compare::channel_unit(o, p.event.record.base).name);
  }
  for (const auto& one : response.sensitivities)
    for (const playin::Output o : p.event.prepared->channels)
      for (const double v : one.value[static_cast<int>(o)])
        s.values.push_back(v * compare::channel_unit(o, p.event.record.base).scale);
  return s;
}

py::array_t<double> values(const Sensitivities& s) {
  py::array_t<double> all({s.parameters.size(), s.channels.size(), s.t.size()});
  std::ranges::copy(s.values, all.mutable_data());
  return all;
}

}  // namespace

void bind_sensitivities(py::module_& module, PlantClass& of) {
  py::class_<Sensitivities>(
      module, "Sensitivities",
      "Derivatives of the compared channels (P and Q; speed, Efd and Ifd if recorded) with "
      "respect to the plant's parameters.")
      .def_property_readonly(
          "t", [](const Sensitivities& s) { return array(s.t); }, "Times, shape (samples,) [s].")
      .def_readonly("parameters", &Sensitivities::parameters, "Names, \"GENROU.H\".")
      .def_readonly("parameter_units", &Sensitivities::parameter_units)
      .def_readonly("channels", &Sensitivities::channels, "Names, \"P\".")
      .def_readonly("channel_units", &Sensitivities::channel_units)
      .def_property_readonly("values", &values,
                             "Shape (parameters, channels, samples) [channel unit / parameter unit].");
  of.def(
      "sensitivities",
      [](const std::shared_ptr<Plant>& self, const py::object& record,
         const std::vector<std::string>& parameters, bool power_only) {
        const auto along = chosen(*self, parameters);
        const auto records = records_of(*self, record);
        if (records.size() != 1) throw py::value_error("sensitivities takes one record");
        const auto played = play(self, records.front(), {power_only});
        return without_lock([&] { return sensitivities(*played, along); });
      },
      py::arg("record"), py::arg("parameters") = std::vector<std::string>{}, py::kw_only(),
      py::arg("power_only") = false,
      "Returns the derivatives of the compared channels along a record, at the plant's values.\n\n"
      "`parameters`: names such as \"GENROU.H\"; default: those that `calibrate` may fit.");
}

}  // namespace swingbank::python
