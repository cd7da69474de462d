#pragma once
// Input of a test without a record: voltage of an ideal source at the plant's terminal.
#include "validate/benchmark/test_set.hpp"

namespace swingbank::validate::benchmark {

/// Returns V and theta of the source from t = 0 to the end of the window `post`, and constant P and Q, those
/// of the operating point. Voltage, frequency or angle change by `test.size` at `test.event`, exactly; a ramp
/// of the frequency ends at `test.end`, and its frequency remains. `model`: bases of the record. Size and
/// window must be given (find_records).
record::Record generated_input(const Test& test, const InitialPoint& initial, const plant::PlantModel& model);

}  // namespace swingbank::validate::benchmark
