#include "validate/benchmark/test_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "validate/plant/unknown_keys.hpp"

namespace swingbank::validate::benchmark {
namespace {

namespace fs = std::filesystem;

struct KindRecord {
  std::string_view name, unit;
  double most;   ///< largest |size| [unit]
  int sign;      ///< required sign of the size; 0: either
  bool has_end;  ///< whether the key `end` is required
};
constexpr std::array<KindRecord, 10> kKinds = {{{"voltage_dip", "pu", 1, -1, true},
                                                {"voltage_swell", "pu", 1, 1, true},
                                                {"voltage_step", "pu", 1, 0, false},
                                                {"frequency_step", "Hz", 10, 0, false},
                                                {"frequency_ramp", "Hz/s", 10, 0, true},
                                                {"phase_step", "deg", 180, 0, false},
                                                {"scr_step", "-", 1000, -1, false},
                                                {"v_reference_step", "pu", 1, 0, false},
                                                {"q_reference_step", "pu", 2, 0, false},
                                                {"p_reference_step", "pu", 2, 0, false}}};
const KindRecord& record_of(TestKind kind) { return kKinds.at(static_cast<std::size_t>(kind)); }

constexpr std::array<std::string_view, 11> kKeys = {"name", "kind",     "record", "event",  "end", "size",
                                                    "scr",  "x_over_r", "pre",    "during", "post"};
constexpr double kLatest = 1e5;         ///< largest absolute time [s]
constexpr double kMostGenerated = 1e6;  ///< largest number of samples of a generated input

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
}

std::optional<Interval> window(Config& c, const std::string& key) {
  if (!c.has(key)) return std::nullopt;
  return c.interval(key, {-kLatest, kLatest, "s", "window of the errors, [from, to] in the record's time"});
}

void check_size(Config& c, const std::string& at, const Test& t) {
  const KindRecord& kind = record_of(t.kind);
  if (t.size == 0.0)
    c.problem(at + "size", "size = 0", "the test has no disturbance",
              fmt::format("give the change [{}]", kind.unit));
  if (t.size && *t.size * kind.sign < 0)
    c.problem(at + "size", fmt::format("size = {:g} {}", *t.size, kind.unit),
              t.kind == TestKind::scr_step ? "the short-circuit ratio falls when a line opens"
              : kind.sign < 0              ? "the voltage falls in a dip"
                                           : "the voltage rises in a swell",
              fmt::format("give the change with its sign, such as {:g}", -*t.size));
  if (!t.size && is_reference_step(t.kind))
    c.problem(at + "size", "no size", "a record does not contain the size of a reference step",
              fmt::format("add size = … [{}]", kind.unit));
}

void check_times(Config& c, const std::string& at, const Test& t) {
  if (t.end && !(*t.end > t.event))
    c.problem(at + "end", fmt::format("end = {:g} s with event = {:g} s", *t.end, t.event),
              "the end must be after the event", "give end > event, or omit it for a permanent change");
  if (!t.end && record_of(t.kind).has_end)
    c.problem(at + "end", "no end", fmt::format("a {} has an end", kind_name(t.kind)), "add end = … [s]");
  if (t.during && !t.end)
    c.problem(at + "during", "window 'during' without 'end'", "the window lies between event and end",
              "add end = … [s], or leave out the window");
  const auto outside = [&](const char* key, const std::optional<Interval>& w, double from, double to) {
    if (w && (w->first < from || w->second > to || !(w->second > w->first)))
      c.problem(
          at + key, fmt::format("{} = [{:g}, {:g}] s", key, w->first, w->second),
          fmt::format("the event begins at {:g} s and ends at {:g} s", t.event, t.last()),
          "end `pre` before the event, put `during` inside it, begin `post` after it: [from, to] in s of "
          "the record");
  };
  outside("pre", t.pre, -kLatest, t.event);
  outside("during", t.during, t.event, t.last());
  outside("post", t.post, t.last(), kLatest);
}

/// Reads the grid of a test, and checks it against its kind.
void read_grid(Config& c, const std::string& at, Test& t) {
  const char *const ratio = "scr", *const angle = "x_over_r";
  const bool step = t.kind == TestKind::scr_step;
  if (!step && !c.has(at + ratio) && !c.has(at + angle)) return;
  if (!step && t.kind != TestKind::voltage_dip && !is_reference_step(t.kind))
    c.problem(at + ratio, fmt::format("short-circuit ratio of a {}", kind_name(t.kind)),
              "behind the impedance of a grid only voltage_dip, scr_step and reference steps are defined",
              "leave out scr and x_over_r: the disturbance is then that of an ideal source at the terminal");
  WeakGrid grid;
  grid.scr = c.require<double>(
      at + ratio, {0.1, 1000, "-", "short-circuit power of the grid before the event, over the plant's MVA"});
  grid.x_over_r = c.require<double>(at + angle, {0.1, 1000, "-", "X/R of the grid's impedance"});
  if (step && t.size && grid.scr > 0 && !(grid.scr + *t.size > 0))
    c.problem(at + "size", fmt::format("size = {:g} with scr = {:g}", *t.size, grid.scr),
              "scr + size is the short-circuit ratio after the event, which must be above 0",
              "give a smaller step");
  t.grid = grid;
}

Test read_test(Config& c, int index) {
  const std::string at = fmt::format("test[{}].", index);
  Test t;
  t.where = c.where(fmt::format("test[{}]", index));
  t.name = c.require<std::string>(at + "name", {.meaning = "letters, digits, - and _"});
  if (c.has(at + "name") && !is_name(t.name))
    c.problem(at + "name", "name '" + t.name + "'", "records and curves are named after it",
              "use letters, digits, - and _ only");
  std::vector<std::string> names;
  for (const KindRecord& k : kKinds) names.emplace_back(k.name);
  const std::string kind = c.choice(at + "kind", names, Range{.meaning = "disturbance of the test"});
  const auto found = std::ranges::find(names, kind);
  if (found == names.end()) return t;
  t.kind = static_cast<TestKind>(found - names.begin());
  const KindRecord& of = record_of(t.kind);
  t.event = c.require<double>(at + "event", {-kLatest, kLatest, "s", "beginning of the disturbance"});
  if (c.has(at + "end"))
    t.end = c.require<double>(at + "end", {-kLatest, kLatest, "s", "end of the disturbance"});
  if (c.has(at + "size"))
    t.size =
        c.require<double>(at + "size", {-of.most, of.most, std::string(of.unit), "change, with its sign"});
  t.pre = window(c, at + "pre");
  t.during = window(c, at + "during");
  t.post = window(c, at + "post");
  t.record = c.optional<std::string>(
      at + "record", "",
      {.meaning =
           "file of --records, or path relative to the folder of this file (default: the test's name)"});
  plant::refuse_unknown_keys(c, fmt::format("test[{}]", index), "[[test]]", {kKeys.begin(), kKeys.end()});
  check_times(c, at, t);
  check_size(c, at, t);
  read_grid(c, at, t);
  return t;
}

TestSet read_set(Config& c) {
  TestSet set;
  set.file = c.name();
  set.name = c.require<std::string>("name", {.meaning = "name of the set"});
  set.source = c.optional<std::string>("source", "", {.meaning = "origin of the tests"});
  if (c.has("operating_point")) {
    InitialPoint p;
    p.P = c.require<double>("operating_point.P", {-2, 2, "pu of MVA", "active power out of the plant"});
    p.Q = c.require<double>("operating_point.Q", {-2, 2, "pu of MVA", "reactive power out of the plant"});
    p.V = c.require<double>("operating_point.V", {0.1, 2, "pu", "voltage"});
    p.rate = c.require<double>("operating_point.rate",
                               {.low = 30, .unit = "1/s", .meaning = "sampling rate of a generated input"});
    set.initial = p;
  }
  if (c.has("test")) c.ignore("test");  // its keys are checked in read_test
  if (c.has("test") && !c.is_array("test"))
    c.problem("test", "[test] is a single table", "tests are a list of tables", "write [[test]]");
  std::set<std::string> names;
  for (int k = 0; c.is_array("test") && c.has(fmt::format("test[{}]", k)); ++k) {
    set.tests.push_back(read_test(c, k));
    if (!names.insert(set.tests.back().name).second)
      c.problem(fmt::format("test[{}].name", k), "two tests named '" + set.tests.back().name + "'",
                "names of tests must be unique", "give each test its own name");
  }
  if (set.tests.empty())
    c.problem("test", "no test", "a benchmark needs at least one [[test]]",
              "see configs/benchmark/README.md");
  c.raise();
  return set;
}

/// Returns the file of `given` with this name, else the file with this name without its extension; empty if
/// there is none.
std::string given_file(const std::vector<std::string>& given, const std::string& name) {
  for (const std::string& file : given)
    if (const record::Source source(file); source.is_named(name)) return file;
  for (const std::string& file : given)
    if (const auto first = record::Source(file).files.front();
        (first.config.empty() ? first.path : first.config).stem() == name)
      return file;
  return "";
}

/// Adds a problem if the input of the test, generated from t = 0 at `rate` [1/s], has too few samples before
/// or during the event.
void check_generated_times(const Test& t, double rate, Problems& problems) {
  constexpr double kMinSamplesBefore = 5, kMinSamplesDuring = 2;
  if (const double before = kMinSamplesBefore / rate; !(t.event >= before))
    problems.add(
        fmt::format("event = {:g} s of test '{}'", t.event, t.name), t.where,
        fmt::format("its input is generated from 0 s on, and the operating point is the mean of at least "
                    "{:g} samples before the event",
                    kMinSamplesBefore),
        fmt::format("let the event begin at {:.3g} s or later", before));
  if (t.end && !(*t.end - t.event >= kMinSamplesDuring / rate))
    problems.add(fmt::format("event of {:g} s in test '{}'", *t.end - t.event, t.name), t.where,
                 fmt::format("at {:g} samples per second it contains fewer than {:g} samples", rate,
                             kMinSamplesDuring),
                 "raise rate in [operating_point], or end the event later");
}

/// Returns whether the plant control regulates Q (RefFlag = 0); empty if the plant has no plant control.
std::optional<bool> regulates_q(const sim::plant::Plant& plant) {
  for (const auto& block : plant.controls) {
    if (block.effect->slot != sim::Slot::plant_control) continue;
    const int flag = block.effect->parameter_index("RefFlag");
    return flag >= 0 && block.p[static_cast<std::size_t>(flag)] == 0;
  }
  return std::nullopt;
}

}  // namespace

