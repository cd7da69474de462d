#pragma once
// A whole event as a person writes it, part by part: the options of `swingbank simulate`, the keys of a
// system file.
#include <functional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::grid {

/// Texts as sim/formats/event_text.hpp reads them.
struct EventTexts {
  std::vector<std::string> faults, trips, generator_trips, load_steps, vref_steps, pref_steps;
  std::string fault_type = "3ph";  ///< of the one fault, if it is unbalanced: slg, ll, llg
  std::string z0;                  ///< "R:X", zero-sequence impedance of the grid at that fault [pu]
};
/// What each part is called where it is written.
enum class EventPart { fault, trip, generator_trip, load_step, vref_step, pref_step, fault_type, z0 };
/// Names the place of a text in messages: "--fault 5:1:1.1".
using EventPlace = std::function<std::string(EventPart part, const std::string& text)>;

/// Reads every part; what is wrong becomes problems, also a step of a reference that nothing follows, and
/// what lies after `t_end` [s].
network::Event read_event(const EventTexts& texts, const Grid& grid, double t_end, const EventPlace& place,
                          Problems& problems);

/// Notes and warns of the loads at buses that the event cuts off from every generator.
void note_shed_loads(Grid& grid, const network::Event& event);

}  // namespace swingbank::sim::grid
