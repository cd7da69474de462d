#include "sim/grid/grid.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "base/durable.hpp"
#include "sim/formats/matpower.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/grid/load_choice.hpp"

namespace swingbank::sim::grid {
namespace {

/// Which loads a load model of a .dyr is for. Where several are for one load the first of these counts.
enum class Reach { load, owner, zone, area, all };
constexpr std::array kEndings = {"BL", "OW", "ZN", "AR", "AL"};

/// The effect with this name in a .dyr (case matters not), or nullptr.
const Effect* effect_named(std::string_view model) {
  const auto same = [](unsigned char a, unsigned char b) { return std::toupper(a) == std::toupper(b); };
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty() && std::ranges::equal(e.dyr_name, model, same)) return &e;
  return nullptr;
}
/// The same, with the names that stand for it too: IEELAR is IEELBL for an area.
std::pair<const Effect*, Reach> effect_of_dyr(std::string model) {
  if (model == "GENTPJ1") model = "GENTPJU1";  // its name since PSS/E 34
  if (const Effect* own = effect_named(model)) return {own, Reach::load};
  for (std::size_t i = 1; i < kEndings.size(); ++i) {
    if (!model.ends_with(kEndings[i])) continue;
    const Effect* effect = effect_named(model.substr(0, model.size() - 2) + kEndings[0]);
    if (effect && effect->slot == Slot::load) return {effect, static_cast<Reach>(i)};
  }
  return {nullptr, Reach::load};
}
std::string dyr_names() {
  std::string names;
  for (const Effect& e : library::compiled_effects())
    if (!e.dyr_name.empty()) names += (names.empty() ? "" : ", ") + std::string(e.dyr_name);
  return names;
}

/// The step-up transformer that a .raw keeps in the generator's record.
bool has_transformer(const network::Generator& g) { return g.rt != 0.0 || g.xt != 0.0; }
plant::Block transformer_of(const network::Generator& g) {
  plant::Block block{library::compiled().find("STEPUP"), {}};
  block.p = block.effect->standard_parameters();
  block.p[static_cast<std::size_t>(block.effect->parameter_index("R"))] = g.rt;
  block.p[static_cast<std::size_t>(block.effect->parameter_index("X"))] = g.xt;
  return block;
}

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
      if (has_transformer(g)) plant.transformer = transformer_of(g);
      plant_of_[{number, g.id}] = grid_.plants.size();
      grid_.plants.push_back(std::move(plant));
    }
  }
  [[nodiscard]] int bus_number(const network::Generator& g) const {
    return grid_.network.buses[static_cast<std::size_t>(g.bus)].number;
  }

  void add(const formats::DyrRecord& given) {
    const std::string where = dyr_ + ":" + std::to_string(given.line);
    const auto [effect, reach] = effect_of_dyr(given.user.empty() ? given.model : given.user);
    const formats::DyrRecord record = effect && !given.user.empty() ? plain(given, *effect) : given;
    if (!effect) {
      const std::string name = record.user.empty() ? record.model : record.user;
      problems_.add((record.user.empty() ? "unknown model '" : "user-written model '") + name + "' of '" +
                        record.id + "' at bus " + std::to_string(record.bus),
                    where, "available are " + dyr_names(),
                    "leave it out with --ignore-model " + name +
                        ", or let another with as many parameters (" + std::to_string(record.values.size()) +
                        ") stand for it with --map-model " + name + "=OTHER");
      return;
    }
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
    if (!complete(*effect, record, where)) return;
    place(plant, read(*effect, record, plant), where);
  }
  /// A user-written model that is one of ours: without IC, IT, NI, NC, NS, NV before its parameters.
  static formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect) {
    constexpr std::size_t before = 6, count = 3;
    const std::size_t columns = effect.dyr_columns.size();
    if (record.values.size() == columns + before && record.values[count] == static_cast<double>(columns))
      record.values.erase(record.values.begin(), record.values.begin() + before);
    record.model = record.user;
    return record;
  }
  bool complete(const Effect& effect, const formats::DyrRecord& record, const std::string& where) {
    if (record.values.size() == effect.dyr_columns.size()) return true;
    problems_.add(record.model + " with " + std::to_string(record.values.size()) + " parameters", where,
                  "it takes " + columns(effect), "give every parameter, in this order");
    return false;
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
    if (!complete(effect, record, where)) return;
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
  static std::string columns(const Effect& effect) {
    std::string text = std::to_string(effect.dyr_columns.size()) + ":";
    for (const int column : effect.dyr_columns)
      text += " " + std::string(effect.parameters[static_cast<std::size_t>(column)].symbol);
    return text;
  }
  static plant::Block values_of(const Effect& effect, const formats::DyrRecord& record) {
    plant::Block block{&effect, effect.standard_parameters()};
    for (std::size_t i = 0; i < record.values.size(); ++i)
      block.p[static_cast<std::size_t>(effect.dyr_columns[i])] = record.values[i];
    return block;
  }
  [[nodiscard]] plant::Block read(const Effect& effect, const formats::DyrRecord& record,
                                  const plant::Plant& plant) const {
    plant::Block block = values_of(effect, record);
    const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
    if (effect.raw_resistance >= 0) block.p[static_cast<std::size_t>(effect.raw_resistance)] = g.zr;
    if (effect.raw_reactance >= 0) block.p[static_cast<std::size_t>(effect.raw_reactance)] = g.zx;
    return block;
  }
  void place(plant::Plant& plant, plant::Block block, const std::string& where) {
    const Effect& effect = *block.effect;
    Problems found;
    effect.check(effect.law.get(), block.p.data(), where, found);
    problems_.add(found);
    if (effect.slot == Slot::machine) {
      if (plant.machine.effect) return taken(plant, effect, *plant.machine.effect, where);
      if (found.empty()) compare_reactance(plant, block, where);
      plant.machine = std::move(block);
      return;
    }
    if (effect.slot == Slot::transformer) {
      if (plant.transformer.effect) return taken(plant, effect, *plant.transformer.effect, where);
      plant.transformer = std::move(block);
      return;
    }
    for (const plant::Block& other : plant.controls)
      if (other.effect == &effect || (other.effect->slot == effect.slot && !is_shared(effect.slot)))
        return taken(plant, effect, *other.effect, where);
    plant.controls.push_back(std::move(block));
  }
  void taken(const plant::Plant& plant, const Effect& effect, const Effect& other, const std::string& where) {
    problems_.add("a second " + std::string(slot_name(effect.slot)) + " model, " +
                      std::string(effect.dyr_name) + ", for generator " + plant.name,
                  where, "it already has " + std::string(other.dyr_name), "keep one of them");
  }
  void compare_reactance(const plant::Plant& plant, const plant::Block& block,
                         const std::string& where) const {
    if (block.effect->raw_reactance >= 0) return;
    const double zx = grid_.network.generators[static_cast<std::size_t>(plant.generator)].zx;
    double r = 0.0, x = 0.0;
    block.effect->get<double>().machine.source_impedance(block.p.data(), r, x);
    constexpr double tolerance = 1e-4;  // [pu]: files round reactances to four or five digits
    if (zx != 0.0 && std::abs(zx - x) > tolerance)
      spdlog::warn("{}: generator {} has ZX = {} pu in {} but {} pu in its {}; the latter is used", where,
                   plant.name, zx, grid_.network.origin, x, block.effect->dyr_name);
  }
  void finish(plant::Plant& plant) {
    if (!plant.machine.effect) {
      const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
      problems_.add("no machine model for generator '" + g.id + "' at bus " + std::to_string(bus_number(g)),
                    dyr_, "it is in service in " + grid_.network.origin,
                    "add a record with one of " + machine_names() + ", or take the generator out of service");
    }
    std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
  }
  static std::string machine_names() {
    std::string names;
    for (const Effect& e : library::compiled_effects())
      if (e.slot == Slot::machine && !e.dyr_name.empty())
        names += (names.empty() ? "" : ", ") + std::string(e.dyr_name);
    return names;
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
  std::string dyr_;
  Grid grid_;
  Problems problems_;
  std::vector<LoadModel> load_models_;
  std::map<std::pair<int, std::string>, std::size_t> plant_of_;
  std::set<std::pair<int, std::string>> known_;  ///< every generator of the network
};

/// One record of a .dyr; `owner`: "generator 30" or "load 8", `id`: its id in the .raw; `raw`: the block with
/// what the .raw says of it.
std::string dyr_record(const plant::Block& block, const std::string& owner, int bus, const std::string& id,
                       const std::string& file, Problems& problems, const plant::Block* raw = nullptr) {
  const Effect& effect = *block.effect;
  const std::string where = file + ", " + owner;
  if (effect.dyr_name.empty()) {
    problems.add("model " + std::string(effect.name), where, "it has no form in a .dyr",
                 "remove it before writing");
    return {};
  }
  const auto standard = effect.standard_parameters();
  for (int i = 0; i < static_cast<int>(block.p.size()); ++i) {
    if (i == effect.raw_resistance || i == effect.raw_reactance || std::ranges::count(effect.dyr_columns, i))
      continue;
    const auto at = static_cast<std::size_t>(i);
    const Parameter& parameter = effect.parameters[at];
    if (raw && raw->p[at] == block.p[at]) continue;
    const double dropped = raw                             ? raw->p[at]
                           : std::isnan(parameter.neutral) ? standard[at]
                                                           : parameter.neutral;
    if (block.p[at] != dropped)
      problems.add(std::string(parameter.symbol) + " = " + formats::psse::shortest(block.p[at]) + " " +
                       std::string(parameter.unit) + " of " + std::string(effect.name),
                   where, raw ? "PSS/E takes it from the .raw" : "a .dyr has no column for it",
                   "set it to " + formats::psse::shortest(dropped) + " " + std::string(parameter.unit));
  }
  std::string text = std::to_string(bus) + " " + formats::psse::quote(std::string(effect.dyr_name)) + " " +
                     formats::psse::quote(id);
  for (const int column : effect.dyr_columns)
    text += " " + formats::psse::shortest(block.p[static_cast<std::size_t>(column)]);
  return text + " /\n";
}

std::string plant_record(const Grid& grid, const plant::Plant& plant, const plant::Block& block,
                         const std::string& file, Problems& problems) {
  const Effect& effect = *block.effect;
  const network::Generator& g = grid.network.generators[static_cast<std::size_t>(plant.generator)];
  const auto in_raw = [&](int index, double value, const char* field) {
    if (index >= 0 && block.p[static_cast<std::size_t>(index)] != value)
      problems.add(std::string(effect.parameters[static_cast<std::size_t>(index)].symbol) + " = " +
                       formats::psse::shortest(block.p[static_cast<std::size_t>(index)]) + " pu",
                   file + ", generator " + plant.name,
                   "the network has " + std::string(field) + " = " + formats::psse::shortest(value) +
                       " pu, and PSS/E keeps it in the .raw",
                   "set it in the network too");
  };
  in_raw(effect.raw_resistance, g.zr, "ZR");
  in_raw(effect.raw_reactance, g.zx, "ZX");
  return dyr_record(block, "generator " + plant.name,
                    grid.network.buses[static_cast<std::size_t>(plant.bus)].number, g.id, file, problems);
}

/// A step-up transformer stands in the .raw, or nowhere.
void write_transformer(const Grid& grid, const plant::Plant& plant, const std::string& file,
                       Problems& problems) {
  const network::Generator& g = grid.network.generators[static_cast<std::size_t>(plant.generator)];
  const plant::Block raw = has_transformer(g) ? transformer_of(g) : plant::Block{};
  if (plant.transformer.effect == raw.effect && plant.transformer.p == raw.p) return;
  problems.add("a step-up transformer that is not the network's", file + ", generator " + plant.name,
               "PSS/E keeps it in the .raw (RT, XT), a .dyr has no form of it",
               "set the generator's RT and XT in the network, or remove it before writing");
}

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

void write_dyr(const Grid& grid, const std::filesystem::path& file) {
  Problems problems;
  std::string text;
  for (const plant::Plant& plant : grid.plants) {
    text += plant_record(grid, plant, plant.machine, file.string(), problems);
    write_transformer(grid, plant, file.string(), problems);
    for (const plant::Block& control : plant.controls)
      text += plant_record(grid, plant, control, file.string(), problems);
  }
  for (const plant::Consumer& load : grid.loads) {
    const network::Load& l = grid.network.loads[static_cast<std::size_t>(load.load)];
    plant::Block raw{load.block.effect, load.block.effect->standard_parameters()};
    if (is_composed(*raw.effect)) compose(grid, load.load, raw, file.string(), problems);
    text += dyr_record(load.block, "load " + load.name,
                       grid.network.buses[static_cast<std::size_t>(load.bus)].number, l.id, file.string(),
                       problems, is_composed(*raw.effect) ? &raw : nullptr);
  }
  problems.raise();
  write_text(file, text);
}

}  // namespace swingbank::sim::grid