std::string_view kind_name(TestKind kind) { return record_of(kind).name; }
std::string_view size_unit(TestKind kind) { return record_of(kind).unit; }
bool is_reference_step(TestKind kind) { return kind >= TestKind::v_reference_step; }

TestSet load_tests(const fs::path& file) {
  Config c(file);
  return read_set(c);
}

std::string tests_schema() {
  return describe_keys("Tests of a benchmark of Swingbank", [](Config& c) { read_set(c); });
}

TestSet parse_tests(const std::string& text, const fs::path& name) {
  Config c{text, name};
  return read_set(c);
}

void find_records(TestSet& set, const std::vector<std::string>& given, bool generate, Problems& problems) {
  std::set<std::string> used;
  for (Test& t : set.tests) {
    const std::string named = t.record.string(), file = given_file(given, named.empty() ? t.name : named);
    if (!file.empty()) {
      used.insert(file);
      t.record = file;
    } else if (!named.empty()) {
      t.record = set.file.parent_path() / named;
    } else if (!generate) {
      problems.add(
          fmt::format("no record for test '{}'", t.name), t.where, "none of --records has the test's name",
          fmt::format("give {0}.csv (or {0}.inf) as --records, add record = \"FILE\", or simulate the "
                      "reference: --against MODEL",
                      t.name));
    } else if (!set.initial) {
      problems.add(fmt::format("no operating point for test '{}'", t.name), t.where,
                   "the test has no record, so its input is generated",
                   "add [operating_point] with P, Q, V and rate, or a record");
    } else if (!t.size || !t.post) {
      problems.add(fmt::format("no {} of test '{}'", t.size ? "window post" : "size", t.name), t.where,
                   "the test has no record, so its input is generated",
                   t.size ? "add post = [from, to] in s: the input ends with it"
                          : fmt::format("add size = … [{}]", size_unit(t.kind)));
    } else if (const double samples = t.post->second * set.initial->rate; !(samples <= kMostGenerated)) {
      problems.add(
          fmt::format("{:.3g} samples of test '{}'", samples, t.name), t.where,
          fmt::format("its input is generated from 0 s to the end of post, with {:g} samples per second "
                      "and at most {:g} samples",
                      set.initial->rate, kMostGenerated),
          "lower rate in [operating_point], or end the window post earlier");
    } else {
      check_generated_times(t, set.initial->rate, problems);
    }
  }
  for (const std::string& file : given)
    if (!used.contains(file))
      problems.add("record " + file, "--records", "no test of the tests file has the name of this record",
                   "name it after a test, or add a test with record = \"" +
                       fs::path(file).filename().string() + "\" to " + set.file.string());
}

void check_controls(const TestSet& set, const plant::PlantModel& model, Problems& problems) {
  const auto has = [&](sim::Slot slot) {
    return std::ranges::any_of(model.plant.controls, [&](const auto& b) { return b.effect->slot == slot; });
  };
  const auto q = regulates_q(model.plant);
  for (const Test& t : set.tests) {
    const bool acts = t.kind == TestKind::q_reference_step   ? q == true
                      : t.kind == TestKind::v_reference_step ? q == false || has(sim::Slot::exciter)
                      : t.kind == TestKind::p_reference_step ? q.has_value() || has(sim::Slot::governor)
                                                             : true;
    if (!acts)
      problems.add(fmt::format("no control for test '{}' in the model {}", t.name, model.name), t.where,
                   fmt::format("{} has no control with that reference", model.origin),
                   "leave out the test, or add the control to the plant file");
  }
}

}  // namespace swingbank::validate::benchmark
