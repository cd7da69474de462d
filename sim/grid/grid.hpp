#pragma once
// A grid ready to run: network, power flow, and one plant per generator with its effects and parameters.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
#include "sim/library/library.hpp"
#include "sim/network/powerflow.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// A network with its power flow, plants, dynamic loads and the library of their effects.
struct Grid {
  network::Network network;                ///< network of the case
  network::PowerFlow flow;                 ///< solved power flow, the operating point
  Conventions conventions;                 ///< conventions of the simulator
  std::vector<plant::Plant> plants;        ///< plants, in the order of their generators
  std::vector<plant::Consumer> loads;      ///< loads with a dynamic model
  network::PowerFlowOptions flow_options;  ///< options with which `flow` was solved
  library::EffectLibrary library;  ///< owns the plants' user-defined models; attach() takes effects from it

  /// Returns the sorted indices into Network::loads of the loads with a dynamic model.
  [[nodiscard]] std::vector<int> modelled_loads() const;
};

/// Treatment of an incomplete case. Every change is recorded in Network::remarks.
struct CaseOptions {
  formats::DyrOptions dyr;         ///< treatment of unavailable models
  formats::RawOptions raw;         ///< treatment of the network's file
  bool net_generators = false;     ///< generators without a machine model become negative loads (PSS/E: GNET)
  bool start_from_file = false;    ///< the file's voltages are the operating point, whatever their mismatch
  network::PowerFlowOptions flow;  ///< options of the power flow
  /// Treatment of records that are too short (fill values) or too long (surplus values are dropped).
  Lacking complete_records = Lacking::refused;
  bool drop_refused = false;  ///< drop records of the .dyr that their model does not accept
};

/// Combines a network with its dynamic models. Throws InputError that names every generator in service
/// without a model. It also names every unknown model, wrong column count and inconsistent value, with its
/// line in the .dyr.
///
/// Records of generators that are out of service are dropped; those of generators that the network does not
/// have are dropped with a remark. The frequency is the network's: conventions.frequency is overwritten.
/// Parameters that an effect keeps in the .raw (ZR, ZX) are taken from there. If the .dyr has its own source
/// reactance and ZX contradicts it, the .dyr takes precedence, as in PSS/E, with a remark. Equipment without
/// a model draws constant P and Q. If the solution differs from the file's voltages by more than 1e-3 pu, a
/// remark is added.
Grid make_grid(network::Network network, const std::vector<formats::DyrRecord>& dynamics,
               const std::string& dyr_name, Conventions conventions, const CaseOptions& options = {});
/// Combines read_network, read_dyr and make_grid, and warns of every change to the case. A .dyd is read by
/// survey_dyd; its machine base, Ra and X'd take precedence over those of the network's generators.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const CaseOptions& options);
/// As load_grid() above, with options of the .dyr only. `frequency_hz`: system frequency [Hz] if the
/// network's file has none.
Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const formats::DyrOptions& options = {}, std::optional<double> frequency_hz = {});

/// Returns a remark as one line: subject, count, and at most `places` places.
std::string remark_line(const network::Remark& remark, std::size_t places);

}  // namespace swingbank::sim::grid
