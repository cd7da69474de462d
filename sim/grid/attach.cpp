#include "sim/grid/attach.hpp"

#include "sim/grid/far.hpp"

namespace swingbank::sim::grid {

void attach(Grid& grid, const plant::Attachment& a, const std::string& where, Problems& problems) {
  if (a.plant.empty() && !a.block.effect) return;  // nothing could be read
  bool any = false;
  std::string names;
  for (plant::Plant& plant : grid.plants) {
    names += (names.empty() ? "" : ", ") + plant.name;
    if (plant.name != a.plant && a.plant != "all") continue;
    any = true;
    if (!a.block.effect) continue;
    if (auto problem = plant::place(plant, a.block, where))
      problems.add(problem->what, problem->where, problem->why, problem->remedy);
  }
  if (a.block.effect && a.block.effect->elsewhere.bus >= 0) look_far(grid);
  if (!any)
    problems.add("no plant " + a.plant, where, "the plants are " + names, "choose one of these, or all");
}

void attach(Grid& grid, const std::string& text, const std::string& where, Problems& problems) {
  attach(grid, plant::read_attachment(text, grid.library, where, problems), where, problems);
}

}  // namespace swingbank::sim::grid
