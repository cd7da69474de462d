// Python's Plant: reading, parameters, changed copies and export of a plant model.
#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "python/src/fitted.hpp"
#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "sim/grid/unit.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/event/component_model.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::python {
namespace {

using sim::plant::ParameterId;
using Path = std::filesystem::path;

/// Python's Parameter: one value of a plant with its definition.
struct PlantParameter {
  std::string name, symbol, unit, meaning;
  double value, low, high;
};

std::vector<ParameterId> all_parameters(const sim::plant::Plant& plant) {
  std::vector<ParameterId> all;
  for (int block = 0; block < sim::plant::block_count(plant); ++block)
    for (const ParameterId id : parameters_of(plant, block)) all.push_back(id);
  return all;
}

std::map<std::string, PlantParameter> plant_parameters(const Plant& model) {
  std::map<std::string, PlantParameter> all;
  for (const ParameterId id : all_parameters(model.plant)) {
    const sim::Parameter& p = parameter_record(model.plant, id);
    const std::string name = parameter_name(model.plant, id).text();
    all.insert({name,
                {name, std::string(p.symbol), std::string(p.unit), std::string(p.meaning),
                 parameter_value(model.plant, id), p.low, p.high}});
  }
  return all;
}

void check_values(const Plant& model, Problems& problems) {
  for (int k = 0; k < sim::plant::block_count(model.plant); ++k) {
    const auto& block = sim::plant::block_at(model.plant, k);
    if (block.effect->check != nullptr)
      block.effect->check(block.effect->user_model.get(), block.p.data(), std::string(block.effect->name),
                          problems);
  }
}

std::shared_ptr<Plant> with_values(const Plant& model, const std::map<std::string, double>& values) {
  auto changed = std::make_shared<Plant>(model);
  Problems problems;
  for (const auto& [name, value] : values)
    for (const ParameterId id :
         find_parameters(model.plant, all_parameters(model.plant), {name}, "Plant.with_values",
                         "the plant has no such parameter", problems))
      parameter_value(changed->plant, id) = value;
  problems.raise();
  check_values(*changed, problems);
  problems.raise();
  return changed;
}

std::shared_ptr<Plant> read(const Path& file, const std::vector<Path>& user_models) {
  return std::make_shared<Plant>(without_lock([&] { return plant::load_plant_model(file, user_models); }));
}

std::shared_ptr<Plant> from_case(const Path& raw, const Path& dyr, int bus, const std::string& id,
                                 std::optional<double> frequency_hz) {
  return without_lock([&] {
    sim::grid::UnitChoice choice;
    choice.raw = raw;
    choice.dyr = dyr;
    choice.bus = bus;
    choice.id = id;
    choice.frequency_hz = frequency_hz;
    const sim::grid::Unit unit = sim::grid::read_unit(choice);
    return std::make_shared<Plant>(plant::model_of_unit(unit, sim::Conventions::psse(unit.frequency),
                                                        raw.string() + " and " + dyr.string()));
  });
}

std::string dyr_text(const Plant& model) {
  Problems problems;
  std::string text = plant::dyr_text(model, {}, model.origin, problems);
  problems.raise();
  return text;
}

record::Component component_of(const std::string& name) {
  using record::Component;
  for (const auto c : {Component::exciter, Component::governor, Component::machine})
    if (name == record::component_name(c)) return c;
  throw InputError({"component '" + name + "'", "Plant.component", "a plant has no such component",
                    "choose exciter, governor or machine"});
}

std::vector<std::string> effects_of(const Plant& model) {
  std::vector<std::string> names;
  for (int k = 0; k < sim::plant::block_count(model.plant); ++k)
    names.emplace_back(sim::plant::block_effect(model.plant, k).name);
  return names;
}

std::string shown_as(const Plant& model) {
  return fmt::format("<swingbank.Plant {}: {} of {:g} MVA>", model.name, plant::subject(model),
                     model.plant.mva);
}

std::string parameter_table(const Plant& model) {
  report::Table table{shown_as(model), {"parameter", "value", "unit", "meaning"}, {}};
  for (const auto& [name, p] : plant_parameters(model))
    table.rows.push_back({name, fmt::format("{:.5g}", p.value), p.unit, p.meaning});
  return table_html(table);
}

void bind_plant_parameter(py::module_& module) {
  py::class_<PlantParameter>(module, "Parameter", "One parameter of a plant with its definition.")
      .def_readonly("name", &PlantParameter::name, "\"GENROU.H\"")
      .def_readonly("symbol", &PlantParameter::symbol, "Usual notation, \"X'd\".")
      .def_readonly("unit", &PlantParameter::unit)
      .def_readonly("meaning", &PlantParameter::meaning)
      .def_readonly("value", &PlantParameter::value, "Value [unit].")
      .def_readonly("low", &PlantParameter::low, "Lower end of the usual range [unit].")
      .def_readonly("high", &PlantParameter::high, "Upper end of the usual range [unit].")
      .def("__repr__", [](const PlantParameter& p) {
        return fmt::format("<swingbank.Parameter {} = {:g} {}>", p.name, p.value, p.unit);
      });
}

}  // namespace

