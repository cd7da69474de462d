// User-defined models: bytes -> effect -> round-rotor machine with this effect at its operating point.
#include "sim/user_models/user_model.hpp"

#include "sim/grid/grid.hpp"
#include "sim/library/library.hpp"
#include "tests/fuzz/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::Effect user_model;
  if (!fuzz::accepted([&] { user_model = sim::user_models::make_user_model(text, "law.toml"); })) return 0;
  static const sim::Effect* const machine = sim::library::compiled().find("GENROU");
  sim::plant::Plant plant;
  plant.name = "fuzzed";
  plant.generation = {0.5, 0.1};  // [pu on 100 MVA]
  plant.machine = {machine, machine->default_parameters()};
  plant.controls = {{&user_model, user_model.default_parameters()}};
  sim::plant::Operating point;
  if (!fuzz::accepted(
          [&] { point = sim::plant::operating_point(plant, 1.0, 100.0, sim::Conventions::psse()); }))
    return 0;
  for (const double v : point.x) fuzz::require(std::isfinite(v), "states are finite");
  for (const double v : point.c) fuzz::require(std::isfinite(v), "coefficients are finite");
  return 0;
}
