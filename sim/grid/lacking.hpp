#pragma once
// Replacement of values that are missing at the end of a .dyr record.

namespace swingbank::sim::grid {

/// `refused`: the record is an error; `zero`: zeros; `standard`: the effect's defaults.
enum class Lacking { refused, zero, standard };

}  // namespace swingbank::sim::grid
