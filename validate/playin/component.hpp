#pragma once
// One component of a plant tested alone: an exciter with stabiliser, limiters and compensator, a governor, or
// a machine. The record supplies the outputs of the other components. For an exciter or a governor, a
// recorded machine replaces the modelled one.
#include <string>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Returns a machine without equations and parameters. Its current, speed, field current and stabiliser
/// output are those of the run's record (Given).
const sim::Effect& recorded_machine();
/// Returns whether the plant's machine is recorded_machine().
bool is_recorded(const sim::plant::Plant& plant);

/// Returns whether an effect of that slot is part of the component.
bool belongs_to(record::Component component, sim::Slot slot);

/// Returns the plant reduced to the component; the machine of an exciter or a governor becomes the recorded
/// one.
sim::plant::Plant component_of(const sim::plant::Plant& plant, record::Component component);
/// Returns `whole` with the component's blocks of `part`, the inverse of component_of(). Blocks added to
/// `part` are included.
sim::plant::Plant put_back(const sim::plant::Plant& whole, const sim::plant::Plant& part,
                           record::Component component);

/// Returns the columns that a record of the component must have: its compared outputs, and the inputs on
/// which its blocks depend at their present parameter values. One column of each inner list suffices.
std::vector<std::vector<std::string>> needed_columns(const sim::plant::PlantUnderTest& component,
                                                     record::Component of);

/// Returns the compared outputs of the record's component that the record contains. `measured_states`: also
/// speed, Efd and Ifd, if they are not inputs.
std::vector<Output> compared_outputs(const record::Record& record, bool measured_states);

}  // namespace swingbank::validate::playin
