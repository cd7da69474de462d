#include "sim/grid/grid.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "sim/formats/matpower.hpp"
#include "sim/grid/detail/dyr_models.hpp"
#include "sim/grid/load_choice.hpp"

namespace swingbank::sim::grid {
namespace {

class GridMaker {
 public:
  GridMaker(network::Network network, const std::string& dyr, Conventions conventions) : dyr_(dyr) {
    grid_.network = std::move(network);
    grid_.conventions = conventions;
    grid_.conventions.frequency = grid_.network.frequency;
    plants();
  }
  Grid make(const std::vector<formats::DyrRecord>& dynamics) {
    for (const formats::DyrRecord& record : dynamics) add(record);
    tell_unknown();
    for (plant::Plant& plant : grid_.plants) finish(plant);
    problems_.raise();
    solve();
    for (LoadModel& model : load_models_) {
      if (is_composed(*model.block.effect)) compose(grid_, model.load, model.block, model.where, problems_);
      set_load(grid_, model.load, std::move(model.block), model.where, problems_);
    }
    problems_.raise();
    return std::move(grid_);
  }

 private:
  void plants() {
    std::map<int, int> at_bus;
    for (const network::Generator& g : grid_.network.generators)
      if (g.in_service) ++at_bus[g.bus];
    for (std::size_t i = 0; i < grid_.network.generators.size(); ++i) {
      const network::Generator& g = grid_.network.generators[i];
      const int number = bus_number(g);
      known_.emplace(number, g.id);
      if (!g.in_service) continue;
      plant::Plant plant;
      plant.name = std::to_string(number) + (at_bus[g.bus] > 1 ? "/" + g.id : "");
      plant.bus = g.bus;
      plant.mva = g.mva;
      plant.generator = static_cast<int>(i);
      plant.transformer = transformer_of(g);
      plant_of_[{number, g.id}] = grid_.plants.size();
      grid_.plants.push_back(std::move(plant));
    }
  }
  [[nodiscard]] int bus_number(const network::Generator& g) const {
    return grid_.network.buses[static_cast<std::size_t>(g.bus)].number;
  }

