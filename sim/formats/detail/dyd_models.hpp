#pragma once
// Tables that convert .dyd models to .dyr models column by column, with the source of each model.
#include <span>
#include <string_view>

namespace swingbank::sim::formats::dyd {

/// Conversion of a column.
enum class Use {
  value,       ///< copied to a column of the .dyr
  mva_power,   ///< copied, multiplied by the ratio of the turbine's rating to the machine's base
  per_mva,     ///< copied, divided by this ratio
  again,       ///< repeats the limit of an earlier column; must not be narrower, unless it is 0
  rating,      ///< column of the .dyr for the turbine's rating [MW], which precedes the values in a .dyd
  off,         ///< no counterpart; must have the value that disables it
  open,        ///< a limit without counterpart; must be too wide to act
  free,        ///< no counterpart and no influence on the model
  resistance,  ///< resistance of the machine, which PSS/E keeps in the .raw
  reactance,   ///< reactance of the machine, which PSS/E keeps in the .raw
};

/// A column of a .dyd model.
struct Column {
  std::string_view name;  ///< in lower case
  Use use = Use::value;
  int dyr = -1;                ///< column of the .dyr, from 0
  double off = 0;              ///< value written to a .dyd; with Use::off the only accepted value
  std::string_view idle = {};  ///< with Use::off: any value is accepted if the column named here is 0
};

/// A .dyd model and its counterpart in a .dyr.
struct Model {
  std::string_view dyd, dyr;
  std::string_view base;  ///< keyword of its base: "mva" (machine), "mwcap" (turbine), empty: none
  bool named = true;      ///< values are written with their names
  bool in_order = true;   ///< values without names are accepted, because their order is documented
  int columns = 0;        ///< number of columns of the .dyr
  std::span<const Column> in;
  std::span<const Column> fixed =
      {};  ///< columns of the .dyr without counterpart in the .dyd, with their values
};

/// Returns all models with a counterpart.
std::span<const Model> models();
/// Returns true for models that share a unit's bus and id but do not belong to the unit: meters, loads,
/// relays.
bool is_no_unit(std::string_view dyd);

/// Magnitude beyond which a limit does not act [pu].
inline constexpr double kOpen = 99.0;

}  // namespace swingbank::sim::formats::dyd
