#include "sim/grid/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "sim/grid/detail/dyr_models.hpp"
#include "sim/grid/far.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/plant/usual.hpp"

namespace swingbank::sim::grid {
namespace {

class GridMaker {
 public:
  GridMaker(network::Network network, const std::string& dyr, Conventions conventions,
            const CaseOptions& options)
      : dyr_(dyr), options_(options) {
    grid_.network = std::move(network);
    grid_.conventions = conventions;
    grid_.flow_options = options.flow;
    grid_.conventions.frequency = grid_.network.frequency;
    plants();
  }
  Grid make(std::vector<formats::DyrRecord> dynamics) {
    find_named_buses(dynamics, grid_.network);
    if (!dynamics.empty() && dynamics.back().unended) cut_off_at_ = dynamics.back().line;
    for (const formats::DyrRecord& record : dynamics) add(record);
    report_refused();
    report_unknown();
    for (plant::Plant& plant : grid_.plants) finish(plant);
    report_unmodelled();
    problems_.raise();
    solve();
    net_generators();
    devices();
    shunts_with_models();
    for (LoadModel& model : load_models_) {
      if (is_composed(*model.block.effect)) compose(grid_, model.load, model.block, model.where, problems_);
      set_load(grid_, model.load, std::move(model.block), model.where, problems_);
    }
    problems_.raise();
    look_far(grid_);
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
    const std::pair<int, std::string> key{given.bus, given.id};
    const bool of_load = effect && effect->slot == Slot::load;
    if (known_.contains(key) && !plant_of_.contains(key) && !of_load) return;  // the unit is out of service
    if (!effect) return unknown(given, where);
    if (!given.equipment.empty())
      return problems_.add(
          given.model + " at '" + given.equipment + "'", where,
          "not exactly one bus of " + grid_.network.origin + " has this name and base voltage",
          "give the bus number in its place");
    if (given.unended)
      grid_.network.remark(
          "records without a final '/'; each is taken to end at the next record or at the end of the file",
          given.model + " of '" + given.id + "' at bus " + std::to_string(given.bus) + " (" + where + ")");
    Problems refused;
    take(*effect, reach, plain(given, *effect), where, refused);
    if (!refused.empty() && !options_.drop_refused && effect->slot == Slot::machine) refused_.insert(key);
    for (const Problem& p : refused.list()) {
      if (options_.drop_refused)
        grid_.network.remark(
            "records with values that their model does not accept are ignored (--drop-refused)",
            p.what + " (" + p.where + ")");
      else
        refuse(p, given.line);
    }
  }
  /// Collects records with the same error into one problem.
  void refuse(const Problem& p, int line) {
    const auto same = std::ranges::find_if(
        alike_, [&](const Alike& a) { return a.first.what == p.what && a.first.why == p.why; });
    if (same == alike_.end())
      alike_.push_back({p, {}});
    else
      same->lines.push_back(line);
  }
  void report_refused() {
    constexpr std::size_t kLines = 10;
    for (const Alike& a : alike_) {
      std::string more;
      for (std::size_t k = 0; k < std::min(a.lines.size(), kLines); ++k)
        more += (k > 0 ? ", " : "") + std::to_string(a.lines[k]);
      if (!a.lines.empty())
        more = " and " + std::to_string(a.lines.size()) + " more, on lines " + more +
               (a.lines.size() > kLines ? ", …" : "");
      problems_.add(a.first.what, a.first.where + more, a.first.why,
                    a.first.remedy + ", or leave " + (more.empty() ? "the record" : "these records") +
                        " out with --drop-refused");
    }
  }
  void take(const Effect& effect, Reach reach, formats::DyrRecord record, const std::string& where,
            Problems& problems) {
    problems.add(record.faults);
    if (!record.faults.empty()) return;
    if (effect.at_shunt)
      add_shunt_model(effect, std::move(record), where, problems);
    else if (effect.slot == Slot::load)
      add_load(effect, reach, std::move(record), where, problems);
    else
      add_control(effect, std::move(record), where, problems);
  }
  /// Returns true if the record has the required length, after completion as the options allow.
  bool fits(const Effect& effect, formats::DyrRecord& record, const std::string& where, Problems& problems) {
    report_empty(record, where);
    const Completion done = complete(effect, record, options_.complete_records, where, problems);
    if (!done.what.empty()) grid_.network.remark(done.what, done.place);
    return done.sound;
  }
  void add_control(const Effect& effect, formats::DyrRecord record, const std::string& where,
                   Problems& problems) {
    const std::pair<int, std::string> key{record.bus, record.id};
    const auto found = plant_of_.find(key);
    if (found == plant_of_.end()) {
      grid_.network.remark(
          "records for generators that the network does not have are ignored",
          record.model + " of '" + record.id + "' at bus " + std::to_string(record.bus) + " (" + where + ")");
      return;
    }
    if (!fits(effect, record, where, problems)) return;
    plant::Plant& plant = grid_.plants[found->second];
    const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
    plant::Block block = values_of(effect, record);
    take_from_raw(block, g);
    if (const std::string left_out = remark_on(block, where, plant.name); !left_out.empty())
      grid_.network.remark("values that the equations interpret differently or ignore", left_out);
    for (const std::string& text : plant::unusual_texts(block, where))
      grid_.network.remark("values outside their usual range", text);
    const plant::Plant before = plant;
    const std::string warning = place(plant, std::move(block), {g, grid_.network.origin}, where, problems);
    if (!problems.empty()) plant = before;
    if (!warning.empty())
      grid_.network.remark("reactance of the .dyr differs from ZX of the .raw; the .dyr is used", warning);
  }
  void report_empty(const formats::DyrRecord& record, const std::string& where) {
    for (const int i : record.empty)
      grid_.network.remark("empty parameters of the .dyr are taken as zero",
                           record.model + " parameter " + std::to_string(i) + " (" + where + ")");
  }
  /// Collects the records of an unknown model into one problem per model.
  void unknown(const formats::DyrRecord& record, const std::string& where) {
    Unknown& one = unknown_[{record.user.empty() ? record.model : record.user, !record.user.empty()}];
    if (++one.records > 1) return;
    one.where = where;
    one.first = record.equipment.empty() ? "'" + record.id + "' at bus " + std::to_string(record.bus)
                                         : "equipment '" + record.equipment + "'";
    one.parameters = record.values.size() - std::min(record.values.size(), record.codes);
  }
  void report_unknown() {
    for (const auto& [model, one] : unknown_) {
      const auto& [name, user] = model;
      const std::string others =
          one.records > 1 ? " and " + std::to_string(one.records - 1) + " more" : std::string();
      problems_.add(
          (user ? "user-written model '" : "unknown model '") + name + "' of " + one.first + others,
          one.where, lacking_text(dyr_),
          "leave it out with --ignore-model " + name +
              (one.parameters == 0 ? std::string()
                                   : ", or map it to a model with " + std::to_string(one.parameters) +
                                         " parameters: --map-model " + name + "=OTHER"));
    }
  }
  /// Adds a model to the loads of a bus, an owner, a zone, an area or the grid that have the record's id. The
  /// id * selects all of them.
  void add_load(const Effect& effect, Reach reach, formats::DyrRecord record, const std::string& where,
                Problems& problems) {
    constexpr std::array of = {"at bus", "of owner", "in zone", "in area", "anywhere"};
    const std::string what = record.model + " for load '" + record.id + "' " +
                             of[static_cast<std::size_t>(reach)] +
                             (reach == Reach::all ? "" : " " + std::to_string(record.bus));
    const int bus = grid_.network.bus_index(record.bus);
    if (reach == Reach::load && bus < 0) {
      problems.add(what, where, grid_.network.origin + " has no such bus",
                   "correct the bus number, or remove the record");
      return;
    }
    if (!fits(effect, record, where, problems)) return;
    Problems found;
    const plant::Block block = values_of(effect, record);
    effect.check(effect.user_model.get(), block.p.data(), where, found);
    problems.add(found);
    if (!found.empty()) return;
    bool any = false;
    for (std::size_t i = 0; i < grid_.network.loads.size(); ++i) {
      const network::Load& load = grid_.network.loads[i];
      const int number[] = {bus, record.bus, record.bus, record.bus, 0};
      const int own[] = {load.bus, load.owner, load.zone, load.area, 0};
      const auto r = static_cast<std::size_t>(reach);
      if (own[r] != number[r] || (record.id != "*" && load.id != record.id)) continue;
      if (load.kind != network::LoadKind::load) continue;
      if (record.id == "*" && load.power == Complex{} && load.current == Complex{} &&
          load.admittance == Complex{})
        continue;  // zero consumption
      any = true;
      const auto same = [&](const LoadModel& m) { return m.load == static_cast<int>(i); };
      const auto other = std::ranges::find_if(load_models_, same);
      const LoadModel model{static_cast<int>(i), block, where, reach};
      if (other == load_models_.end())
        load_models_.push_back(model);
      else if (reach < other->reach)
        *other = model;
      else if (reach == other->reach)
        problems.add("a second model, " + what, where,
                     "it already has " + std::string(other->block.effect->dyr_name), "keep one of them");
    }
    if (!any)
      grid_.network.remark("models of loads that are missing or out of service are ignored",
                           what + " (" + where + ")");
  }
  /// Adds a model of a switched shunt. A record without an id applies to the first switched shunt of its bus.
  void add_shunt_model(const Effect& effect, formats::DyrRecord record, const std::string& where,
                       Problems& problems) {
    const std::string what = record.model + " at bus " + std::to_string(record.bus);
    if (!fits(effect, record, where, problems)) return;
    ShuntModel model{grid_.network.bus_index(record.bus), {}, values_of(effect, record), where};
    effect.check(effect.user_model.get(), model.block.p.data(), where, problems);
    (void)regulated_index(grid_.network, model.block, where, problems);
    const auto is_its = [&](const network::Shunt& s) {
      return s.bus == model.bus &&
             (record.id == kAnyShunt ? s.id.starts_with("SW")
                                     : s.id == (record.id == "1" ? "SW" : "SW" + record.id));
    };
    const auto shunt = std::ranges::find_if(grid_.network.shunts, is_its);
    if (shunt == grid_.network.shunts.end()) {
      grid_.network.remark("models of switched shunts that are missing or out of service are ignored",
                           what + " (" + where + ")");
      return;
    }
    model.id = shunt->id;
    const auto same = [&](const ShuntModel& m) { return m.bus == model.bus && m.id == model.id; };
    if (std::ranges::any_of(shunt_models_, same))
      problems.add("a second model, " + what, where, "its switched shunt already has one",
                   "keep one of them");
    if (!problems.empty()) return;
    if (const std::string left_out = effect.remark ? effect.remark(model.block.p.data()) : std::string();
        !left_out.empty())
      grid_.network.remark("values that the equations interpret differently or ignore",
                           where + ": " + what + ": " + left_out);
    shunt_models_.push_back(std::move(model));
  }
  /// Converts each switched shunt with a model to a load with the power flow's susceptance and that model.
  void shunts_with_models() {
    network::Network& n = grid_.network;
    for (ShuntModel& model : shunt_models_) {
      const auto at = std::ranges::find_if(
          n.shunts, [&](const network::Shunt& s) { return s.bus == model.bus && s.id == model.id; });
      const network::Bus& bus = n.buses[static_cast<std::size_t>(model.bus)];
      n.loads.push_back({model.bus,
                         model.id,
                         {},
                         {},
                         std::conj(at->admittance),
                         bus.area,
                         bus.zone,
                         bus.owner,
                         network::LoadKind::shunt});
      n.shunts.erase(at);
      set_load(grid_, static_cast<int>(n.loads.size()) - 1, std::move(model.block), model.where, problems_);
    }
  }
  void finish(plant::Plant& plant) {
    const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(plant.generator)];
    if (!plant.machine.effect && !refused_.contains({bus_number(g), g.id}))
      unmodelled_.push_back(plant.generator);
    check_fit(plant, dyr_, problems_);
    sort_controls(plant);
    for (const std::string& text : idle_controls(plant))
      grid_.network.remark("controls of the field voltage have no effect on a machine without field winding",
                           text);
  }
  [[nodiscard]] std::string unit_text(int generator) const {
    const network::Generator& g = grid_.network.generators[static_cast<std::size_t>(generator)];
    return "'" + g.id + "' at bus " + std::to_string(bus_number(g));
  }
  /// Returns a hint if the .dyr seems truncated, either within a record or before the records of the
  /// network's last generators.
  [[nodiscard]] std::string cut_off_text() const {
    if (cut_off_at_ > 0)
      return fmt::format("; no '/' ends the last record, on line {}: the file may be truncated", cut_off_at_);
    const auto modelled = std::ranges::max_element(
        grid_.plants, {}, [](const plant::Plant& p) { return p.machine.effect ? p.generator : -1; });
    const bool at_the_end = modelled != grid_.plants.end() && modelled->machine.effect &&
                            modelled->generator < std::ranges::min(unmodelled_);
    return at_the_end ? "; all generators before them have a machine model, so the .dyr may be truncated"
                      : "";
  }
  /// Reports all generators without a machine model in one problem.
  void report_unmodelled() {
    if (unmodelled_.empty() || options_.net_generators) return;
    constexpr std::size_t most = 20;
    std::string list;
    for (std::size_t i = 0; i < unmodelled_.size() && i < most; ++i)
      list += (i ? ", " : "") + unit_text(unmodelled_[i]);
    if (unmodelled_.size() > most) list += " and " + std::to_string(unmodelled_.size() - most) + " more";
    const bool one = unmodelled_.size() == 1;
    problems_.add(
        one ? "no machine model for generator " + list
            : "no machine model for " + std::to_string(unmodelled_.size()) + " generators: " + list,
        dyr_, (one ? "it is" : "they are") + (" in service in " + grid_.network.origin) + cut_off_text(),
        "add records with one of " + machine_names() +
            ", take them out of service, or continue with --net-generators, which makes them negative loads");
  }
  void solve() {
    if (options_.start_from_file)
      grid_.flow = network::flow_of_file(grid_.network);
    else
      grid_.flow = network::solve_power_flow(grid_.network, options_.flow);
    switched_shunts();
    compare_with_file();
    for (const int bus : grid_.flow.at_limit)
      grid_.network.remark("generators at a reactive limit do not regulate their voltage", bus_text(bus));
    for (plant::Plant& plant : grid_.plants)
      plant.generation = grid_.flow.generation[static_cast<std::size_t>(plant.generator)];
  }
  /// Writes the shunt steps of the power flow into the network.
  void switched_shunts() {
    network::Network& n = grid_.network;
    if (!options_.flow.step_shunts || options_.start_from_file) {
      for (const network::SwitchedShunt& s : n.switched)
        n.remark(options_.start_from_file
                     ? "switched shunts stay at BINIT, for which the file's voltages were solved"
                     : "switched shunts stay at BINIT (--switched-shunts step makes them step)",
                 bus_text(s.bus));
      return;
    }
    for (const network::SteppedShunt& stepped : grid_.flow.stepped) {
      network::SwitchedShunt& s = n.switched[stepped.which];
      const auto mvar = [&](double b) { return fmt::format("{:.2f} Mvar", b * n.base_mva); };
      if (stepped.susceptance != s.present)
        n.remark("switched shunts were stepped (--switched-shunts step)",
                 bus_text(s.bus) + " " + mvar(s.present) + " to " + mvar(stepped.susceptance));
      if (!stepped.in_band)
        n.remark("switched shunts have no step within their voltage band",
                 bus_text(s.bus) +
                     fmt::format(" regulates {} within {:g} to {:g} pu, reached: {:.4f} pu",
                                 bus_text(s.regulated), s.least, s.most,
                                 std::abs(grid_.flow.voltage[static_cast<std::size_t>(s.regulated)])));
      std::erase_if(n.shunts, [&](const network::Shunt& o) { return o.bus == s.bus && o.id == s.id; });
      s.present = stepped.susceptance;
      n.shunts.push_back({s.bus, s.id, {0.0, s.present}});
    }
  }
  [[nodiscard]] std::string bus_text(int bus) const { return grid_.network.bus_text(bus); }
  /// Adds a remark on buses where the solution differs from the file's voltages.
  void compare_with_file() {
    constexpr double apart = 1e-3;  // smallest reported difference [pu]
    std::vector<std::pair<double, std::size_t>> far;
    for (std::size_t i = 0; i < grid_.network.buses.size(); ++i) {
      const network::Bus& b = grid_.network.buses[i];
      const double by = std::abs(grid_.flow.voltage[i]) - b.vm;
      if (b.type != network::BusType::isolated && !b.is_star() && std::abs(by) > apart)
        far.emplace_back(by, i);
    }
    std::ranges::sort(far, std::greater{}, [](const auto& f) { return std::abs(f.first); });
    for (const auto& [by, i] : far)
      grid_.network.remark(
          "the solution differs from the file's voltages by more than 1e-3 pu (--start file keeps them), "
          "largest first",
          bus_text(static_cast<int>(i)) + fmt::format(" {:.4f} pu, file {:.4f} pu",
                                                      std::abs(grid_.flow.voltage[i]),
                                                      grid_.network.buses[i].vm));
  }
  /// Converts generators without a machine model to negative loads, as PSS/E's GNET does.
  void net_generators() {
    for (const int k : unmodelled_) {
      network::Generator& g = grid_.network.generators[static_cast<std::size_t>(k)];
      const network::Bus& bus = grid_.network.buses[static_cast<std::size_t>(g.bus)];
      Complex& s = grid_.flow.generation[static_cast<std::size_t>(k)];
      network::Load load{
          g.bus, "-" + g.id, -s, {}, {}, bus.area, bus.zone, bus.owner, network::LoadKind::generator};
      grid_.network.remark(
          "generators without a machine model become negative loads (--net-generators)",
          unit_text(k) + fmt::format(" {:.2f} MW, {:.2f} Mvar", s.real() * grid_.network.base_mva,
                                     s.imag() * grid_.network.base_mva));
      grid_.network.loads.push_back(std::move(load));
      g.in_service = false;
      s = {};
    }
    std::erase_if(grid_.plants, [](const plant::Plant& p) { return !p.machine.effect; });
  }
  /// Models equipment without a dynamic model as constant P and Q.
  void devices() {
    const Effect* zip = library::compiled().find("ZIP");
    for (std::size_t i = 0; i < grid_.network.loads.size(); ++i) {
      const network::Load& l = grid_.network.loads[i];
      if (l.kind != network::LoadKind::device || l.power == Complex{}) continue;
      plant::Block block{zip, zip->default_parameters()};
      for (const char* part : {"Pp", "Qp"})
        block.p[static_cast<std::size_t>(zip->parameter_index(part))] = 1.0;
      set_load(grid_, static_cast<int>(i), std::move(block), bus_text(l.bus), problems_);
    }
  }

