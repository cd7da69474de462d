#include "sim/grid/attach.hpp"

#include <fmt/format.h>

#include "sim/grid/far.hpp"

namespace swingbank::sim::grid {
namespace {

/// Locates the remote measurements of an added effect; a missing bus or branch becomes a problem.
void find_far(const Grid& grid, plant::Plant& plant, const std::string& where, Problems& problems) {
  for (const NotThere& missing : look_far(grid, plant))
    problems.add(fmt::format("{}, which {} of plant {} measures, is not in service", missing.what,
                             missing.control, plant.name),
                 where, "it is missing in the network, or out of service",
                 "name equipment in service, or 0 to measure at the plant");
}

}  // namespace

void attach(Grid& grid, const plant::Attachment& a, const std::string& where, Problems& problems) {
  if (a.plant.empty() && !a.block.effect) return;  // the text was invalid
  bool any = false;
  std::string names;
  for (plant::Plant& plant : grid.plants) {
    names += (names.empty() ? "" : ", ") + plant.name;
    if (plant.name != a.plant && a.plant != "all") continue;
    any = true;
    if (!a.block.effect) continue;
    if (auto problem = plant::place(plant, a.block, where))
      problems.add(problem->what, problem->where, problem->why, problem->remedy);
    else if (a.block.effect->elsewhere.bus >= 0)
      find_far(grid, plant, where, problems);
  }
  if (!any)
    problems.add("no plant " + a.plant, where, "the plants are " + names, "choose one of these, or all");
}

void attach(Grid& grid, const std::string& text, const std::string& where, Problems& problems) {
  attach(grid, plant::read_attachment(text, grid.library, where, problems), where, problems);
}

}  // namespace swingbank::sim::grid
