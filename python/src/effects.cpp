// Python's Effect: the simulator's model components with their parameters and states.
#include <cmath>

#include "python/src/native.hpp"
#include "sim/library/library.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::python {
namespace {

using sim::Effect, sim::Parameter, sim::State;

/// Effect with the library that owns it.
struct OwnedEffect {
  sim::library::EffectLibrary library;
  const Effect* effect;
};

std::string text(std::string_view view) { return std::string(view); }

std::optional<double> null_value(const Parameter& p) {
  return std::isnan(p.null_value) ? std::nullopt : std::optional<double>(p.null_value);
}

std::vector<Parameter> parameters(const OwnedEffect& e) {
  return {e.effect->parameters.begin(), e.effect->parameters.end()};
}

std::vector<py::tuple> states(const OwnedEffect& e) {
  std::vector<py::tuple> all;
  for (const State& s : e.effect->states)
    all.push_back(py::make_tuple(text(s.name), text(s.unit), text(s.meaning)));
  return all;
}

std::vector<OwnedEffect> effects(const std::vector<std::filesystem::path>& user_models) {
  sim::library::EffectLibrary library;
  for (const auto& file : user_models) sim::user_models::load_user_model(file, library);
  std::vector<OwnedEffect> all;
  for (const Effect* e : library.all()) all.push_back({library, e});
  return all;
}

void bind_parameter(py::module_& module) {
  const auto of = [](std::string_view Parameter::*member) {
    return [member](const Parameter& p) { return text(p.*member); };
  };
  py::class_<Parameter>(module, "EffectParameter", "Definition of one parameter of an effect.")
      .def_property_readonly("name", of(&Parameter::name))
      .def_property_readonly("symbol", of(&Parameter::symbol), "Usual notation, \"X'd\".")
      .def_property_readonly("unit", of(&Parameter::unit))
      .def_property_readonly("meaning", of(&Parameter::meaning))
      .def_readonly("default", &Parameter::default_value, "Default [unit].")
      .def_readonly("low", &Parameter::low, "Lower end of the usual range [unit].")
      .def_readonly("high", &Parameter::high, "Upper end of the usual range [unit].")
      .def_property_readonly("null_value", &null_value,
                             "Value at which the effect has no influence [unit]; None: there is none.")
      .def_property_readonly(
          "source", [](const Parameter& p) { return as_text(p.default_from); }, "Source of the default.")
      .def("__repr__", [](const Parameter& p) {
        return "<swingbank.EffectParameter " + text(p.name) + " [" + text(p.unit) + "]>";
      });
}

}  // namespace

void bind_effects(py::module_& module) {
  bind_parameter(module);
  const auto of = [](std::string_view Effect::*member) {
    return [member](const OwnedEffect& e) { return text(e.effect->*member); };
  };
  py::class_<OwnedEffect>(module, "Effect", "A model component of the simulator.")
      .def_property_readonly("name", of(&Effect::name), "\"SEXS\"")
      .def_property_readonly("title", of(&Effect::title))
      .def_property_readonly("source", of(&Effect::source), "Source of the equations.")
      .def_property_readonly("description", of(&Effect::description), "Block diagram and equations as text.")
      .def_property_readonly("dyr_name", of(&Effect::dyr_name), "PSS/E model name; empty: none.")
      .def_property_readonly(
          "slot", [](const OwnedEffect& e) { return text(kind_name(*e.effect)); }, "\"exciter\"")
      .def_property_readonly("parameters", &parameters, "A list of EffectParameter.")
      .def_property_readonly("states", &states, "States as (name, unit, meaning).")
      .def("__repr__", [](const OwnedEffect& e) {
        return "<swingbank.Effect " + text(e.effect->name) + ": " + text(e.effect->title) + ">";
      });
  module.def("effects", &effects, py::arg("user_models") = std::vector<std::filesystem::path>{},
             "Returns every effect of the simulator, and those of files of user-defined models.");
}

}  // namespace swingbank::python
