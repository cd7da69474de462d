// System file: grid, event, and records of several terminals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "base/sha256.hpp"
#include "sim/formats/event_text.hpp"
#include "sim/grid/attach.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/measure.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/check/record_set.hpp"
#include "validate/record/formats.hpp"
#include "validate/system/system.hpp"

namespace swingbank::validate::system {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

std::string sha256_of(const fs::path& file) {
  const std::string bytes = record::read_bytes(file);
  return sha256(bytes);
}

/// Reports the problems of a part at its key.
void report_problems(Config& c, const std::string& key, const Problems& problems) {
  for (const auto& p : problems.list()) c.problem(key, p.what, p.where + ": " + p.why, p.remedy);
}
template <class F>
void attempt(Config& c, const std::string& key, F action) {
  try {
    action();
  } catch (const InputError& error) {
    for (const auto& p : error.problems()) c.problem(key, p.what, p.where + ": " + p.why, p.remedy);
  }
}

constexpr const char* kParts[] = {"fault",     "trip",      "trip_generator", "load_step",
                                  "vref_step", "pref_step", "fault_type",     "z0"};
std::string event_key(sim::grid::EventPart part) {
  return std::string("event.") + kParts[static_cast<int>(part)];
}

sim::grid::EventTexts read_texts(Config& c) {
  const auto list = [&](sim::grid::EventPart part) {
    return c.optional<Texts>(event_key(part), {}, {.meaning = "as the option of swingbank simulate"});
  };
  sim::grid::EventTexts t;
  t.faults = list(sim::grid::EventPart::fault);
  t.trips = list(sim::grid::EventPart::trip);
  t.generator_trips = list(sim::grid::EventPart::generator_trip);
  t.load_steps = list(sim::grid::EventPart::load_step);
  t.vref_steps = list(sim::grid::EventPart::vref_step);
  t.pref_steps = list(sim::grid::EventPart::pref_step);
  t.fault_type = c.choice(event_key(sim::grid::EventPart::fault_type), {"3ph", "slg", "ll", "llg"}, "3ph",
                          {.meaning = "type of the faults"});
  t.z0 = c.optional<std::string>(event_key(sim::grid::EventPart::z0), "",
                                 {.meaning = "zero-sequence impedance, as the option of swingbank simulate"});
  if (t.faults.empty() && t.trips.empty() && t.generator_trips.empty() && t.load_steps.empty() &&
      t.vref_steps.empty() && t.pref_steps.empty())
    c.problem("event", "no event", "the simulation has no disturbance",
              "give fault, trip, trip_generator, load_step, vref_step or pref_step as swingbank simulate "
              "takes them");
  return t;
}

void read_grid(Config& c, SystemCase& s) {
  sim::library::EffectLibrary library;
  for (const auto& name :
       c.optional<Texts>("user_models", {},
                         {.meaning = "files of user-defined models, relative to the folder of this file"}))
    attempt(c, "user_models", [&] {
      const fs::path user_model = (c.name().parent_path() / name).lexically_normal();
      sim::user_models::load_user_model(user_model, library);
      s.user_models.emplace_back(user_model, sha256_of(user_model));
    });
  s.raw = c.file("system.raw",
                 {.meaning = "network (.raw, .rawx, .epc or .m), relative to the folder of this file"});
  s.dyr =
      c.file("system.dyr", {.meaning = "dynamic models (.dyr or .dyd), relative to the folder of this file"});
  const auto conventions =
      c.choice("system.conventions", {"psse", "andes"},
               Range{.meaning = "psse: governors determine mechanical power; andes: torque"}) == "andes"
          ? sim::Conventions::andes()
          : sim::Conventions::psse();
  std::optional<double> hz;
  if (c.has("system.frequency_hz"))
    hz = c.require<double>("system.frequency_hz",
                           {1.0, 1000.0, "Hz", "nominal frequency, for a network in .m or .epc"});
  const sim::formats::DyrOptions models = sim::formats::read_dyr_options(c, "system.");
  const auto attached =
                 c.optional<Texts>("system.attach", {},
                                   {.meaning = "PLANT:EFFECT:PARAM=VALUE,...: effects that the .dyr lacks"}),
             loads = c.optional<Texts>("system.load", {},
                                       {.meaning = "load models, as swingbank simulate --load"});
  const bool composed =
      c.choice("system.loads", {"impedance", "raw"}, "impedance", {.meaning = "model of all loads"}) == "raw";
  if (!c.sound()) return;
  s.raw_sha256 = sha256_of(s.raw);
  s.dyr_sha256 = sha256_of(s.dyr);
  attempt(c, "system.raw", [&] { s.grid = sim::grid::load_grid(s.raw, s.dyr, conventions, models, hz); });
  if (!c.sound()) return;
  s.grid.library = library;
  Problems problems;
  for (const auto& text : attached) sim::grid::attach(s.grid, text, "attach " + text, problems);
  report_problems(c, "system.attach", problems);
  problems = {};
  if (composed) sim::grid::loads_as_composed(s.grid, problems);
  for (const auto& text : loads) sim::grid::choose_load(s.grid, text, "load " + text, problems);
  report_problems(c, "system.load", problems);
}

/// Returns the index of a plant of the grid; -1 and a problem if there is none.
int plant_named(Config& c, const std::string& key, const std::string& name, const sim::grid::Grid& grid) {
  std::string all;
  for (std::size_t i = 0; i < grid.plants.size(); ++i) {
    if (grid.plants[i].name == name) return static_cast<int>(i);
    all += (all.empty() ? "" : ", ") + grid.plants[i].name;
  }
  c.problem(key, "no plant " + name, "the plants are " + all, "name one of these");
  return -1;
}

/// Checks a record of a bus, which has no power.
void check_bus_record(const record::Record& r, Problems& problems) {
  const double level = std::accumulate(r.V.begin(), r.V.end(), 0.0) / static_cast<double>(r.V.size());
  if (level < 0.5 || level > 1.5)
    problems.add(fmt::format("V = {:.4g} pu on average", level), r.name, "bus voltages are near 1 pu",
                 "name the column by its unit (V_kV with record.base_kv), or give per-unit values");
}

/// Returns whether an instrument is deterministic and without gaps, as a simulated response requires.
bool is_repeatable(const sim::plant::Block& instrument, double frequency) {
  constexpr int kSamples = 240;
  sim::Phasors one{60.0, frequency, {}, {}, std::vector<double>(kSamples, 0.0)};
  for (int k = 0; k < kSamples; ++k) {
    one.V.push_back(std::polar(1.0, 1e-3 * k));
    one.I.push_back(std::polar(0.5, 2e-3 * k));
  }
  sim::Phasors other = one;
  instrument.effect->measure(instrument.p.data(), 1, one);
  instrument.effect->measure(instrument.p.data(), 2, other);
  return one.V == other.V && one.I == other.I;  // missing samples are NaN and compare unequal
}

/// Adds the instruments of the plant, then those of the file.
void add_instruments(Config& c, const std::string& key, const Texts& texts, const SystemCase& s,
                     SystemTerminal& t) {
  if (t.plant >= 0) t.instruments = s.grid.plants[static_cast<std::size_t>(t.plant)].measurements;
  Problems problems;
  for (const auto& text : texts)
    if (auto block = sim::plant::read_measurement(text, s.grid.library, "instrument " + text, problems))
      t.instruments.push_back(std::move(*block));
  report_problems(c, key, problems);
  for (const sim::plant::Block& block : t.instruments)
    attempt(c, key, [&] {
      if (!is_repeatable(block, s.base.frequency))
        throw InputError(
            {"an instrument that draws random numbers", std::string(block.effect->name),
             "a simulated response requires a deterministic instrument; noise is estimated from the record",
             "leave it out"});
    });
}

void read_terminal(Config& c, const std::string& name, SystemCase& s) {
  const std::string at = "terminal." + name + ".";
  SystemTerminal t;
  t.name = name;
  const bool is_bus = c.has(at + "bus");
  if (is_bus == c.has(at + "plant"))
    c.problem("terminal." + name, "terminal " + name, "a terminal is either a plant or a bus",
              "give one of the keys plant and bus");
  const auto number =
      c.optional<std::int64_t>(at + "bus", 0, {1, 999999, "", "bus number, in place of a plant"});
  const auto plant = c.optional<std::string>(at + "plant", "", {.meaning = "name of the plant: 2, 30/1"});
  const auto file = c.require<std::string>(
      at + "record", {.meaning = "FILE or FILE#TERMINAL, relative to the folder of this file"});
  const auto instruments =
      c.optional<Texts>(at + "instruments", {}, {.meaning = "instruments of this record"});
  if (!c.sound()) return;
  if (is_bus) {
    Problems problems;
    t.bus = sim::formats::read_bus(std::to_string(number), s.grid.network, "terminal " + name, problems);
    report_problems(c, at + "bus", problems);
  } else {
    t.plant = plant_named(c, at + "plant", plant, s.grid);
    if (t.plant >= 0) t.bus = s.grid.plants[static_cast<std::size_t>(t.plant)].bus;
  }
  add_instruments(c, at + "instruments", instruments, s, t);
  if (t.bus < 0) return;
  attempt(c, at + "record", [&] {
    t.record = record::read_record(c.name().parent_path() / file, s.base, {.power = !is_bus});
    Problems problems;
    t.warnings = t.record.notes;
    if (is_bus) {
      t.record.P.clear();
      t.record.Q.clear();
      check_bus_record(t.record, problems);
    } else {
      const sim::plant::Plant& recorded = s.grid.plants[static_cast<std::size_t>(t.plant)];
      auto findings = check::check_record(
          t.record, {recorded.mva, s.base.frequency, !recorded.machine.effect->converter});
      // A terminal far from the event may hardly respond, which is no error of the record.
      std::erase_if(findings, [](const check::Finding& f) { return f.kind == "no_event"; });
      for (auto& warning : check::warnings_of(findings)) t.warnings.push_back(std::move(warning));
    }
    problems.raise();
    s.terminals.push_back(std::move(t));
  });
}

/// Checks that the records have a common clock, because each record's own start epoch was subtracted.
void check_clocks(Config& c, const SystemCase& s) {
  for (const auto& t : s.terminals)
    if (t.record.start != s.terminals.front().record.start)
      c.problem("terminal." + t.name + ".record", "a record that starts at " + t.record.start,
                "that of " + s.terminals.front().name + " starts at " + s.terminals.front().record.start,
                "export all records from the same time, or with times relative to one time");
  double end = 0;
  for (const auto& t : s.terminals) end = std::max(end, t.record.t.back());
  for (const auto& t : s.terminals)
    if (t.record.t.back() < end - 60 || t.record.t.front() > s.terminals.front().record.t.front() + 60)
      c.problem("terminal." + t.name + ".record",
                fmt::format("times from {:g} to {:g} s", t.record.t.front(), t.record.t.back()),
                "they differ from those of the other terminals by more than 60 s",
                "give all records on one clock");
}

SystemCase read_system(Config& c, SystemCase s) {
  s.name = c.require<std::string>("system.name", {.meaning = "name of the system, printed in reports"});
  s.base.mva =
      c.require<double>("record.base_mva", {1e-9, 1e9, "MVA", "base of P_pu and Q_pu of the records"});
  s.base.kv = c.optional<double>(
      "record.base_kv", 0.0,
      {1e-9, 1e9, "kV", "base of the voltage; needed if a record contains the voltage in kV"});
  s.texts = read_texts(c);
  s.switching_times_from_records =
      c.choice("event.switching_times", {"given", "found"}, "given",
               {.meaning = "switching times: as given, or estimated from the records"}) == "found";
  s.steady_state =
      c.choice("compare.steady_state", {"judge", "shift"}, "judge",
               {.meaning = "treatment of differences before the event: judge or subtract"}) == "shift"
          ? SteadyState::shift
          : SteadyState::judge;
  s.tolerance = c.optional<double>("compare.tolerance", s.tolerance,
                                   {1e-12, 1e-4, "relative", "tolerance of the integrator"});
  const auto reference = c.optional<std::string>(
      "compare.reference", "", {.meaning = "terminal that the angles of the others are relative to"});
  read_grid(c, s);
  if (c.sound()) s.base.frequency = s.grid.network.frequency;
  const auto names = c.keys("terminal");
  if (names.empty())
    c.problem("terminal", "no terminal", "the comparison needs a measurement",
              "give one [terminal.NAME] at least");
  if (!c.sound()) {  // errors of the grid first: references to the grid cannot be checked yet
    c.ignore("terminal");
    c.raise();
  }
  for (const auto& name : names) read_terminal(c, name, s);
  for (std::size_t i = 0; i < s.terminals.size(); ++i)
    if (s.terminals[i].name == reference) s.reference = static_cast<int>(i);
  if (c.sound() && !reference.empty() && s.reference < 0)
    c.problem("compare.reference", "no terminal " + reference, "angles are relative to it",
              "name one of [terminal.NAME]");
  if (s.reference >= 0 &&
      s.terminals[static_cast<std::size_t>(s.reference)].record.angle != record::AngleSource::measured)
    c.problem("compare.reference", "no angle in the record of " + reference, "angles are relative to it",
              "name a terminal that has one, or leave compare.reference out: frequencies are compared then");
  if (c.sound()) {
    check_clocks(c, s);
    double end = s.terminals.front().record.t.back();
    for (const auto& t : s.terminals) end = std::min(end, t.record.t.back());
    Problems problems;
    const auto place = [](sim::grid::EventPart part, const std::string& text) {
      return std::string(kParts[static_cast<int>(part)]) + (text.empty() ? "" : " '" + text + "'");
    };
    s.event = sim::grid::read_event(s.texts, s.grid, end, place, problems);
    for (const auto& p : problems.list()) c.problem("event", p.what, p.where + ": " + p.why, p.remedy);
    if (c.sound()) sim::grid::note_shed_loads(s.grid, s.event);
  }
  c.raise();
  return s;
}

}  // namespace

SystemCase load_system(const fs::path& file) {
  Config c(file);
  SystemCase s;
  s.file = file;
  s.sha256 = sha256_of(file);
  return read_system(c, std::move(s));
}

std::string system_schema() {
  return describe_keys("System file of Swingbank", [](Config& c) { read_system(c, {}); });
}

}  // namespace swingbank::validate::system
