#pragma once
// Nameplate of a plant ([nameplate] in a plant file): owner, unit, ratings, dates and equipment. No other
// module lists its fields.
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/config.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::validate::plant {

/// One field of [nameplate], or of the table of one equipment in it.
struct NameplateField {
  /// Kinds of values.
  enum class Kind {
    text,    ///< free text
    rating,  ///< positive number
    date     ///< ISO 8601: "2026", "2026-03" or "2026-03-01"
  };
  /// Necessity in a verification report.
  enum class Need {
    optional,     ///< not needed
    required,     ///< always needed
    of_controls,  ///< needed for each control that the plant has
  };
  std::string_view key, label, unit, meaning;  ///< key in the file; label on pages; unit; definition
  Kind kind = Kind::text;                      ///< kind of the value
  Need need = Need::optional;                  ///< necessity
};
/// Equipment with a table of its own: [nameplate.exciter] belongs to the plant's section [exciter].
struct NameplateEquipment {
  std::string_view section, label;  ///< section of the plant file; label on pages
};
/// Fields of [nameplate], in the order of pages and files.
std::span<const NameplateField> nameplate_fields();
/// Fields of each equipment's table, in the same order.
std::span<const NameplateField> equipment_fields();
/// Equipment with a table of its own, in the same order.
std::span<const NameplateEquipment> nameplate_equipment();

/// Values of a nameplate by key: "owner", "exciter.model". Texts and dates are text; ratings are numbers in
/// the unit of their field.
struct Nameplate {
  std::map<std::string, std::variant<std::string, double>> values;  ///< given fields only
  /// Compares all values.
  friend bool operator==(const Nameplate&, const Nameplate&) = default;
};

/// Reads [nameplate] of a plant file. Problems are added to the config: unknown keys and equipment, empty
/// texts, dates that are not ISO 8601 or not in the calendar, ratings that are not positive.
Nameplate read_nameplate(Config& config);
/// Returns the nameplate as text of a plant file; empty if no field is given. `text` and `number` format a
/// value as TOML.
std::string nameplate_text(const Nameplate& nameplate, std::string (*text)(std::string_view),
                           std::string (*number)(double));

/// One line of a nameplate for reports.
struct NameplateLine {
  std::string key, label;                   ///< "exciter.model"; "Excitation system, model"
  std::variant<std::string, double> value;  ///< empty text if it is missing
  std::string_view unit, meaning;           ///< unit of a rating; definition of the field
  bool missing = false;                     ///< needed in a verification report and not given
  /// Returns the value with its unit; "missing" if it is missing.
  [[nodiscard]] std::string text() const;
};
/// Returns the given fields, and the missing fields that a verification report of this plant needs. The
/// fields of an equipment are needed if the plant has its section.
std::vector<NameplateLine> nameplate_lines(const Nameplate& nameplate, const sim::plant::Plant& plant);

}  // namespace swingbank::validate::plant
