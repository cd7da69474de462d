#pragma once
// Rows of one linearised event, and of the prior of its state.
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced::detail {

/// Returns [state | columns] with one row for each value, then one row for the prior of each variable of the
/// event's state: [value, state variable][column]. The last of `columns` [value][column] is the residual. A
/// switching time that would leave its range is fixed at the end of the range.
Eigen::MatrixXd with_state(const event::FitEvent& event, const EventSensitivities& sensitivities,
                           const Eigen::MatrixXd& columns);

}  // namespace swingbank::validate::reduced::detail
