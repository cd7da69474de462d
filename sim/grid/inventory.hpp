#pragma once
// What a case holds of units and models, and how much of it can be modelled.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"

namespace swingbank::sim::grid {

/// One model of the .dyr, over all its records.
struct ModelCount {
  std::string name, kind;  ///< kind: its slot, "" if it is not known
  int records = 0, units = 0, first_line = 0;
  int faulty = 0;     ///< of the records of a known model
  std::string fault;  ///< what is wrong with the first of these
  [[nodiscard]] int uncovered() const { return kind.empty() ? records : faulty; }
};

struct UnitCount {
  int bus = 0;
  std::string id, bus_name;
  double mva = 0;
  bool in_service = true;
  std::vector<std::string> models;     ///< as the .dyr has them
  std::vector<std::string> uncovered;  ///< those of them that cannot be used
  bool machine = false;                ///< one of the models is a machine that can be used
  bool classical = false;              ///< it has no field winding: GENCLS
  int field_records = 0;               ///< of controls that act through the field voltage
  [[nodiscard]] bool covered() const { return machine && uncovered.empty(); }
};

struct Inventory {
  std::vector<UnitCount> units;     ///< in the order of the .raw
  std::vector<ModelCount> models;   ///< most records first
  int without_generator = 0;        ///< records of known controls whose generator the .raw does not have
  int first_without_generator = 0;  ///< line of the first
  std::vector<std::string> raw_faults = {}, dyr_faults = {};  ///< sentences
};

/// Throws InputError where one of the files cannot be read at all.
Inventory take_inventory(const std::filesystem::path& raw, const std::filesystem::path& dyr,
                         const formats::RawOptions& options = {});

}  // namespace swingbank::sim::grid
