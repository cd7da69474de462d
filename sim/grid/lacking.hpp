#pragma once
// What the values are that a record of a .dyr lacks at its end.

namespace swingbank::sim::grid {

enum class Lacking { refused, zero, standard };

}  // namespace swingbank::sim::grid
