#pragma once
// Reader of an event given as text: the options of `swingbank simulate`, or the keys of a system file.
#include <functional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::grid {

/// Texts in the syntax of sim/formats/event_text.hpp.
struct EventTexts {
  std::vector<std::string> faults, trips, generator_trips, load_steps, vref_steps, pref_steps;
  ///< one text for each option
  std::string fault_type = "3ph";  ///< 3ph, or slg, ll, llg for a single unbalanced fault
  std::string z0;                  ///< "R:X", zero-sequence impedance of the grid at that fault [pu]
};
/// Parts of an event, used to name options or keys in messages.
enum class EventPart { fault, trip, generator_trip, load_step, vref_step, pref_step, fault_type, z0 };
/// Returns the place of a text for messages, such as "--fault 5:1:1.1".
using EventPlace = std::function<std::string(EventPart part, const std::string& text)>;

/// Reads every part. Errors become problems. Among them are a reference step that no control follows, and any
/// time after `t_end` [s].
network::Event read_event(const EventTexts& texts, const Grid& grid, double t_end, const EventPlace& place,
                          Problems& problems);

/// Adds a remark and a warning for the loads at buses that the event isolates from every generator.
void note_shed_loads(Grid& grid, const network::Event& event);

}  // namespace swingbank::sim::grid
