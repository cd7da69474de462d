#include "sim/grid/inventory.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "sim/formats/dyd.hpp"
#include "sim/formats/matpower.hpp"
#include "sim/grid/detail/dyr_models.hpp"

namespace swingbank::sim::grid {
namespace {

using Key = std::pair<int, std::string>;  ///< bus number and id

class InventoryTaker {
 public:
  InventoryTaker(const formats::RawSurvey& raw, const formats::DyrSurvey& dyr, std::string dyr_name)
      : raw_(raw), dyr_(dyr), dyr_name_(std::move(dyr_name)) {}
  Inventory take() {
    units();
    for (const auto& record : dyr_.records) count(record);
    for (auto& [name, model] : models_) {
      model.units = static_cast<int>(of_units_[name].size());
      out_.models.push_back(model);
    }
    std::ranges::stable_sort(out_.models, std::greater{}, &ModelCount::records);
    for (const Problem& p : raw_.faults) out_.raw_faults.push_back(p.sentence());
    for (const Problem& p : dyr_.faults) out_.dyr_faults.push_back(p.sentence());
    return std::move(out_);
  }

 private:
  void units() {
    for (const network::Generator& g : raw_.network.generators) {
      const network::Bus& bus = raw_.network.buses[static_cast<std::size_t>(g.bus)];
      unit_of_.emplace(Key{bus.number, g.id}, out_.units.size());
      UnitCount unit;
      unit.bus = bus.number;
      unit.id = g.id;
      unit.bus_name = bus.name;
      unit.mva = g.mva;
      unit.in_service = g.in_service;
      out_.units.push_back(std::move(unit));
    }
  }
  void count(const formats::DyrRecord& record) {
    const std::string name = name_of(record);
    ModelCount& model = models_[name];
    if (++model.records == 1) {
      model.name = name;
      model.first_line = record.line;
    }
    const auto [effect, reach] = effect_of_dyr(record);
    const auto found = unit_of_.find({record.bus, record.id});
    const bool of_unit = found != unit_of_.end() && (!effect || effect->slot != Slot::load);
    const network::Generator* g = of_unit ? &raw_.network.generators[found->second] : nullptr;
    if (effect) model.kind = slot_name(effect->slot);
    std::string fault;
    if (effect) fault = fault_of(*effect, record, g, dyr_name_ + ":" + std::to_string(record.line));
    if (!fault.empty() && ++model.faulty == 1) model.fault = fault;
    if (of_unit)
      add(out_.units[found->second], name, effect, fault.empty());
    else if (effect && effect->slot != Slot::load && ++out_.without_generator == 1)
      out_.first_without_generator = record.line;
    if (of_unit) of_units_[name].insert({record.bus, record.id});
  }
  static void add(UnitCount& unit, const std::string& name, const Effect* effect, bool sound) {
    unit.models.push_back(name);
    if (!effect || !sound)
      unit.uncovered.push_back(name);
    else if (effect->slot == Slot::machine)
      unit.machine = true;
    if (effect && effect->slot == Slot::machine)
      unit.classical = !effect->converter && !reads_field_voltage(*effect);
    if (effect && acts_on_field(effect->slot)) ++unit.field_records;
  }

  const formats::RawSurvey& raw_;
  const formats::DyrSurvey& dyr_;
  std::string dyr_name_;
  Inventory out_;
  std::map<Key, std::size_t> unit_of_;
  std::map<std::string, ModelCount> models_;
  std::map<std::string, std::set<Key>> of_units_;
};

}  // namespace

Inventory take_inventory(const std::filesystem::path& raw, const std::filesystem::path& dyr,
                         const formats::RawOptions& options) {
  formats::refuse_exchanged(raw, dyr);
  formats::RawOptions counting = options;
  counting.needs_frequency = false;  // no simulation follows
  const formats::RawSurvey survey = formats::survey_network(raw, counting);
  formats::DyrSurvey dynamics =
      formats::is_dyd(dyr) ? formats::survey_dyd(dyr).dyr : formats::survey_dyr(dyr);
  find_named_buses(dynamics.records, survey.network);
  return InventoryTaker(survey, dynamics, dyr.string()).take();
}

}  // namespace swingbank::sim::grid