  struct LoadModel {
    int load;  ///< index into Network::loads
    plant::Block block;
    std::string where;
    Reach reach;
  };
  struct ShuntModel {
    int bus;         ///< index of its own bus
    std::string id;  ///< id in Network::shunts
    plant::Block block;
    std::string where;
  };
  struct Unknown {
    int records = 0;
    std::string where, first;  ///< place and description of its first record
    std::size_t parameters = 0;
  };
  std::string dyr_;
  CaseOptions options_;
  int cut_off_at_ = 0;           ///< line of the .dyr's last record if no '/' ends it, else 0
  std::vector<int> unmodelled_;  ///< generators in service without a machine model
  Grid grid_;
  Problems problems_;
  std::vector<LoadModel> load_models_;
  std::vector<ShuntModel> shunt_models_;
  struct Alike {
    Problem first;
    std::vector<int> lines;  ///< lines of the other records with this error
  };
  std::vector<Alike> alike_;                                 ///< records that their model does not accept
  std::map<std::pair<std::string, bool>, Unknown> unknown_;  ///< key: name, and true for a user-written model
  std::map<std::pair<int, std::string>, std::size_t> plant_of_;
  std::set<std::pair<int, std::string>> refused_;  ///< generators with a refused machine record
  std::set<std::pair<int, std::string>> known_;    ///< every generator of the network
};

}  // namespace

std::vector<int> Grid::modelled_loads() const {
  std::vector<int> list;
  for (const plant::Consumer& c : loads) list.push_back(c.load);
  std::ranges::sort(list);
  return list;
}

Grid make_grid(network::Network network, const std::vector<formats::DyrRecord>& dynamics,
               const std::string& dyr_name, Conventions conventions, const CaseOptions& options) {
  return GridMaker(std::move(network), dyr_name, conventions, options).make(dynamics);
}

}  // namespace swingbank::sim::grid
