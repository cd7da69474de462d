#pragma once
// Input of a test without a record: voltage of an ideal source at the plant's terminal.
#include "validate/benchmark/test_set.hpp"

namespace swingbank::validate::benchmark {

/// Returns V and theta of the source from t = 0 to the end of the window `post`, with P and Q constant at the
/// operating point. Voltage, frequency or angle changes by `test.size` exactly at `test.event` and returns at
/// `test.end`. In a frequency ramp, `test.size` is the rate from `test.event` to `test.end`, and the final
/// frequency remains. `model` supplies the bases of the record. `test.size` and `test.post` must be set,
/// which find_records() checks.
record::Record generated_input(const Test& test, const InitialPoint& initial, const plant::PlantModel& model);

}  // namespace swingbank::validate::benchmark
