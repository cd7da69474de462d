#pragma once
// Benchmark of an RMS model against EMT records, or against another model, over a set of tests.
#include <string>
#include <vector>

#include "validate/benchmark/test_set.hpp"
#include "validate/compare/fitness.hpp"

namespace swingbank::validate::benchmark {

/// Result of one test.
struct TestResult {
  Test test;                                ///< the test
  compare::EventComparison event;           ///< reference ("measured") and model in the test's windows
  std::vector<compare::JudgedErrors> rows;  ///< errors per channel and window; only P and Q have limits
  compare::Fitness fitness;                 ///< verdict on P and Q against the limits
  std::string failure;                      ///< reason of a failed simulation; empty if it succeeded
  /// Whether the model passes.
  [[nodiscard]] bool passes() const { return failure.empty() && fitness.not_judged.empty() && fitness.fit; }
};

/// Inputs of a benchmark.
struct BenchmarkInputs {
  const plant::PlantModel& model;              ///< model under test
  const plant::PlantModel* against = nullptr;  ///< reference model; null: the records are the reference
  /// Record of each test, read from a file or from generated_input(); not used in tests behind a grid
  /// impedance.
  const std::vector<record::Record>& records;
  std::optional<InitialPoint> initial = {};  ///< operating point of tests behind an impedance
  thresholds::Acceptance by;                 ///< limits
  event::Progress progress = {};             ///< called after each test
};

/// Returns whether the channel has limits.
inline bool has_limits(const std::string& channel) { return channel == "P" || channel == "Q"; }
/// Returns the name of a window: "pre", "during" or "post".
std::string_view window_name(thresholds::Phase phase);

/// Plays voltage and angle of each test's record into the model, and applies reference steps to its controls.
/// Computes the errors of the response in the windows pre, during and post. The times of the event are known
/// and exact; the operating point is the mean before the event. If the angle was integrated from a frequency,
/// its phase jumps at the event are fitted to P and Q. In a test behind a grid impedance both models are
/// simulated behind it, and their terminal voltages are compared too. If the simulation of the model or of
/// the reference model fails, the test fails and TestResult::failure contains the reason. Throws InputError
/// if a record does not contain a test's windows.
std::vector<TestResult> run_benchmark(const std::vector<Test>& tests, const BenchmarkInputs& inputs);

/// Whether the model passes all tests.
bool passes(const std::vector<TestResult>& results);

}  // namespace swingbank::validate::benchmark
