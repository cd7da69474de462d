#pragma once
// One unit of a case: reader of the records of one generator, and writer of .dyr and .dyd records. Errors
// elsewhere in the case do not affect the reader, except in a MATPOWER case.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/dyd.hpp"
#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// Selects a unit of a case and the treatment of its records.
struct UnitChoice {
  std::filesystem::path raw, dyr;  ///< files of the network and of the dynamic records
  int bus = 0;                     ///< bus number
  std::string id = {};             ///< id of the unit; may be empty if the bus has one unit in service
  std::optional<double> frequency_hz = {};  ///< system frequency if the network's file has none [Hz]
  int raw_version = 0;                      ///< version of a .raw without REV; 0: not given
  /// Models of the unit to drop or to read as other models. A replacement with the same number of parameters
  /// keeps the values; any other replacement has its own defaults.
  formats::DyrOptions models = {};
  std::optional<int> measured_at = {};  ///< measured bus beyond the unit's transformer
  /// Treatment of records with too few or too many values: refused, or completed and truncated.
  Lacking complete_records = Lacking::refused;
  bool dyd = false;  ///< true if `dyr` is a PSLF .dyd (formats::survey_dyd) whatever its extension
};

/// Power and voltage of a unit in its case, at the measured bus.
struct Dispatch {
  double P = 0, Q = 0;  ///< [MW], [Mvar]
  double V = 0;         ///< [pu]
  /// Compares all members.
  friend bool operator==(const Dispatch&, const Dispatch&) = default;
};

/// A unit without a network: `bus` and `generator` of its plant are -1.
struct Unit {
  plant::Plant plant;                           ///< plant with its parameters
  int bus = 0;                                  ///< number of the unit's bus
  std::string id, bus_name;                     ///< id of the unit; name of its bus
  double frequency = 60.0, system_mva = 100.0;  ///< [Hz], [MVA]
  std::optional<Dispatch> dispatch = {};  ///< none if the unit is out of service or its bus has no voltage
  double kv = 0.0;                        ///< nominal voltage of the measured bus [kV]; 0: not given
  std::vector<std::string> defaults;      ///< names of replacement effects that have their defaults
  std::vector<std::string> notes;         ///< messages about interpreted and dropped data
};

/// Reads one unit. Throws InputError with the errors of this unit only (of a MATPOWER case: with all errors),
/// with their lines where there is one: unknown bus or unit, unknown models, wrong column counts,
/// inconsistent values.
Unit read_unit(const UnitChoice& choice);

/// Returns the .dyr records of the plant's machine and controls. A model without a .dyr form, or a
/// value that has no column and is not its null value or default, becomes a problem. Values that belong in
/// the .raw appear as comments. Instruments and changes of set-points belong to an event's record and are
/// omitted.
std::string unit_dyr(const plant::Plant& plant, int bus, const std::string& id, const std::string& where,
                     Problems& problems);

/// Returns the records as lines of a PSLF .dyd, with values on the machine's base. A model without a
/// counterpart in formats::dyd_models_text becomes a problem too.
std::string unit_dyd(const plant::Plant& plant, int bus, const std::string& id,
                     const formats::DydPlace& place, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
