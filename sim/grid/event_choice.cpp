#include "sim/grid/event_choice.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "sim/formats/event_text.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/fault_sequence.hpp"
#include "sim/plant/equations.hpp"

namespace swingbank::sim::grid {
namespace {

/// Returns the machines with their step-up transformers as sequence sources, with their positive-sequence
/// admittances.
std::vector<network::SequenceSource> sequence_sources(const Grid& grid) {
  std::vector<network::SequenceSource> list;
  for (const plant::Plant& plant : grid.plants) {
    const plant::Operating at =
        plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                               grid.network.base_mva, grid.conventions);
    const double* joint = at.c.data() + plant.machine.effect->coefficients;
    const Complex own = 1.0 / Complex(joint[plant::joint_r], joint[plant::joint_x]);
    list.push_back({plant.bus, plant.generator, own * plant.mva / grid.network.base_mva});
  }
  return list;
}

void choose_fault_type(const EventTexts& texts, const Grid& grid, const EventPlace& place,
                       network::Event& event, Problems& problems) {
  const auto type = network::fault_type(texts.fault_type);
  if (!type)
    problems.add("unknown fault type '" + texts.fault_type + "'", place(EventPart::fault_type, ""),
                 "it must be 3ph, slg, ll or llg", "write one of these");
  std::optional<Complex> z0;
  if (!texts.z0.empty()) z0 = formats::read_impedance(texts.z0, place(EventPart::z0, ""), problems);
  if (problems.empty())
    network::make_unbalanced(event, *type, z0, grid.network, grid.flow, sequence_sources(grid), problems);
}

/// Adds a problem for a reference step that no control follows, which would otherwise be ignored silently.
void check_followers(const Grid& grid, const EventPlace& place, const network::Event& event,
                     Problems& problems) {
  for (const network::SetpointStep& step : event.setpoint_steps) {
    const auto plant = std::ranges::find(grid.plants, step.generator, &plant::Plant::generator);
    if (plant == grid.plants.end()) continue;
    const Effect* source = plant->machine.effect;
    if (source && source->converter && !source->takes_commands) continue;
    const auto require = [&](double size, std::string_view reference, EventPart part, Slot of_machine) {
      const Slot slot = source && source->converter ? Slot::electrical_control : of_machine;
      if (size == 0 ||
          std::ranges::any_of(plant->controls, [&](const plant::Block& b) { return b.effect->slot == slot; }))
        return;
      problems.add(fmt::format("step of {} without effect at plant {}", reference, plant->name),
                   place(part, ""), fmt::format("the plant has no {}", slot_name(slot)),
                   "choose a plant with one, or add one to the .dyr");
    };
    require(step.dVref, "Vref", EventPart::vref_step, Slot::exciter);
    require(step.dPref, "Pref", EventPart::pref_step, Slot::governor);
  }
}

}  // namespace

network::Event read_event(const EventTexts& texts, const Grid& grid, double t_end, const EventPlace& place,
                          Problems& problems) {
  const network::Network& n = grid.network;
  network::Event event;
  for (const auto& text : texts.faults)
    event.faults.push_back(formats::read_fault(text, n, t_end, place(EventPart::fault, text), problems));
  for (const auto& text : texts.trips)
    for (const auto& trip : formats::read_line_trip(text, n, t_end, place(EventPart::trip, text), problems))
      event.trips.push_back(trip);
  for (const auto& text : texts.generator_trips)
    event.generator_trips.push_back(
        formats::read_generator_trip(text, n, t_end, place(EventPart::generator_trip, text), problems));
  for (const auto& text : texts.load_steps)
    event.load_steps.push_back(
        formats::read_load_step(text, n, t_end, place(EventPart::load_step, text), problems));
  for (const auto& text : texts.vref_steps)
    event.setpoint_steps.push_back(
        formats::read_setpoint_step(text, n, t_end, true, place(EventPart::vref_step, text), problems));
  for (const auto& text : texts.pref_steps)
    event.setpoint_steps.push_back(
        formats::read_setpoint_step(text, n, t_end, false, place(EventPart::pref_step, text), problems));
  choose_fault_type(texts, grid, place, event, problems);
  check_followers(grid, place, event, problems);
  return event;
}

void note_shed_loads(Grid& grid, const network::Event& event) {
  network::Network& n = grid.network;
  network::Remark remark{"buses that the event separates from every generator lose their voltage and loads",
                         {}};
  std::vector<int> before;
  for (const network::Segment& segment : network::segments(event, n)) {
    const std::vector<int> dead = network::dead_buses(n, segment.topology);
    for (const int bus : dead) {
      if (std::ranges::binary_search(before, bus) || n.buses[static_cast<std::size_t>(bus)].is_star())
        continue;
      Complex power{};
      for (const network::Load& l : n.loads)
        if (l.bus == bus) power += network::consumption(l, grid.flow) * n.base_mva;
      remark.places.push_back(fmt::format("{} at {:g} s: {:.2f} MW, {:.2f} Mvar", n.bus_text(bus),
                                          segment.start, power.real(), power.imag()));
    }
    before = dead;
  }
  if (remark.places.empty()) return;
  constexpr std::size_t places = 4;  // number of places shown, as in load_grid()
  spdlog::warn("{}", remark_line(remark, places));
  n.remarks.push_back(std::move(remark));
}

}  // namespace swingbank::sim::grid
