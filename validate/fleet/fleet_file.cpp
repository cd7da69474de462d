#include "validate/fleet/fleet_file.hpp"

#include <algorithm>
#include <cctype>

#include "base/config.hpp"
#include "base/describe.hpp"

namespace swingbank::validate::fleet {
namespace {

namespace fs = std::filesystem;

bool is_name(const std::string& name) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, allowed);
}

/// Reads the options of one plant or of all plants; missing options keep their values.
void read_options(Config& c, const std::string& at, FleetPlant& p) {
  p.prior_sd = c.optional<double>(at + "prior_sd", p.prior_sd,
                                  {0.001, 2.0, "relative", "prior standard deviation of the parameters"});
  p.power_only =
      c.optional<bool>(at + "power_only", p.power_only,
                       {.meaning = "compare P and Q only, even if speed, Efd and Ifd are recorded"});
}

FleetPlant read_plant(Config& c, const std::string& name, const fs::path& folder, const FleetPlant& common) {
  const std::string at = "plant." + name + ".";
  FleetPlant p = common;
  p.name = name;
  p.model = folder / c.require<std::string>(at + "model",
                                            {.meaning = "plant file, relative to the folder of this file"});
  p.records = c.require<std::vector<std::string>>(
      at + "records",
      {.meaning = "records of at least two events: files and globs, relative to the folder of this file"});
  read_options(c, at, p);
  if (c.has(at + "records") && p.records.empty())
    c.problem(at + "records", "no record", "a diagnosis needs the records of at least two events",
              "list files or globs");
  return p;
}

Fleet read_fleet(Config& c, const fs::path& file) {
  Fleet fleet{file, file.parent_path(), {}};
  FleetPlant common;
  read_options(c, "options.", common);
  for (const auto& name : c.keys("plant")) {
    if (is_name(name) || name == kAnyName) {
      fleet.plants.push_back(read_plant(c, name, fleet.folder, common));
      continue;
    }
    c.problem("plant", "plant '" + name + "'", "the plant's result folder has the same name",
              "use letters, digits, - and _ only");
    c.ignore("plant");
  }
  if (c.keys("plant").empty())
    c.problem("plant", "no plant", "a fleet needs at least one [plant.NAME]", "see configs/fleet/README.md");
  c.raise();
  return fleet;
}

}  // namespace

Fleet load_fleet(const fs::path& file) {
  Config c(file);
  return read_fleet(c, file);
}

std::string fleet_schema() {
  return describe_keys("Fleet of Swingbank", [](Config& c) { read_fleet(c, {}); });
}

}  // namespace swingbank::validate::fleet
