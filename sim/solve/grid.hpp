#pragma once
// A grid ready to run: network, power flow, and one plant per generator with its effects and parameters.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/network/powerflow.hpp"
#include "sim/network/psse.hpp"

namespace swingbank::sim {

/// An effect with its parameter values, in the order of effect->parameters.
struct Block {
  const Effect* effect = nullptr;
  std::vector<double> p;
};
/// One generator: the machine and what stands around it.
struct Plant {
  std::string name;    ///< "30" or "30/2": bus number, and id where a bus has several machines
  int bus = -1;        ///< index into Network::buses
  double mva = 100.0;  ///< machine base
  Complex generation;  ///< P + jQ at the operating point [pu on the network's base]
  Block machine;
  Block transformer;            ///< none: effect == nullptr; the bus is then the machine's terminal
  std::vector<Block> controls;  ///< in order of Slot
  std::vector<Block> measurements;
  int generator = -1;  ///< index into Network::generators
};
/// A load with a model of its own; every other load is a constant impedance.
struct Consumer {
  std::string name;     ///< "8" or "8/2": bus number, and id where a bus has several loads
  int bus = -1;         ///< index into Network::buses
  int load = -1;        ///< index into Network::loads
  double mva = 100.0;   ///< base of its parameters
  Complex consumption;  ///< P + jQ at the operating point [pu on the network's base]
  Block block;
};
struct Grid {
  Network network;
  PowerFlow flow;
  Conventions conventions;
  std::vector<Plant> plants;
  std::vector<Consumer> loads;

  /// Indices into Network::loads of the loads with a model of their own, sorted.
  [[nodiscard]] std::vector<int> modelled_loads() const;
};

/// Joins a network with its dynamic models. Throws InputError naming every generator in service without a
/// model, every model without a generator, every unknown model, wrong column count and inconsistent value,
/// with the .dyr line. The frequency is the network's: conventions.frequency is overwritten. Where an effect
/// keeps a parameter in the .raw (ZR, ZX) it is taken from there; where the .dyr has its own source reactance
/// and ZX contradicts it, the .dyr counts, as in PSS/E, and a warning says so.
Grid make_grid(Network network, const std::vector<DyrRecord>& dynamics, const std::string& dyr_name,
               Conventions conventions);
/// read_network + read_dyr + make_grid. `frequency_hz`: what a MATPOWER case (.m) needs.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const DyrOptions& options = {}, std::optional<double> frequency_hz = {});

/// Values of every block of a plant: machine, transformer if there is one, controls.
std::vector<std::vector<double>> block_parameters(const Plant& plant);

/// When the plant's effects jump in time, sorted [s].
std::vector<double> instants_of(const Plant& plant);
/// Effects see at most the end of their segment less this, so that a jump at its end stays in the next [s].
constexpr double kBeforeSwitching = 1e-9;

/// Writes the plants' models and parameters; with the network's .raw they read back to the last bit. Throws
/// InputError if a parameter that belongs into the .raw differs from the network's, or an effect has no .dyr
/// form.
void write_dyr(const Grid& grid, const std::filesystem::path& file);

/// A plant brought to its operating point. T: double, or a dual where derivatives are wanted.
template <class T>
struct OperatingOf {
  std::vector<T> c;  ///< coefficients: machine, Joint (plant_equations.hpp), controls
  std::vector<T> x;  ///< states: machine, controls
  T Efd, Tm;         ///< held where exciter or governor slot is empty
  Signals<T> s;      ///< every signal at the operating point
};
using Operating = OperatingOf<double>;

/// Back-initialises one plant exactly (saturation included) from the voltage at its bus [pu] and generation
/// [pu on base_mva]: machine first, then controls in order of Slot. Every derivative is evaluated there;
/// throws InputError where an effect cannot hold the point, a state lies outside its limits or a derivative
/// exceeds 1e-9.
Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions);
/// The same with the values of every block given as T (machine, transformer if there is one, controls).
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, double base_mva, const Conventions& conventions);
/// The same with the generation P, Q given as T [pu on the machine's base]; plant.generation is not read.
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, const T& P, const T& Q, const Conventions& conventions);

}  // namespace swingbank::sim
