#pragma once
// A grid ready to run: network, power flow, and one plant per generator with its effects and parameters.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/library/library.hpp"
#include "sim/network/powerflow.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

struct Grid {
  network::Network network;
  network::PowerFlow flow;
  Conventions conventions;
  std::vector<plant::Plant> plants;
  std::vector<plant::Consumer> loads;
  library::EffectLibrary library;  ///< owns the laws that its plants have; attach() takes effects from it

  /// Indices into Network::loads of the loads with a model of their own, sorted.
  [[nodiscard]] std::vector<int> modelled_loads() const;
};

/// Joins a network with its dynamic models. Throws InputError naming every generator in service without a
/// model, every model without a generator, every unknown model, wrong column count and inconsistent value,
/// with the .dyr line. The frequency is the network's: conventions.frequency is overwritten. Where an effect
/// keeps a parameter in the .raw (ZR, ZX) it is taken from there; where the .dyr has its own source reactance
/// and ZX contradicts it, the .dyr counts, as in PSS/E, and a warning says so.
Grid make_grid(network::Network network, const std::vector<formats::DyrRecord>& dynamics,
               const std::string& dyr_name, Conventions conventions);
/// read_network + read_dyr + make_grid. `frequency_hz`: what a MATPOWER case (.m) needs.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const formats::DyrOptions& options = {}, std::optional<double> frequency_hz = {});

/// Writes the plants' models and parameters; with the network's .raw they read back to the last bit. Throws
/// InputError if a parameter that belongs into the .raw differs from the network's, or an effect has no .dyr
/// form.
void write_dyr(const Grid& grid, const std::filesystem::path& file);

}  // namespace swingbank::sim::grid
