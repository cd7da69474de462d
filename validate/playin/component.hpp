#pragma once
// One part of a plant by itself: an exciter with its blocks, a governor, a machine. What the others did is in
// the record, and in their place stands a machine that does what was recorded.
#include <string>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// A machine without equations of its own: current, speed, field current and stabiliser's output are those
/// of the run's record (Given). It has no parameters.
const sim::Effect& recorded_machine();
bool is_recorded(const sim::plant::Plant& plant);

/// Whether an effect of that slot is part of the component.
bool belongs_to(record::Component component, sim::Slot slot);

/// The plant with what is not of the component left out; the machine of an exciter or a governor becomes the
/// recorded one.
sim::plant::Plant component_of(const sim::plant::Plant& plant, record::Component component);
/// The reverse: `whole` with the component's blocks as `part` has them. Blocks that `part` has beside them
/// come along.
sim::plant::Plant put_back(const sim::plant::Plant& whole, const sim::plant::Plant& part,
                           record::Component component);

/// Words of the columns that a record of the component must have, one of each list: what is compared, and
/// what its blocks ask for with the parameters they have.
std::vector<std::vector<std::string>> needed_columns(const sim::plant::PlantUnderTest& component,
                                                     record::Component of);

/// What of the component is compared where the record has it; `measured_states`: speed, Efd and Ifd too,
/// where they do not drive.
std::vector<Output> compared_outputs(const record::Record& record, bool measured_states);

/// The record's values of an output.
const std::vector<double>& measured_values(const record::Record& record, Output output);

}  // namespace swingbank::validate::playin
