// Fleet files: bytes -> plants with their models and records.
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"
#include "validate/fleet/fleet_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const auto file = fuzz::in_a_file({reinterpret_cast<const char*>(data), size}, "fleet.toml");
  validate::fleet::Fleet fleet;
  if (!fuzz::accepted([&] { fleet = validate::fleet::load_fleet(file); })) return 0;
  fuzz::require(!fleet.plants.empty(), "a fleet has plants");
  for (const auto& plant : fleet.plants) {
    fuzz::require(plant.name.find_first_of("/.\\") == std::string::npos,
                  "a plant's name is that of a folder");
    fuzz::require(!plant.records.empty(), "a plant has records");
  }
  return 0;
}
