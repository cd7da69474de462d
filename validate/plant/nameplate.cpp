#include "validate/plant/nameplate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <regex>

#include "validate/plant/unknown_keys.hpp"

namespace swingbank::validate::plant {
namespace {

using Field = NameplateField;
using FieldKind = Field::Kind;
using FieldNeed = Field::Need;

constexpr std::array kNameplateFields = {
    Field{"owner", "Owner", "", "owner of the plant", FieldKind::text, FieldNeed::required},
    Field{"plant", "Plant", "", "name of the plant", FieldKind::text, FieldNeed::required},
    Field{"unit", "Unit", "", "name or number of the unit in the plant", FieldKind::text,
          FieldNeed::required},
    Field{"mva", "Rated apparent power", "MVA", "rated apparent power of machine or converter",
          FieldKind::rating, FieldNeed::required},
    Field{"kv", "Rated voltage", "kV", "rated line-to-line voltage at the terminals", FieldKind::rating,
          FieldNeed::required},
    Field{"mw", "Rated active power", "MW", "rated active power of the unit", FieldKind::rating},
    Field{"power_factor", "Rated power factor", "", "rated power factor", FieldKind::rating},
    Field{"commissioned", "Commissioned", "", "date of commissioning", FieldKind::date},
    Field{"recorded", "Date of recording", "", "date of the record; if there are several, of the first",
          FieldKind::date, FieldNeed::required},
    Field{"tested", "Tested", "", "date of the last test of the equipment", FieldKind::date},
};
constexpr std::array kNameplateEquipmentFields = {
    Field{"manufacturer", "manufacturer", "", "manufacturer", FieldKind::text, FieldNeed::required},
    Field{"model", "model", "", "model designation or number", FieldKind::text, FieldNeed::required},
    Field{"serial", "serial number", "", "serial number"},
    Field{"type", "type", "", "type: static, rotating, steam, hydro, grid-following, ...", FieldKind::text,
          FieldNeed::required},
    Field{"mode", "control mode", "", "control mode in operation: voltage, power factor, droop, ...",
          FieldKind::text, FieldNeed::of_controls},
    Field{"firmware", "firmware", "", "version of firmware or settings file"},
};
constexpr std::array kNameplateEquipment = {
    NameplateEquipment{"machine", "Generator"},
    NameplateEquipment{"converter", "Converter"},
    NameplateEquipment{"exciter", "Excitation system"},
    NameplateEquipment{"governor", "Turbine governor"},
    NameplateEquipment{"stabiliser", "Power system stabiliser"},
    NameplateEquipment{"plant_control", "Plant control"},
};

/// A field and its table: [nameplate] (null equipment), or the table of an equipment.
struct PlacedField {
  const Field* field;
  const NameplateEquipment* equipment;
  [[nodiscard]] std::string key() const {
    return equipment ? fmt::format("{}.{}", equipment->section, field->key) : std::string(field->key);
  }
  [[nodiscard]] std::string label() const {
    return equipment ? fmt::format("{}, {}", equipment->label, field->label) : std::string(field->label);
  }
};
std::vector<PlacedField> placed_fields() {
  std::vector<PlacedField> all;
  for (const Field& field : kNameplateFields) all.push_back({&field, nullptr});
  for (const NameplateEquipment& equipment : kNameplateEquipment)
    for (const Field& field : kNameplateEquipmentFields) all.push_back({&field, &equipment});
  return all;
}

/// Returns whether the text is an ISO 8601 date that exists: a year, a month or a day.
bool is_date(const std::string& text) {
  static const std::regex form(R"((\d{4})(?:-(\d{2})(?:-(\d{2}))?)?)");
  std::smatch part;
  if (!std::regex_match(text, part, form)) return false;
  const auto number = [&](std::size_t k) { return part[k].matched ? std::stoi(part[k]) : 1; };
  using namespace std::chrono;
  return (year(number(1)) / month(static_cast<unsigned>(number(2))) / day(static_cast<unsigned>(number(3))))
      .ok();
}

/// Adds a problem for each key of the table that is not in `known`, and one if the value is not a table.
void refuse_unknown(Config& config, const std::string& table, const std::vector<std::string>& known) {
  if (config.has(table) && !config.is_table(table))
    config.problem(table, table + " is not a table", "it contains the fields of the nameplate",
                   "write [" + table + "] on a line of its own, and the fields below it");
  config.ignore(table);  // it may be empty
  refuse_unknown_keys(config, table, "[" + table + "]", known);
}

void read_field(Config& config, const Field& field, const std::string& key, Nameplate& into) {
  const std::string full = "nameplate." + key;
  if (!config.has(full)) return;
  if (field.kind == FieldKind::rating) {
    into.values[key] =
        config.require<double>(full, {1e-9, 1e9, std::string(field.unit), std::string(field.meaning)});
    return;
  }
  const bool date = field.kind == FieldKind::date;
  const Range about{.meaning = std::string(field.meaning) + (date ? " (2026, 2026-03 or 2026-03-01)" : ""),
                    .pattern = date ? R"(^\d{4}(-(0[1-9]|1[0-2])(-(0[1-9]|[12]\d|3[01]))?)?$)" : R"(\S)"};
  if (!config.is_text(full)) {
    config.require<std::string>(full, about);
    return;
  }
  const auto text = config.require<std::string>(full, about);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    config.problem(full, full + " = \"\"", "it is empty",
                   "write the " + std::string(field.meaning) + ", or leave the key out");
  else if (date && !is_date(text))
    config.problem(full, full + " = \"" + text + "\"", "it is not an existing date in ISO 8601 form",
                   "write \"2026-03-01\", \"2026-03\" or \"2026\"");
  else
    into.values[key] = text;
}

/// Returns whether the plant has an effect of this section of the plant file.
bool has_equipment(const sim::plant::Plant& plant, std::string_view section) {
  const auto is = [&](const sim::plant::Block& b) {
    return b.effect != nullptr && sim::kind_name(*b.effect) == section;
  };
  return is(plant.machine) || std::ranges::any_of(plant.controls, is);
}
bool is_source(std::string_view section) { return section == "machine" || section == "converter"; }

}  // namespace

std::span<const NameplateField> nameplate_fields() { return kNameplateFields; }
std::span<const NameplateField> equipment_fields() { return kNameplateEquipmentFields; }
std::span<const NameplateEquipment> nameplate_equipment() { return kNameplateEquipment; }

Nameplate read_nameplate(Config& config) {
  Nameplate nameplate;
  if (!config.has("nameplate")) return nameplate;
  std::vector<std::string> known, of_equipment;
  for (const auto& field : kNameplateFields) known.emplace_back(field.key);
  for (const auto& field : kNameplateEquipmentFields) of_equipment.emplace_back(field.key);
  for (const auto& equipment : kNameplateEquipment) {
    known.emplace_back(equipment.section);
    refuse_unknown(config, fmt::format("nameplate.{}", equipment.section), of_equipment);
  }
  refuse_unknown(config, "nameplate", known);
  for (const PlacedField& at : placed_fields()) read_field(config, *at.field, at.key(), nameplate);
  return nameplate;
}

std::string nameplate_text(const Nameplate& nameplate, std::string (*text)(std::string_view),
                           std::string (*number)(double)) {
  std::string all;
  std::string_view table = "none";
  for (const PlacedField& at : placed_fields()) {
    const auto value = nameplate.values.find(at.key());
    if (value == nameplate.values.end()) continue;
    const std::string_view section = at.equipment ? at.equipment->section : "";
    if (section != table)
      all += section.empty() ? "\n[nameplate]\n" : fmt::format("\n[nameplate.{}]\n", section);
    table = section;
    const auto* words = std::get_if<std::string>(&value->second);
    all += fmt::format("{} = {}{}\n", at.field->key,
                       words ? text(*words) : number(std::get<double>(value->second)),
                       at.field->unit.empty() ? "" : fmt::format("  # [{}]", at.field->unit));
  }
  return all;
}

std::string NameplateLine::text() const {
  if (missing) return "missing";
  if (const auto* words = std::get_if<std::string>(&value)) return *words;
  return fmt::format("{:.10g}{}{}", std::get<double>(value), unit.empty() ? "" : " ", unit);
}

std::vector<NameplateLine> nameplate_lines(const Nameplate& nameplate, const sim::plant::Plant& plant) {
  std::vector<NameplateLine> lines;
  for (const PlacedField& at : placed_fields()) {
    const auto value = nameplate.values.find(at.key());
    const bool given = value != nameplate.values.end();
    const bool needed =
        (at.field->need == FieldNeed::required ||
         (at.field->need == FieldNeed::of_controls && at.equipment && !is_source(at.equipment->section))) &&
        (!at.equipment || has_equipment(plant, at.equipment->section));
    if (!given && !needed) continue;
    lines.push_back({at.key(), at.label(), {}, at.field->unit, at.field->meaning, !given});
    if (given) lines.back().value = value->second;
  }
  return lines;
}

}  // namespace swingbank::validate::plant
