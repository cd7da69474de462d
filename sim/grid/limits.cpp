#include "sim/grid/limits.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace swingbank::sim::grid {
namespace {

Complex voltage_of(const Grid& grid, const plant::Plant& plant) {
  return grid.flow.voltage[static_cast<std::size_t>(plant.bus)];
}
/// Returns the reasons why a plant's operating point is infeasible; empty if it is feasible.
std::vector<Problem> hindrances(const Grid& grid, const plant::Plant& plant) {
  try {
    (void)plant::operating_point(plant, voltage_of(grid, plant), grid.network.base_mva, grid.conventions);
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}

struct Limit {
  std::size_t block, parameter;  ///< index of the control and of its parameter
  int way;                       ///< +1: upper limit; -1: lower limit
  double given;
};

class Widener {
 public:
  Widener(Grid& grid, plant::Plant& plant) : grid_(grid), plant_(plant) {
    for (std::size_t b = 0; b < plant.controls.size(); ++b)
      for (std::size_t i = 0; i < plant.controls[b].effect->parameters.size(); ++i)
        if (const int way = plant.controls[b].effect->parameters[i].limit; way != 0)
          limits_.push_back({b, i, way, plant.controls[b].p[i]});
  }
  /// Returns whether the operating point is feasible without the limits.
  bool helps() {
    open_all();
    const bool feasible = is_feasible();
    for (const Limit& l : limits_) value(l) = l.given;
    return feasible;
  }
  /// Widens the limits. If the operating point is infeasible for other reasons, returns these and leaves the
  /// plant unchanged.
  std::vector<Problem> widen() {
    open_all();
    std::vector<Problem> left = hindrances(grid_, plant_);
    for (const Limit& l : limits_)
      if (left.empty())
        narrow(l);
      else
        value(l) = l.given;
    return left;
  }

 private:
  static constexpr double kAllOpen = 100.0;  ///< [pu] more than any operating point requires
  double& value(const Limit& l) { return plant_.controls[l.block].p[l.parameter]; }
  void open_all() {
    for (const Limit& l : limits_) value(l) = l.given + l.way * kAllOpen;
  }
  bool is_feasible() { return hindrances(grid_, plant_).empty(); }
  /// Restores a limit to its given value, or to the nearest value with a feasible operating point.
  void narrow(const Limit& l) {
    double near = 0.0, far = kAllOpen;
    value(l) = l.given;
    if (is_feasible()) return;
    constexpr double fine = 1e-9;  // resolution of a widened limit [pu]
    while (far - near > fine) {
      const double middle = 0.5 * (near + far);
      value(l) = l.given + l.way * middle;
      (is_feasible() ? far : near) = middle;
    }
    value(l) = l.given + l.way * far;
    const plant::Block& block = plant_.controls[l.block];
    const Parameter& p = block.effect->parameters[l.parameter];
    grid_.network.remark("limits are widened to the operating point (--widen-limits)",
                         fmt::format("{} of {} at generator {}: {:g} becomes {:.6g} {}", p.name,
                                     block.effect->name, plant_.name, l.given, value(l), p.unit));
  }
  Grid& grid_;
  plant::Plant& plant_;
  std::vector<Limit> limits_;
};

}  // namespace

void settle_limits(Grid& grid, bool widen) {
  Problems problems;
  const std::size_t before = grid.network.remarks.size();
  for (plant::Plant& plant : grid.plants) {
    std::vector<Problem> found = hindrances(grid, plant);
    if (!found.empty() && widen) found = Widener(grid, plant).widen();
    const bool advise = !found.empty() && !widen && Widener(grid, plant).helps();
    for (Problem& p : found) {
      if (advise) p.remedy += ", or widen the limit with --widen-limits";
      problems.add(p.what, p.where, p.why, p.remedy);
    }
  }
  problems.raise();
  constexpr std::size_t places = 12;
  for (std::size_t i = before; i < grid.network.remarks.size(); ++i)
    spdlog::warn("{}: {}", grid.network.origin, remark_line(grid.network.remarks[i], places));
}

}  // namespace swingbank::sim::grid
