// JSON Schema of a row of a record, from the table of column names.
#include <array>
#include <sstream>

#include "base/schema_text.hpp"
#include "validate/record/detail/columns.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {
namespace {

using SchemaJson = nlohmann::ordered_json;

constexpr std::array<std::string_view, kQuantities> kColumnMeanings = {
    "time",
    "terminal voltage, positive sequence",
    "angle of the terminal voltage, in a frame at nominal frequency",
    "frequency",
    "active power out of the machine",
    "reactive power out of the machine",
    "rotor speed: omega is 1 at nominal speed, speed is the deviation from it",
    "field voltage",
    "field current",
    "current out of the machine",
    "angle of the current",
    "stabiliser output (only for the test of one component)",
    "voltage reference (only for the test of one component)",
    "mechanical power (only for the test of one component)",
    "reference of the mechanical power (only for the test of one component)",
    "gate or valve position (only for the test of one component)",
};

/// Returns the columns of a quantity: "V_pu", "V_kV", "V_kV_ln".
std::vector<std::string> columns_of(Quantity q) {
  std::vector<std::string> names;
  std::istringstream list(names_of(q));
  for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
  return names;
}

std::string description_of(Quantity q, const std::string& name) {
  std::string text = std::string(kColumnMeanings.at(static_cast<std::size_t>(q))) + " [" +
                     name.substr(name.find('_') + 1) + "]";
  const auto unit = column_meaning(name)->unit;
  if (needs_kv(q, *unit)) text += "; needs record.base_kv of the plant file";
  if (const auto base = needs_base(q, *unit); !base.empty())
    text += "; needs record." + std::string(base) + " of the plant file";
  return text;
}

/// Returns the condition that the row has a column of the quantity.
SchemaJson has_column(Quantity q) {
  SchemaJson any = SchemaJson::array();
  for (const auto& name : columns_of(q)) any.push_back({{"required", SchemaJson::array({name})}});
  return {{"anyOf", any}};
}

}  // namespace

std::string record_schema() {
  SchemaJson properties = SchemaJson::object();
  for (int k = 0; k < kQuantities; ++k)
    for (const auto& name : columns_of(static_cast<Quantity>(k)))
      properties[name] = {{"type", k == 0 ? SchemaJson("number") : SchemaJson({"number", "null"})},
                          {"description", description_of(static_cast<Quantity>(k), name)}};
  const auto both = [](Quantity a, Quantity b) {
    return SchemaJson{{"allOf", SchemaJson::array({has_column(a), has_column(b)})}};
  };
  const SchemaJson power = {
      {"anyOf", SchemaJson::array({both(Quantity::P, Quantity::Q), both(Quantity::I, Quantity::phi)})}};
  const SchemaJson schema = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Row of a record of Swingbank"},
      {"description",
       "One row of a text file: its values under their column names. null: no value. Columns with other "
       "names are ignored, unless their names are other spellings of these (validate/record/README.md) or "
       "[record.columns] or --columns assigns them."},
      {"type", "object"},
      {"properties", properties},
      {"allOf", SchemaJson::array({has_column(Quantity::time), has_column(Quantity::V), power})}};
  return schema_text(schema);
}

}  // namespace swingbank::validate::record
