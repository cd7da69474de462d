#include "validate/fleet/fleet_file.hpp"

#include <algorithm>
#include <cctype>

#include "base/config.hpp"

namespace swingbank::validate::fleet {
namespace {

namespace fs = std::filesystem;

bool is_name(const std::string& name) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, allowed);
}

FleetPlant read_plant(Config& c, const std::string& name, const fs::path& folder, const FleetPlant& common) {
  const std::string at = "plant." + name + ".";
  FleetPlant p = common;
  p.name = name;
  p.model = folder / c.require<std::string>(at + "model");
  p.records = c.require<std::vector<std::string>>(at + "records");
  p.prior_sd = c.optional<double>(at + "spread", common.prior_sd, {0.001, 2.0, "relative"});
  p.power_only = c.optional<bool>(at + "power_only", common.power_only);
  if (c.has(at + "records") && p.records.empty())
    c.problem(at + "records", "no record", "a diagnosis needs those of two events or more",
              "list files or globs");
  return p;
}

}  // namespace

Fleet load_fleet(const fs::path& file) {
  Config c(file);
  Fleet fleet{file, file.parent_path(), {}};
  FleetPlant common;
  common.prior_sd = c.optional<double>("options.spread", common.prior_sd, {0.001, 2.0, "relative"});
  common.power_only = c.optional<bool>("options.power_only", false);
  for (const auto& name : c.keys("plant")) {
    if (is_name(name)) {
      fleet.plants.push_back(read_plant(c, name, fleet.folder, common));
      continue;
    }
    c.problem("plant", "plant '" + name + "'", "the name becomes that of a folder",
              "use letters, digits, - and _ only");
    c.ignore("plant");
  }
  if (c.keys("plant").empty())
    c.problem("plant", "no plant", "a fleet has one [plant.NAME] at least", "see configs/fleet/README.md");
  c.raise();
  return fleet;
}

}  // namespace swingbank::validate::fleet
