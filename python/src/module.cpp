// Extension module `swingbank._native`: the library's functions and results as Python objects.
#include "base/own_command.hpp"
#include "python/src/native.hpp"

PYBIND11_MODULE(_native, module) {
  using namespace swingbank::python;
  module.doc() = "Compiled part of the package swingbank.";
  module.attr("version") = SWINGBANK_VERSION;
  module.def(
      "set_commands_folder", [](const std::string& folder) { swingbank::jobs::commands_folder = folder; },
      py::arg("folder"),
      "Sets the folder of the commands that read HDF5 and MATLAB records in a separate process.");
  bind_errors(module);
  bind_effects(module);
  PlantClass plant = bind_plant(module);
  bind_record(module);
  bind_playback(module, plant);
  bind_sensitivities(module, plant);
  bind_fits(module, plant);
  bind_diagnosis(module, plant);
  bind_simulation(module);
}
