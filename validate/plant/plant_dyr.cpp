#include "validate/plant/plant_dyr.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/write_file.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::validate::plant {
namespace {

std::vector<const sim::plant::Block*> dyr_blocks(const PlantModel& model) {
  std::vector<const sim::plant::Block*> all;
  for (int b = 0; b < sim::plant::first_measurement(model.plant); ++b)
    all.push_back(&sim::plant::block_at(model.plant, b));
  return all;
}

/// Returns the names of the blocks that are new or whose values differ from `before`.
std::vector<std::string> changed_blocks(const PlantModel& before, const PlantModel& model) {
  const auto old = dyr_blocks(before);
  std::vector<std::string> names;
  for (const auto* block : dyr_blocks(model)) {
    const auto same = [&](const auto* o) {
      return o->effect->name == block->effect->name && o->p == block->p;
    };
    if (std::ranges::none_of(old, same)) names.emplace_back(block->effect->name);
  }
  return names;
}

void check_bus(const PlantModel& model, const std::string& where, Problems& problems) {
  if (model.bus <= 0)
    problems.add("no bus number", where, "each record begins with the bus number",
                 "write bus and id under [plant], or give --bus and --id");
}

/// Returns the head and the nameplate as comments.
std::string comments(const PlantModel& model, std::vector<std::string> head, const std::string& mark) {
  for (const NameplateLine& line : nameplate_lines(model.nameplate, model.plant))
    if (!line.missing) head.push_back(line.label + ": " + line.text());
  std::string text;
  for (std::string line : head) {
    std::ranges::replace_if(
        line, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    text += mark + line + "\n";
  }
  return text;
}

}  // namespace

std::string dyr_text(const PlantModel& model, const std::vector<std::string>& head, const std::string& where,
                     Problems& problems) {
  check_bus(model, where, problems);
  return comments(model, head, "// ") +
         sim::grid::unit_dyr(model.plant, model.bus, model.id, where, problems);
}

std::string dyd_text(const PlantModel& model, const std::vector<std::string>& head,
                     const sim::formats::DydPlace& place, const std::string& where, Problems& problems) {
  check_bus(model, where, problems);
  if (!(place.kv > 0))
    problems.add("no nominal voltage", where, "a .dyd record contains the nominal voltage of the unit's bus",
                 "write base_kv under [record], or give --kv");
  return comments(model, head, "# ") +
         sim::grid::unit_dyd(model.plant, model.bus, model.id, place, where, problems);
}

WrittenRecords write_records_beside(const std::filesystem::path& plant_file, const PlantModel& before,
                                    const PlantModel& model, RecordFormat format) {
  const auto changed = changed_blocks(before, model);
  const std::vector<std::string> head = {
      model.name, changed.empty() ? "no parameter is changed"
                                  : fmt::format("changed or new: {}", fmt::join(changed, ", "))};
  Problems problems;
  const std::string where = plant_file.filename().string(),
                    ending = format == RecordFormat::dyd ? ".dyd" : ".dyr";
  const std::string text = format == RecordFormat::dyd
                               ? dyd_text(model, head, {"", model.record_base.kv}, where, problems)
                               : dyr_text(model, head, where, problems);
  if (!problems.empty()) return {"no " + ending + " was written: " + problems.list()[0].sentence(), {}};
  auto file = plant_file;
  file.replace_extension(ending);
  write_file(file, text);
  return {"records: " + file.string(), file};
}

}  // namespace swingbank::validate::plant
