#pragma once
// Which model of a .dyd is which of a .dyr, column by column; the sources stand at each model.
#include <span>
#include <string_view>

namespace swingbank::sim::formats::dyd {

/// What becomes of a column.
enum class Use {
  value,      ///< is a column of the .dyr
  mva_power,  ///< is one, in proportion to the rating of the turbine
  per_mva,    ///< is one, in inverse proportion to it
  again,      ///< repeats the limit of an earlier column, and must not be narrower
  rating,     ///< is the rating itself, which a .dyd gives before the values [MW]
  off,        ///< has no counterpart and must have the value that switches it off
  open,       ///< a limit that has no counterpart and must be too far off to act
  free,       ///< has no counterpart and no influence on the model
  resistance,
  reactance,  ///< of the machine, in the .raw of PSS/E
};

struct Column {
  std::string_view name;  ///< in lower case
  Use use = Use::value;
  int dyr = -1;                ///< column of the .dyr, from 0
  double off = 0;              ///< the value that is written, and with Use::off the only one that is read
  std::string_view idle = {};  ///< with Use::off: any value will do where this column is 0
};

struct Model {
  std::string_view dyd, dyr;
  std::string_view base;  ///< "mva" of a machine, "mwcap" of a turbine, empty: none
  bool named = true;      ///< values are written behind their names
  bool in_order = true;   ///< values without names are read: their order is documented
  int columns = 0;        ///< of the .dyr
  std::span<const Column> in;
  std::span<const Column> fixed = {};  ///< columns of the .dyr that a .dyd has not, with their values
};

std::span<const Model> models();
/// Models that may stand at a unit's bus with its id and are none of its own: meters, loads, relays.
bool is_no_unit(std::string_view dyd);

/// Beyond it a limit does not act [pu].
inline constexpr double kOpen = 99.0;

}  // namespace swingbank::sim::formats::dyd
