#pragma once
// A grid ready to run: network, power flow, and one plant per generator with its effects and parameters.
#include <filesystem>
#include <map>
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
/// One generator: the machine and its controls in order of Slot.
struct Plant {
  std::string name;    ///< "30" or "30/2": bus number, and id where a bus has several machines
  int bus = -1;        ///< index into Network::buses
  double mva = 100.0;  ///< machine base
  Complex generation;  ///< P + jQ at the operating point [pu on the network's base]
  Block machine;
  std::vector<Block> controls;
  int generator = -1;  ///< index into Network::generators
};
struct Grid {
  Network network;
  PowerFlow flow;
  Conventions conventions;
  std::vector<Plant> plants;
};

/// Joins a network with its dynamic models. Throws InputError naming every generator in service without a
/// model, every model without a generator, every unknown model, wrong column count and inconsistent value,
/// with the .dyr line. The frequency is the network's: conventions.frequency is overwritten. Where an effect
/// keeps a parameter in the .raw (ZR, ZX) it is taken from there; where the .dyr has its own source reactance
/// and ZX contradicts it, the .dyr counts, as in PSS/E, and a warning says so.
Grid make_grid(Network network, const std::vector<DyrRecord>& dynamics, const std::string& dyr_name,
               Conventions conventions);
/// read_raw + read_dyr + make_grid.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions);

/// Writes the plants' models and parameters; with the network's .raw they read back to the last bit. Throws
/// InputError if a parameter that belongs into the .raw differs from the network's, or an effect has no .dyr
/// form.
void write_dyr(const Grid& grid, const std::filesystem::path& file);

/// A plant brought to its operating point: coefficients and states of machine and controls back to back.
struct Operating {
  std::vector<double> c;  ///< coefficients, machine first
  std::vector<double> x;  ///< states, machine first
  double r, xs;           ///< impedance behind the terminal [pu on the machine's base]
  double Efd, Tm;         ///< held where exciter or governor slot is empty
  Signals<double> s;      ///< every signal at the operating point
};
/// Back-initialises one plant exactly (saturation included) from terminal voltage [pu] and generation [pu on
/// base_mva]: machine first, then controls in order of Slot. Every derivative is evaluated there; throws
/// InputError where an effect cannot hold the point or a derivative exceeds 1e-9.
Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions);

}  // namespace swingbank::sim
