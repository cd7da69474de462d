#pragma once
// Inventory of a case: its units and models, and how many of them can be modelled.
#include <filesystem>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"

namespace swingbank::sim::grid {

/// Counts of one model of the .dyr over all its records.
struct ModelCount {
  std::string name, kind;  ///< kind: its slot, "" if the model is unknown
  int records = 0, units = 0, first_line = 0;
  ///< number of records; number of their units; line of the first record
  int faulty = 0;     ///< number of faulty records of a known model
  std::string fault;  ///< error of the first faulty record
  /// Returns the number of unusable records.
  [[nodiscard]] int uncovered() const { return kind.empty() ? records : faulty; }
};

/// A unit of the case and its models.
struct UnitCount {
  int bus = 0;                         ///< bus number
  std::string id, bus_name;            ///< id of the unit; name of its bus
  double mva = 0;                      ///< machine base [MVA]
  bool in_service = true;              ///< status in the case
  std::vector<std::string> models;     ///< names in the .dyr
  std::vector<std::string> uncovered;  ///< names of the unusable models
  bool machine = false;                ///< true if one of the models is a usable machine
  bool classical = false;              ///< true if that machine has no field winding: GENCLS
  int field_records = 0;               ///< number of controls that act through the field voltage
  /// Whether the unit has a machine model and all its models are usable.
  [[nodiscard]] bool covered() const { return machine && uncovered.empty(); }
};

/// Units and models of a case.
struct Inventory {
  std::vector<UnitCount> units;     ///< in the order of the .raw
  std::vector<ModelCount> models;   ///< most records first
  int without_generator = 0;        ///< number of records of known unit models without a generator
  int first_without_generator = 0;  ///< line of the first such record
  std::vector<std::string> raw_faults = {}, dyr_faults = {};  ///< messages about the files
};

/// Takes the inventory of a case. Throws InputError if one of the files cannot be read.
Inventory take_inventory(const std::filesystem::path& raw, const std::filesystem::path& dyr,
                         const formats::RawOptions& options = {});

}  // namespace swingbank::sim::grid