  void add(const formats::DyrRecord& given) {
    const std::string where = dyr_ + ":" + std::to_string(given.line);
    const auto [effect, reach] = effect_of_dyr(given);
    if (!effect) return unknown(given, where);
    const formats::DyrRecord record = plain(given, *effect);
    problems_.add(record.faults);
    if (!record.faults.empty()) return;
    if (effect->slot == Slot::load) return add_load(*effect, reach, record, where);
    const std::pair<int, std::string> key{record.bus, record.id};
    const auto found = plant_of_.find(key);
    if (found == plant_of_.end()) {
      if (known_.contains(key)) return;  // the generator exists but is out of service
      problems_.add(record.model + " for generator '" + record.id + "' at bus " + std::to_string(record.bus),
                    where, grid_.network.origin + " has no such generator",
                    "correct bus number and id, or remove the record");
      return;
    }
    plant::Plant& plant = grid_.plants[found->second];
    if (!complete(*effect, record, where, problems_)) return;
    const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
    plant::Block block = values_of(*effect, record);
    take_from_raw(block, g);
    if (const std::string left_out = remark_on(block, where, plant.name); !left_out.empty())
      spdlog::warn("{}", left_out);
    const std::string warning = place(plant, std::move(block), {g, grid_.network.origin}, where, problems_);
    if (!warning.empty()) spdlog::warn("{}", warning);
  }
  /// Kept until all are known: one sentence for each model, not for each record.
  void unknown(const formats::DyrRecord& record, const std::string& where) {
    Unknown& one = unknown_[{record.user.empty() ? record.model : record.user, !record.user.empty()}];
    if (++one.records > 1) return;
    one.where = where;
    one.first = "'" + record.id + "' at bus " + std::to_string(record.bus);
    one.parameters = record.values.size();
  }
  void tell_unknown() {
    for (const auto& [model, one] : unknown_) {
      const auto& [name, user] = model;
      const std::string others =
          one.records > 1 ? " and " + std::to_string(one.records - 1) + " more" : std::string();
      problems_.add((user ? "user-written model '" : "unknown model '") + name + "' of " + one.first + others,
                    one.where, "available are " + dyr_names(),
                    "leave it out with --ignore-model " + name +
                        ", or let another with as many parameters (" + std::to_string(one.parameters) +
                        ") stand for it with --map-model " + name + "=OTHER");
    }
  }
  /// A model for one load, or with the id * for every load, of a bus, owner, zone, area or of all.
  void add_load(const Effect& effect, Reach reach, const formats::DyrRecord& record,
                const std::string& where) {
    constexpr std::array of = {"at bus", "of owner", "in zone", "in area", "anywhere"};
    const std::string what = record.model + " for load '" + record.id + "' " +
                             of[static_cast<std::size_t>(reach)] +
                             (reach == Reach::all ? "" : " " + std::to_string(record.bus));
    const int bus = grid_.network.bus_index(record.bus);
    if (reach == Reach::load && bus < 0) {
      problems_.add(what, where, grid_.network.origin + " has no such bus",
                    "correct the bus number, or remove the record");
      return;
    }
    if (!complete(effect, record, where, problems_)) return;
    Problems found;
    const plant::Block block = values_of(effect, record);
    effect.check(effect.law.get(), block.p.data(), where, found);
    problems_.add(found);
    bool any = false;
    for (std::size_t i = 0; i < grid_.network.loads.size(); ++i) {
      const network::Load& load = grid_.network.loads[i];
      const int number[] = {bus, record.bus, record.bus, record.bus, 0};
      const int own[] = {load.bus, load.owner, load.zone, load.area, 0};
      const auto r = static_cast<std::size_t>(reach);
      if (own[r] != number[r] || (record.id != "*" && load.id != record.id)) continue;
      if (record.id == "*" && load.power == Complex{} && load.current == Complex{} &&
          load.admittance == Complex{})
        continue;  // there is nothing to model
      any = true;
      const auto same = [&](const LoadModel& m) { return m.load == static_cast<int>(i); };
      const auto other = std::ranges::find_if(load_models_, same);
      const LoadModel model{static_cast<int>(i), block, where, reach};
      if (other == load_models_.end())
        load_models_.push_back(model);
      else if (reach < other->reach)
        *other = model;
      else if (reach == other->reach)
        problems_.add("a second model, " + what, where,
                      "it already has " + std::string(other->block.effect->dyr_name), "keep one of them");
    }
    if (!any) spdlog::warn("{}: {} left out: no such load is in service", where, what);
  }
  void finish(plant::Plant& plant) {
    if (!plant.machine.effect) {
      const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
      problems_.add("no machine model for generator '" + g.id + "' at bus " + std::to_string(bus_number(g)),
                    dyr_, "it is in service in " + grid_.network.origin,
                    "add a record with one of " + machine_names() + ", or take the generator out of service");
    }
    check_fit(plant, dyr_, problems_);
    sort_controls(plant);
  }
  void solve() {
    grid_.flow = network::solve_power_flow(grid_.network);
    for (plant::Plant& plant : grid_.plants)
      plant.generation = grid_.flow.generation[static_cast<std::size_t>(plant.generator)];
  }

  struct LoadModel {
    int load;  ///< index into Network::loads
    plant::Block block;
    std::string where;
    Reach reach;
  };
  struct Unknown {
    int records = 0;
    std::string where, first;  ///< of its first record
    std::size_t parameters = 0;
  };
  std::string dyr_;
  Grid grid_;
  Problems problems_;
  std::vector<LoadModel> load_models_;
  std::map<std::pair<std::string, bool>, Unknown> unknown_;  ///< by name and whether it is user-written
  std::map<std::pair<int, std::string>, std::size_t> plant_of_;
  std::set<std::pair<int, std::string>> known_;  ///< every generator of the network
};

}  // namespace

std::vector<int> Grid::modelled_loads() const {
  std::vector<int> list;
  for (const plant::Consumer& c : loads) list.push_back(c.load);
  std::ranges::sort(list);
  return list;
}

Grid make_grid(network::Network network, const std::vector<formats::DyrRecord>& dynamics,
               const std::string& dyr_name, Conventions conventions) {
  return GridMaker(std::move(network), dyr_name, conventions).make(dynamics);
}

Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const formats::DyrOptions& options, std::optional<double> frequency_hz) {
  Problems problems;
  network::Network network;
  std::vector<formats::DyrRecord> dynamics;
  const auto collect = [&](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      for (const Problem& p : error.problems()) problems.add(p.what, p.where, p.why, p.remedy);
    }
  };
  collect([&] { network = formats::read_network(raw, frequency_hz); });
  collect([&] { dynamics = formats::read_dyr(dyr, options); });
  problems.raise();
  return make_grid(std::move(network), dynamics, dyr.string(), conventions);
}

}  // namespace swingbank::sim::grid
