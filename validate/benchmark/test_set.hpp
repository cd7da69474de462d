#pragma once
// Tests of a benchmark and their file (TOML): kind, record, time of the event and windows of each test.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/problem.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::benchmark {

/// Disturbance of a test.
enum class TestKind {
  voltage_dip,
  voltage_swell,
  voltage_step,
  frequency_step,
  frequency_ramp,
  phase_step,
  scr_step,
  v_reference_step,
  q_reference_step,
  p_reference_step,
};
std::string_view kind_name(TestKind kind);  ///< "voltage_dip"
std::string_view size_unit(TestKind kind);  ///< unit of Test::size: "pu", "Hz", "Hz/s", "deg", "-"
bool is_reference_step(TestKind kind);      ///< whether a reference of the plant is stepped

/// Time interval [s of the record].
using Interval = std::pair<double, double>;

/// Grid behind which a plant is tested.
struct WeakGrid {
  double scr = 0;       ///< short-circuit ratio: short-circuit power of the grid over the plant's MVA, > 0
  double x_over_r = 0;  ///< X/R of its impedance, > 0
};

/// One test.
struct Test {
  std::string name;                             ///< unique in its set; letters, digits, '-' and '_'
  TestKind kind = TestKind::voltage_dip;        ///< disturbance
  double event = 0;                             ///< beginning of the disturbance [s of the record]
  std::optional<double> end = {};               ///< its end [s]; none: permanent
  std::optional<double> size = {};              ///< change [size_unit()]; powers in pu of the plant's MVA
  std::optional<Interval> pre = {}, post = {};  ///< windows; empty: the record before and after the event
  std::optional<Interval> during = {};          ///< window; empty: from `event` to `end`, if there is an end
  std::optional<WeakGrid> grid = {};            ///< grid before the event; none: ideal source at the terminal
  std::filesystem::path record = {};            ///< file of the record; empty: see find_records()
  std::string where;                            ///< place in the file, "tests.toml:12:1"
  /// Returns whether grid_response() simulates the test; otherwise a voltage is played in.
  [[nodiscard]] bool behind_impedance() const { return grid && record.empty(); }
  /// Returns the end of the disturbance, or its beginning if it is permanent [s].
  [[nodiscard]] double last() const { return end.value_or(event); }
};

/// Operating point of tests without a record, on the plant's MVA.
struct InitialPoint {
  double P = 0, Q = 0, V = 1;  ///< power out of the plant [pu of MVA]; voltage [pu]
  double rate = 0;             ///< sampling rate of the generated input [1/s]
};

/// Tests of one file.
struct TestSet {
  std::filesystem::path file;           ///< tests file
  std::string name, source;             ///< name of the set; origin of the tests
  std::vector<Test> tests;              ///< in the order of the file
  std::optional<InitialPoint> initial;  ///< none: every test needs a record
};

/// Reads a tests file. Throws InputError with all its problems.
TestSet load_tests(const std::filesystem::path& file);
/// Returns the JSON Schema of a tests file (base/describe.hpp).
std::string tests_schema();
/// Parses the text of a tests file; messages show `name` as the file.
TestSet parse_tests(const std::string& text, const std::filesystem::path& name);

/// Sets the record of each test. A test with the key `record` gets the file of `given` with that name, else
/// the path relative to the tests file. A test without the key gets the file of `given` with the test's name.
/// Names match with or without extension. With `generate`, a test without a file needs no record: its input
/// is generated from the operating point, `size` and `post`. Adds a problem for each test without input, and
/// for each file of `given` that no test uses.
void find_records(TestSet& set, const std::vector<std::string>& given, bool generate, Problems& problems);

/// Adds a problem for each test whose reference step acts on no control of the plant.
void check_controls(const TestSet& set, const plant::PlantModel& model, Problems& problems);

}  // namespace swingbank::validate::benchmark
