#include "sim/grid/unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "base/capitals.hpp"
#include "sim/formats/matpower.hpp"
#include "sim/grid/detail/dyr_models.hpp"
#include "sim/grid/detail/step_up.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/usual.hpp"

namespace swingbank::sim::grid {
namespace {

class UnitReader {
 public:
  explicit UnitReader(const UnitChoice& choice) : choice_(choice) {
    if (!choice.dyd) formats::refuse_exchanged(choice.raw, choice.dyr);
    survey_ = formats::survey_network(choice.raw, {choice.frequency_hz, choice.raw_version});
    survey_.network.origin = choice.raw.string();
    if (choice.dyd) {
      dyd_ = formats::survey_dyd(choice.dyr);
      dynamics_ = dyd_.dyr;
    } else {
      dynamics_ = formats::survey_dyr(choice.dyr);
    }
    find_named_buses(dynamics_.records, survey_.network);
  }
  Unit read() {
    find_generator();
    problems_.raise();
    describe();
    read_models();
    if (problems_.empty()) note_infeasible_dispatch();
    if (choice_.measured_at)
      read_transformer(*choice_.measured_at);
    else
      note_transformer();
    note_remote_measurements();
    problems_.raise();
    return std::move(unit_);
  }

 private:
  [[nodiscard]] const network::Network& net() const { return survey_.network; }
  [[nodiscard]] const network::Bus& bus_at(int index) const {
    return net().buses[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const network::Generator& generator() const {
    return net().generators[static_cast<std::size_t>(generator_)];
  }
  [[nodiscard]] std::string line_of(const std::vector<int>& lines, std::size_t i) const {
    return net().origin + (i < lines.size() ? ":" + std::to_string(lines[i]) : "");
  }
  /// Adds the faults on these lines of the .raw to the problems.
  void faults_of(int first, int count) {
    for (const Problem& p : survey_.faults)
      for (int line = first; line < first + count; ++line)
        if (p.where == net().origin + ":" + std::to_string(line))
          problems_.add(p.what, p.where, p.why, p.remedy);
  }

  void find_generator() {
    const int bus = net().bus_index(choice_.bus);
    if (bus < 0)
      return problems_.add(fmt::format("no bus {}", choice_.bus), net().origin,
                           "the bus section does not contain it", "correct the bus number");
    std::vector<std::size_t> units, running;
    std::string ids;
    for (std::size_t i = 0; i < net().generators.size(); ++i) {
      const auto& g = net().generators[i];
      if (g.bus != bus) continue;
      ids += (ids.empty() ? "" : ", ") + g.id;
      if (!choice_.id.empty() && g.id != choice_.id) continue;
      units.push_back(i);
      if (g.in_service) running.push_back(i);
    }
    if (units.empty())
      return problems_.add(fmt::format("no generator{} at bus {}",
                                       choice_.id.empty() ? "" : " '" + choice_.id + "'", choice_.bus),
                           net().origin, ids.empty() ? nearest_generators() : "the ids there are " + ids,
                           "correct bus and id");
    if (units.size() > 1 && running.size() != 1)
      return problems_.add(
          fmt::format("{} generators at bus {}", units.size(), choice_.bus), net().origin,
          "their ids are " + ids,
          "choose one by --id; if a record contains several units, make one plant file per unit "
          "and a point file (--point; configs/plants/README.md)");
    const std::size_t at = units.size() == 1 ? units[0] : running[0];
    generator_ = static_cast<int>(at);
    if (at < survey_.generator_line.size()) faults_of(survey_.generator_line[at], 1);
  }
  /// Returns the number of branches in service on the shortest path from bus `start` to each bus; -1: no
  /// path.
  [[nodiscard]] std::vector<int> branches_from(std::size_t start) const {
    std::vector<std::vector<std::size_t>> neighbours(net().buses.size());
    for (const network::Branch& b : net().branches)
      if (b.in_service) {
        neighbours[static_cast<std::size_t>(b.from)].push_back(static_cast<std::size_t>(b.to));
        neighbours[static_cast<std::size_t>(b.to)].push_back(static_cast<std::size_t>(b.from));
      }
    std::vector<int> apart(net().buses.size(), -1);
    apart[start] = 0;
    std::vector<std::size_t> queue = {start};
    for (std::size_t k = 0; k < queue.size(); ++k)
      for (const std::size_t next : neighbours[queue[k]])
        if (apart[next] < 0) {
          apart[next] = apart[queue[k]] + 1;
          queue.push_back(next);
        }
    return apart;
  }
  /// Returns some buses with generators: the nearest in the grid, or by number if the bus does not exist.
  [[nodiscard]] std::string nearest_generators() const {
    const auto bus = std::ranges::find(net().buses, choice_.bus, &network::Bus::number);
    const bool known = bus != net().buses.end();
    const std::vector<int> apart =
        known ? branches_from(static_cast<std::size_t>(bus - net().buses.begin())) : std::vector<int>{};
    std::set<std::pair<int, int>> near;
    for (const auto& g : net().generators) {
      const int number = bus_at(g.bus).number;
      const int distance = known ? apart[static_cast<std::size_t>(g.bus)] : std::abs(number - choice_.bus);
      if (distance >= 0) near.emplace(distance, number);
    }
    std::string text;
    constexpr int shown = 8;
    int count = 0;
    for (const auto& [distance, number] : near) {
      if (++count > shown) {
        text += ", ...";
        break;
      }
      text += (text.empty() ? "" : ", ") + std::to_string(number);
      if (known) text += fmt::format(" ({} {})", distance, distance == 1 ? "branch" : "branches");
    }
    return (known ? "the nearest buses with generators are "
                  : fmt::format("there is no bus {}; the buses with generators of the nearest numbers are ",
                                choice_.bus)) +
           text;
  }

  void describe() {
    const network::Generator& g = generator();
    const network::Bus& bus = bus_at(g.bus);
    unit_.bus = choice_.bus;
    unit_.id = g.id;
    unit_.bus_name = bus.name;
    unit_.kv = bus.kv;
    unit_.frequency = net().frequency;
    unit_.system_mva = net().base_mva;
    unit_.plant.name = std::to_string(choice_.bus);
    unit_.plant.mva = g.mva;
    unit_.plant.transformer = transformer_of(g);
    if (!g.in_service) unit_.notes.push_back("the generator is out of service in " + net().origin);
  }

  void read_models() {
    for (const auto& record : dynamics_.records) {
      if (record.bus != unit_.bus || record.id != unit_.id) continue;
      const auto [own, reach] = effect_of_dyr(record);
      if (own && own->slot == Slot::load) continue;  // a load of this id at the same bus
      found_.insert(name_of(record));
      if (record.model != name_of(record)) found_.insert(record.model);
      if (!dropped(record)) read_model(record);
    }
    check_options();
    if (!unit_.plant.machine.effect && problems_.empty())
      problems_.add(fmt::format("no machine model for generator '{}' at bus {}", unit_.id, unit_.bus),
                    choice_.dyr.string(), lost_text(),
                    "add a record with one of " + machine_names() + ", or choose another unit");
    check_fit(unit_.plant, choice_.dyr.string(), problems_);
    sort_controls(unit_.plant);
    for (const std::string& text : idle_controls(unit_.plant))
      unit_.notes.push_back(text + ": it has no effect");
  }
  /// Adds a note if the operating point of the .raw is infeasible for the model. Measured records probably
  /// start there.
  void note_infeasible_dispatch() {
    const network::Bus& bus = bus_at(generator().bus);
    if (!generator().in_service || !(bus.vm > 0)) return;
    unit_.dispatch = {generator().p * net().base_mva, generator().q * net().base_mva, bus.vm};
    plant::Plant plant = unit_.plant;
    plant.generation = {generator().p, generator().q};
    try {
      (void)plant::operating_point(plant, std::polar(bus.vm, bus.va), net().base_mva,
                                   Conventions::psse(net().frequency));
    } catch (const InputError& error) {
      const Problem& p = error.problems().front();  // the other problems follow from it
      unit_.notes.push_back(fmt::format(
          "the operating point of {} is infeasible for this model: {} ({}); records that start there are refused",
          net().origin, p.what, p.why));
    }
  }
  /// Returns a possible reason for a missing machine record.
  [[nodiscard]] std::string lost_text() const {
    if (dynamics_.faults.empty()) return "it has no machine record";
    return "it has no machine record; the file has a fault: " + dynamics_.faults[0].sentence();
  }
  bool dropped(const formats::DyrRecord& record) {
    for (const auto& name : choice_.models.ignore)
      if (capitals(name) == record.model || capitals(name) == record.user) {
        unit_.notes.push_back(
            fmt::format("{} of line {} ignored (--ignore-model)", name_of(record), record.line));
        return true;
      }
    return false;
  }
  [[nodiscard]] const std::string* replacement(const formats::DyrRecord& record) const {
    for (const auto& [from, to] : choice_.models.map)
      if (capitals(from) == record.model || capitals(from) == record.user) return &to;
    return nullptr;
  }
  void read_model(formats::DyrRecord record) {
    const std::string where = choice_.dyr.string() + ":" + std::to_string(record.line);
    const std::string given = name_of(record);
    const std::string* other = replacement(record);
    if (other) {
      record.model = capitals(*other);
      record.user.clear();
    }
    const auto [effect, reach] = effect_of_dyr(record);
    if (!effect)
      return problems_.add(
          fmt::format("unknown model '{}' of unit '{}' at bus {}", name_of(record), unit_.id, unit_.bus),
          where,
          choice_.dyd ? "the models that can be read are " + formats::dyd_models_text()
                      : lacking_text(choice_.dyr.string()),
          fmt::format("leave it out with --drop {0}, or replace it with --replace {0}=OTHER "
                      "(under [grid] of a plant file: ignore_models, map_models)",
                      given));
    plant::Block block;
    if (record.unended)
      unit_.notes.push_back(fmt::format(
          "{}: {} has no final '/': it ends at the next record or at the end of the file", where, given));
    record = plain(record, *effect);
    if (other && record.values.size() != effect->dyr_columns.size()) {
      block = {effect, effect->default_parameters()};
      unit_.defaults.emplace_back(effect->name);
      unit_.notes.push_back(fmt::format(
          "{} of line {} replaced by {} with its defaults: {} parameters do not match the {} of {}", given,
          record.line, effect->dyr_name, record.values.size(), effect->dyr_columns.size(), effect->dyr_name));
    } else {
      problems_.add(record.faults);
      if (!record.faults.empty()) return;
      const Completion done = complete(*effect, record, choice_.complete_records, where, problems_);
      if (!done.sound) return;
      if (!done.what.empty()) unit_.notes.push_back(done.what + ": " + done.place);
      block = values_of(*effect, record);
      for (const int i : record.empty)
        unit_.notes.push_back(fmt::format("{}: empty parameter {} of {} is taken as zero", where, i, given));
      if (other)
        unit_.notes.push_back(
            fmt::format("{} of line {} read as {}, with its values", given, record.line, effect->dyr_name));
    }
    const network::Generator g = generator_with(record.line);
    take_from_raw(block, g);
    if (std::string left_out = remark_on(block, where, unit_.plant.name); !left_out.empty())
      unit_.notes.push_back(std::move(left_out));
    for (auto& text : plant::unusual_texts(block, where)) unit_.notes.push_back(std::move(text));
    std::string warning = place(unit_.plant, std::move(block), {g, net().origin}, where, problems_);
    if (!warning.empty()) unit_.notes.push_back(std::move(warning));
  }
  /// Returns the generator. Machine data of a .dyd replace those of the .raw.
  network::Generator generator_with(int line) {
    network::Generator g = generator();
    if (const auto note = dyd_.notes.find(line); note != dyd_.notes.end())
      unit_.notes.push_back(note->second);
    const auto at = dyd_.machines.find(line);
    if (at == dyd_.machines.end()) return g;
    g.zr = at->second.resistance;
    g.zx = at->second.reactance.value_or(0);  // 0: no value to compare with
    if (at->second.mva == unit_.plant.mva) return g;
    unit_.notes.push_back(
        fmt::format("the machine base is {0:g} MVA in the .dyd and {2:g} MVA in {1}: the .dyd is used",
                    at->second.mva, net().origin, unit_.plant.mva));
    if (plant::Block& transformer = unit_.plant.transformer; transformer.effect)
      for (const char* name : {"R", "X"})
        UnitReader::at(transformer, name) *= at->second.mva / unit_.plant.mva;
    unit_.plant.mva = at->second.mva;
    return g;
  }
  /// Adds a problem for a model name of the options that does not occur in the file.
  void check_options() {
    std::set<std::string> all;
    for (const auto& r : dynamics_.records) all.insert({r.model, name_of(r)});
    std::vector<std::string> asked = choice_.models.ignore;
    for (const auto& [from, to] : choice_.models.map) asked.push_back(from);
    for (const auto& name : asked) {
      if (found_.contains(capitals(name))) continue;
      if (all.contains(capitals(name)))
        unit_.notes.push_back("this unit has no record of " + capitals(name));
      else
        problems_.add(
            "no model " + name + " to drop or replace", choice_.dyr.string(),
            found_.empty() ? "the unit has no records"
                           : fmt::format("the unit has {}", fmt::join(found_, ", ")),
            "correct the name, or remove it from --drop or --replace (under [grid] of a plant file: "
            "ignore_models, map_models)");
    }
  }

  /// Returns the numbers of the buses connected to the unit's bus by transformers in service.
  [[nodiscard]] std::set<int> transformers_to() const {
    std::set<int> ends;
    const int own = generator().bus;
    for (const network::Branch& b : net().branches) {
      if (!b.transformer || !b.in_service || (b.from != own && b.to != own)) continue;
      const network::Bus& other = bus_at(b.from == own ? b.to : b.from);
      if (!other.is_star()) ends.insert(other.number);
      for (const int number : other.star_of)
        if (other.is_star() && number != unit_.bus) ends.insert(number);
    }
    return ends;
  }
  void note_transformer() {
    const std::set<int> ends = transformers_to();
    if (ends.empty() || ends.size() > 2) return;
    unit_.notes.push_back(fmt::format(
        "the model ends at bus {}; for records taken at bus {}, behind the transformer, use --measured-at {} "
        "(under [grid] of a plant file: measured_at)",
        unit_.bus, fmt::join(ends, " or bus "), *ends.begin()));
  }
  void read_transformer(int measured_at) {
    if (measured_at == unit_.bus) return;
    const int far = net().bus_index(measured_at);
    StepUp first;  // the unit's own transformer, between the machine and its bus
    if (unit_.plant.transformer.effect) {
      plant::Block& own = unit_.plant.transformer;
      first.z = Complex(at(own, "R"), at(own, "X")) * (net().base_mva / unit_.plant.mva);
      first.ratio = at(own, "ratio");
    }
    const StepUp way = far < 0 ? StepUp{} : step_up(net(), generator().bus, far, first);
    if (!way.found()) {
      const std::set<int> ends = transformers_to();
      return problems_.add(
          fmt::format("no transformers lead from bus {} to bus {}", unit_.bus, measured_at), net().origin,
          ends.empty() ? "no transformer is connected to the unit's bus"
                       : fmt::format("those at the unit's bus lead to {}", fmt::join(ends, ", ")),
          "give a bus behind the unit's transformers, or take the records at the unit's own bus");
    }
    for (const auto& stage : way.stages)
      for (const std::size_t i : stage)
        if (i < survey_.branch_line.size()) faults_of(survey_.branch_line[i], kTransformerLines);
    neighbours(measured_at);
    passed(way, measured_at);
    add_transformer(way);
    unit_.kv = bus_at(far).kv;
    if (unit_.dispatch) dispatch_behind(way.z - first.z, bus_at(far));
  }
  /// Refers the dispatch from the machine's bus to the measured bus by subtracting the losses in between.
  /// `z`: impedance of the transformers on the machine's side [pu on the case's base].
  void dispatch_behind(Complex z, const network::Bus& there) {
    Dispatch& d = *unit_.dispatch;
    const double current = std::hypot(d.P, d.Q) / net().base_mva / d.V;
    d.P -= current * current * z.real() * net().base_mva;
    d.Q -= current * current * z.imag() * net().base_mva;
    d.V = there.vm;
  }
  /// Adds a note on remote measurements: in a plant file they take place at the measured bus.
  void note_remote_measurements() {
    const int recorded = choice_.measured_at.value_or(unit_.bus);
    for (const plant::Block& block : unit_.plant.controls) {
      const Elsewhere& at = block.effect->elsewhere;
      const int bus = number_in(block, at.bus), from = number_in(block, at.from);
      if ((bus == 0 || bus == recorded) && (from == 0 || from == recorded)) continue;
      unit_.notes.push_back(fmt::format(
          "{} measures at bus {}; in a plant file it measures where the records are taken: take them at that "
          "bus, and give the network in between by --measured-at or as [collector] of a point file",
          block.effect->name, bus != 0 && bus != recorded ? bus : from));
    }
  }
  /// Adds a problem for another generator at the machine's bus, and notes for loads and shunts there. Their
  /// current also flows through the transformer.
  void neighbours(int measured_at) {
    const int bus = generator().bus;
    for (std::size_t i = 0; i < net().generators.size(); ++i) {
      const auto& g = net().generators[i];
      if (g.bus == bus && g.in_service && static_cast<int>(i) != generator_)
        problems_.add(fmt::format("second generator, '{}', at bus {}", g.id, unit_.bus),
                      line_of(survey_.generator_line, i),
                      fmt::format("the current at bus {} is the sum of both", measured_at), kOfBoth);
    }
    for (const auto& l : net().loads)
      if (l.bus == bus)
        unit_.notes.push_back(
            fmt::format("load '{}' at bus {} is included in the measurement at bus {} but not in the model",
                        l.id, unit_.bus, measured_at));
    for (const auto& s : net().shunts)
      if (s.bus == bus && s.admittance != Complex{})
        unit_.notes.push_back(
            fmt::format("shunt '{}' at bus {} is included in the measurement at bus {} but not in the model",
                        s.id, unit_.bus, measured_at));
  }
  /// Adds problems for other equipment between the transformers, and for parallel transformers of different
  /// ratios.
  void passed(const StepUp& way, int measured_at) {
    for (std::size_t k = 1; k + 1 < way.buses.size(); ++k)
      if (const std::string other = joins_on_the_way(net(), way, way.buses[k]); !other.empty())
        problems_.add(
            fmt::format("{} between bus {} and bus {}", other, unit_.bus, measured_at), net().origin,
            fmt::format("the current at bus {} includes that of other equipment", measured_at), kOfBoth);
    if (!way.same_ratio)
      problems_.add(fmt::format("parallel transformers of different ratios between bus {} and bus {}",
                                unit_.bus, measured_at),
                    net().origin, "their circulating current is not modelled",
                    "take the records at the unit's own bus");
  }
  /// Adds the effect STEPUP, with its impedance on the machine's side and base.
  void add_transformer(const StepUp& way) {
    std::string where;
    for (const auto& stage : way.stages) {
      where += where.empty() ? "" : ", in series with ";
      for (std::size_t k = 0; k < stage.size(); ++k)
        where += (k > 0 ? " parallel to " : "") + line_of(survey_.branch_line, stage[k]);
    }
    plant::Block& block = unit_.plant.transformer;
    if (!block.effect) {
      block = {library::compiled().find("STEPUP"), {}};
      block.p = block.effect->default_parameters();
    }
    const double scale = unit_.plant.mva / net().base_mva;
    at(block, "R") = way.z.real() * scale;
    at(block, "X") = way.z.imag() * scale;
    at(block, "ratio") = way.ratio;
    if (way.magnetising)
      unit_.notes.push_back("the transformer's magnetising current is neglected (" + where + ")");
    unit_.notes.push_back("the transformer is taken from " + where);
    block.effect->check(nullptr, block.p.data(), where, problems_);
  }
  static double& at(plant::Block& block, const char* name) {
    return block.p[static_cast<std::size_t>(block.effect->parameter_index(name))];
  }

  static constexpr int kTransformerLines = 4;
  static constexpr const char* kOfBoth =
      "make a plant file of each unit and one point file of all for --point "
      "(configs/plants/README.md), or take the records at the unit's own bus";
  const UnitChoice& choice_;
  formats::RawSurvey survey_;
  formats::DyrSurvey dynamics_;
  formats::DydSurvey dyd_;  ///< empty for records of a .dyr
  int generator_ = -1;
  Unit unit_;
  std::set<std::string> found_;  ///< models of the unit
  Problems problems_;
};

}  // namespace

Unit read_unit(const UnitChoice& choice) { return UnitReader(choice).read(); }

}  // namespace swingbank::sim::grid
