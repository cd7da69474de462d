#pragma once
// A plant model as records of a PSS/E .dyr or a PSLF .dyd: what is handed in.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// The records of the model's machine and controls; `head` becomes comments. `where` names the model in
/// messages. No bus number, a law and a value without a column become problems.
std::string dyr_text(const PlantModel& model, const std::vector<std::string>& head, const std::string& where,
                     Problems& problems);

/// The same as lines of a PSLF .dyd, with what PSLF asks for beside: the bus's name and its nominal voltage
/// [kV].
std::string dyd_text(const PlantModel& model, const std::vector<std::string>& head,
                     const sim::formats::DydPlace& place, const std::string& where, Problems& problems);

/// The names of the blocks whose values differ from `before`, and of those it does not have.
std::vector<std::string> changed_blocks(const PlantModel& before, const PlantModel& model);

struct WrittenDyr {
  std::string line;            ///< for the person: what was written, or why nothing could be
  std::filesystem::path file;  ///< empty where nothing was written
};
/// Writes the records beside a plant file, its extension .dyr, with the changed ones named.
WrittenDyr write_dyr_beside(const std::filesystem::path& plant_file, const PlantModel& before,
                            const PlantModel& model);

}  // namespace swingbank::validate::plant
