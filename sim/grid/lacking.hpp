#pragma once
// Values used for those missing at the end of a .dyr record.

namespace swingbank::sim::grid {

enum class Lacking { refused, zero, standard };

}  // namespace swingbank::sim::grid
