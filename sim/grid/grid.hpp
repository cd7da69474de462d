#pragma once
// A grid ready to run: network, power flow, and one plant per generator with its effects and parameters.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
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
  network::PowerFlowOptions flow_options;
  library::EffectLibrary library;  ///< owns the laws that its plants have; attach() takes effects from it

  /// Indices into Network::loads of the loads with a model of their own, sorted.
  [[nodiscard]] std::vector<int> modelled_loads() const;
};

/// What is done to a case that is not whole. Everything done stands in Network::remarks.
struct CaseOptions {
  formats::DyrOptions dyr;
  formats::RawOptions raw;
  bool net_generators = false;   ///< generators without a machine model become negative loads (PSS/E: GNET)
  bool start_from_file = false;  ///< the file's voltages are the operating point, whatever they leave over
  network::PowerFlowOptions flow;
  /// Records shorter or longer than their model: missing values at the end are these, surplus ones left out.
  Lacking complete_records = Lacking::refused;
  bool drop_refused = false;  ///< records of the .dyr that their model cannot take are left out
};

/// Joins a network with its dynamic models. Throws InputError naming every generator in service without a
/// model, every unknown model, wrong column count and inconsistent value, with the .dyr line. Records for
/// generators that the network has not, or has out of service, are left out, the former with a remark. The
/// frequency is the network's: conventions.frequency is overwritten. Where an effect keeps a parameter in the
/// .raw (ZR, ZX) it is taken from there; where the .dyr has its own source reactance and ZX contradicts it,
/// the .dyr counts, as in PSS/E, with a remark. Equipment without a model draws constant P and Q. Where the
/// solution and the file's voltages differ by more than 1e-3 pu a remark says so.
Grid make_grid(network::Network network, const std::vector<formats::DyrRecord>& dynamics,
               const std::string& dyr_name, Conventions conventions, const CaseOptions& options = {});
/// read_network + read_dyr (of a .dyd: survey_dyd, whose mva, Ra and X'd count for their generators) +
/// make_grid; what was done to the case is warned of.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const CaseOptions& options);
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const formats::DyrOptions& options = {}, std::optional<double> frequency_hz = {});

/// A remark in a line: what, how often, and at most `places` of the places.
std::string remark_line(const network::Remark& remark, std::size_t places);

/// Writes the plants' models and parameters; with the network's .raw they read back to the last bit. Throws
/// InputError if a parameter that belongs into the .raw differs from the network's, or an effect has no .dyr
/// form.
void write_dyr(const Grid& grid, const std::filesystem::path& file);

}  // namespace swingbank::sim::grid
