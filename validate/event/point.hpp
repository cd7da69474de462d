#pragma once
// A measured point behind which several units stand: what the record says of the one that is tried.
#include <complex>
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::event {

/// The impedance that units share before the point: a line or cables as a pi section, a transformer.
struct Collector {
  double R = 0, X = 0;  ///< in series [pu on `mva`]
  double B = 0;         ///< charging, half at either end [pu on `mva`]
  double ratio = 1;     ///< voltage at the units' bus over that at the point, both in pu, without load
  double mva = 100;     ///< base [MVA]
};

/// A unit beside the one that is tried: its model is believed.
struct OtherUnit {
  plant::PlantModel model;
  double share = 0;     ///< of what flows at the units' bus before the event; 0: P and Q count
  double P = 0, Q = 0;  ///< before the event [MW, Mvar]
};

struct MeasuredPoint {
  std::string file;
  std::vector<Collector> collector;  ///< sections one after the other, the one at the point first
  plant::PlantModel tried;  ///< tells, with the others, when within a sample interval the network switched
  std::vector<OtherUnit> others;
};

/// Reads a point file (configs/plants/README.md) for the unit whose plant file is `tried`. Throws InputError
/// with every fault of it: unknown keys, units that cannot be read, the tried one missing, shares that leave
/// nothing.
MeasuredPoint load_point(const std::filesystem::path& file, const std::filesystem::path& tried);
/// The same for a model that was read, whose control, if it measures elsewhere, does so at the point then.
MeasuredPoint load_point(const std::filesystem::path& file, plant::PlantModel& tried);

/// The record moved from the point to the units' bus, by its own V, P and Q.
record::Record behind_collector(record::Record record, const std::vector<Collector>& collector);

/// What a control of the plant sees of the point: beyond the collector, where all units behind it carry
/// 1/`share` times what this one does, as a whole [pu on `mva`].
sim::plant::TwoPort to_point(const std::vector<Collector>& collector, double mva, double share);
/// The tried unit's plant, whose control, if one measures elsewhere, measures at the point. Throws InputError
/// where the unit's share of the whole is not known.
sim::plant::Plant at_point(const MeasuredPoint& point);

/// What the record shows of the tried unit alone: moved to the units' bus, and without what the other units
/// do there, which are played in with the voltage of that bus. Notes say so. Throws InputError as play()
/// does, and where the record lacks V, angle, P or Q.
record::Record of_tried_unit(const MeasuredPoint& point, record::Record record);

}  // namespace swingbank::validate::event
