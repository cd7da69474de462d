#pragma once
// Export of a plant model as records of a PSS/E .dyr or a PSLF .dyd.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// Returns the .dyr records of the model's machine, transformer and controls. `head` and the nameplate become
/// comments; `where` names the model in messages. A missing bus number, a user-defined model, and a value
/// without a column become problems.
std::string dyr_text(const PlantModel& model, const std::vector<std::string>& head, const std::string& where,
                     Problems& problems);

/// Returns the same records as lines of a PSLF .dyd, which also contain the bus's name and nominal voltage
/// [kV]. A missing voltage becomes a problem.
std::string dyd_text(const PlantModel& model, const std::vector<std::string>& head,
                     const sim::formats::DydPlace& place, const std::string& where, Problems& problems);

/// Format of dynamic records.
enum class RecordFormat {
  dyr,  ///< of PSS/E
  dyd,  ///< of PSLF
};
/// Result of write_records_beside().
struct WrittenRecords {
  std::string line;            ///< message: the written file, or the reason why none was written
  std::filesystem::path file;  ///< empty if none was written
};
/// Writes the records into the folder of a plant file, under the same name with another extension. A comment
/// lists the changed blocks.
WrittenRecords write_records_beside(const std::filesystem::path& plant_file, const PlantModel& before,
                                    const PlantModel& model, RecordFormat format = RecordFormat::dyr);

}  // namespace swingbank::validate::plant
