// Configs: bytes as TOML -> plant model -> operating point at half load.
#include "tests/fuzz/check.hpp"
#include "validate/plant/plant_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  validate::plant::PlantModel model;
  if (!fuzz::accepted([&] { model = validate::plant::parse_plant_model(text, "plant.toml"); })) return 0;
  sim::plant::Operating point;
  model.plant.generation = {0.5, 0.1};  // [pu on 100 MVA]
  if (!fuzz::accepted(
          [&] { point = sim::plant::operating_point(model.plant, 1.0, 100.0, model.conventions); }))
    return 0;
  for (const double v : point.x) fuzz::require(std::isfinite(v), "states are finite");
  for (const double v : point.c) fuzz::require(std::isfinite(v), "coefficients are finite");
  return 0;
}
