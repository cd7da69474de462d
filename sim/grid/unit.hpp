#pragma once
// One unit of a case: the records of one generator alone, whatever is wrong with the rest; and such a unit as
// .dyr records again.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/dyd.hpp"
#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// Which unit of which files, and what to do with its records.
struct UnitChoice {
  std::filesystem::path raw, dyr;
  int bus = 0;
  std::string id = {};                      ///< may be empty where the bus has one unit in service
  std::optional<double> frequency_hz = {};  ///< where the network's file does not hold it
  int raw_version = 0;                      ///< of a .raw that does not say it; 0: not given
  /// Models of the unit to leave out, and to read as others: of as many parameters with their values, else
  /// with the other's standard values.
  formats::DyrOptions models = {};
  std::optional<int> measured_at = {};  ///< a bus beyond the unit's transformer, where its records were taken
  /// Records shorter or longer than their model: missing values at the end are these, surplus ones left out.
  Lacking complete_records = Lacking::refused;
  bool dyd = false;  ///< `dyr` is a .dyd of PSLF (formats::survey_dyd), whatever its name
};

/// What a unit delivers in its case, at the bus where it is measured.
struct Dispatch {
  double P = 0, Q = 0;  ///< [MW], [Mvar]
  double V = 0;         ///< [pu]
  friend bool operator==(const Dispatch&, const Dispatch&) = default;
};

/// The unit's plant, without a network: `bus` and `generator` of it are -1.
struct Unit {
  plant::Plant plant;
  int bus = 0;
  std::string id, bus_name;
  double frequency = 60.0, system_mva = 100.0;
  std::optional<Dispatch> dispatch = {};  ///< none: out of service, or no voltage in the case
  double kv = 0.0;                        ///< nominal voltage where it is measured [kV]; 0: not given
  std::vector<std::string> standard;      ///< names of effects that have their standard values
  std::vector<std::string> notes;         ///< what was taken how, and what was not
};

/// Throws InputError with what is wrong with the records of this unit alone: an unknown bus or unit, unknown
/// models, wrong column counts, inconsistent values, each with its line.
Unit read_unit(const UnitChoice& choice);

/// The records of the plant's machine and controls. What a .dyr does not hold (a law, a value without a
/// column) becomes a problem; what the .raw holds is told in comments; instruments and moved references,
/// which belong to a record, are left out.
std::string unit_dyr(const plant::Plant& plant, int bus, const std::string& id, const std::string& where,
                     Problems& problems);

/// The same as lines of a PSLF .dyd, values on the machine's base; a model without counterpart becomes a
/// problem too (formats::dyd_models_text names those that have one).
std::string unit_dyd(const plant::Plant& plant, int bus, const std::string& id,
                     const formats::DydPlace& place, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
