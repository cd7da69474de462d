#pragma once
// Subtraction of the other units' simulated power from a record at a common measuring point.
#include <complex>
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::event {

/// Section between the measuring point and the common bus of the units: a line or cables as a pi section, or
/// a transformer.
struct Collector {
  double R = 0, X = 0;  ///< series impedance [pu on `mva`]
  double B = 0;         ///< total charging susceptance, half at either end [pu on `mva`]
  double ratio = 1;     ///< no-load voltage at the units' bus over that at the point, both in pu
  double mva = 100;     ///< base [MVA]
};

/// Another unit behind the point, whose model is assumed correct.
struct OtherUnit {
  plant::PlantModel model;  ///< model of the unit with its plant file's values
  double share = 0;         ///< share of the power at the units' bus before the event; 0: P and Q apply
  double P = 0, Q = 0;      ///< power before the event [MW, Mvar]
};

/// Measuring point that is not a unit's terminal, with the sections up to the units and the units themselves.
struct MeasuredPoint {
  std::string file;                  ///< point file it was read from
  std::vector<Collector> collector;  ///< sections in series, beginning at the point
  plant::PlantModel tried;           ///< model of the tested unit, also used to fit the switching times
  std::vector<OtherUnit> others;     ///< the other units
};

/// Reads a point file (configs/plants/README.md) for the unit whose plant file is `tried`. Throws InputError
/// with all its problems: unknown keys, units that cannot be read, no entry of the tested unit, or shares of
/// the other units that add up to 1 or more.
MeasuredPoint load_point(const std::filesystem::path& file, const std::filesystem::path& tried);
/// Returns the JSON Schema of point files.
std::string point_schema();
/// Reads a point file for a loaded model. If a control of that model measures at another bus, it is set to
/// measure at the point.
MeasuredPoint load_point(const std::filesystem::path& file, plant::PlantModel& tried);

/// Returns the record transferred from the point to the units' bus, computed from its V, P and Q.
record::Record behind_collector(record::Record record, const std::vector<Collector>& collector);

/// Returns the two-port from the plant to the point [pu on `mva`], for a control that measures at the point.
/// `share`: power of this plant over the power of all units.
sim::plant::TwoPort to_point(const std::vector<Collector>& collector, double mva, double share);
/// Returns the plant of the tested unit. If a control measures at another bus, it is set to measure at the
/// point. Throws InputError if the unit's share of the total power is then unknown.
sim::plant::Plant at_point(const MeasuredPoint& point);

/// Returns the record of the tested unit alone: transferred to the units' bus, minus the simulated responses
/// of the other units to the voltage of that bus. Notes report the subtraction. Throws InputError as play()
/// does, and if the record lacks V, angle, P or Q.
record::Record of_tried_unit(const MeasuredPoint& point, record::Record record);

}  // namespace swingbank::validate::event
