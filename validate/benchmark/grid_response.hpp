#pragma once
// Response of a plant behind the impedance of a grid, for tests of the short-circuit ratio without a record.
#include "validate/benchmark/test_set.hpp"

namespace swingbank::validate::benchmark {

/// Returns V, theta, P and Q at the plant's grid side from t = 0 to the end of the window `post`, simulated
/// by the reference integrator with an infinite bus behind the impedance of `test.grid`. A voltage dip is a
/// fault at the plant's bus, through an impedance with which the voltage without the plant would fall to 1 +
/// `test.size` of its value. A `scr_step` is the opening of one of two parallel lines at `test.event`, which
/// closes again at `test.end`. Reference steps act on the plant's controls. The plant starts at `initial`.
/// Per unit values of the test, and the bases of the result, are those of `tested`, the model under test,
/// whatever the MVA of `simulated`. `test.grid`, `test.size` and `test.post` must be set. Throws InputError
/// if the operating point is infeasible, or if the simulation does not reach its end in synchronism.
record::Record grid_response(const Test& test, const InitialPoint& initial, const plant::PlantModel& tested,
                             const plant::PlantModel& simulated);

}  // namespace swingbank::validate::benchmark