PlantClass bind_plant(py::module_& module) {
  bind_plant_parameter(module);
  PlantClass of(module, "Plant", "Model of one plant. Immutable: every change returns another plant.");
  of.def(py::init(&read), py::arg("file"), py::arg("user_models") = std::vector<Path>{},
         "Reads a plant file (.toml). `user_models`: files of user-defined models that it may use.\n\n"
         "Raises InputError with every fault of the file.")
      .def_static(
          "from_text",
          [](const std::string& text, const Path& file) {
            return std::make_shared<Plant>(plant::parse_plant_model(text, file));
          },
          py::arg("text"), py::arg("file") = Path("plant.toml"),
          "Reads a plant from the text of a plant file; `file` names it in messages.")
      .def_static("from_case", &from_case, py::arg("raw"), py::arg("dyr"), py::arg("bus"), py::arg("id") = "",
                  py::arg("frequency_hz") = py::none(),
                  "Extracts the unit at bus number `bus` of a PSS/E, PSLF or MATPOWER case.\n\n"
                  "`frequency_hz`: system frequency [Hz] if the network has none.")
      .def_readonly("name", &Plant::name)
      .def_readonly("origin", &Plant::origin, "File from which the plant was read.")
      .def_readonly("warnings", &Plant::warnings, "Suspicious entries of the file, with their lines.")
      .def_readonly("defaults", &Plant::defaults, "Parameters that the file leaves at default values.")
      .def_property_readonly(
          "mva", [](const Plant& p) { return p.plant.mva; }, "Base of the machine [MVA].")
      .def_property_readonly("effects", &effects_of, "Names of the plant's effects, machine first.")
      .def_property_readonly("parameters", &plant_parameters,
                             "Parameters by name: {\"GENROU.H\": Parameter}.")
      .def("with_values", &with_values, py::arg("values"),
           "Returns the plant with other values, {\"GENROU.H\": 5.0} [unit of each parameter].\n\n"
           "Raises InputError for unknown names and values that the equations do not allow.")
      .def(
          "component",
          [](const Plant& p, const std::string& name) {
            return std::make_shared<Plant>(event::component_model(p, component_of(name)));
          },
          py::arg("name"), "Returns the model of \"exciter\", \"governor\" or \"machine\" alone.")
      .def(
          "text", [](const Plant& p) { return plant::plant_text(p, {}); },
          "Returns the text of the plant file, exact to the last bit.")
      .def(
          "save", [](const Plant& p, const Path& file) { plant::write_plant_file(file, p, {}); },
          py::arg("file"), "Writes the plant file, and its user-defined models beside it.")
      .def("dyr", &dyr_text, "Returns the records of machine and controls for a PSS/E .dyr file.")
      .def("__getitem__",
           [](const Plant& p, const std::string& name) {
             const auto all = plant_parameters(p);
             const auto found = all.find(name);
             if (found == all.end()) throw py::key_error(name);
             return found->second.value;
           })
      .def("_repr_html_", &parameter_table)
      .def("__repr__", &shown_as);
  return of;
}

}  // namespace swingbank::python
