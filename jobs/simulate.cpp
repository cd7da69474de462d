// swingbank simulate: simulates one event and writes every recorded quantity with its unit as CSV, HDF5 or
// both.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "base/constants.hpp"
#include "base/durable.hpp"
#include "base/inputs_kept.hpp"
#include "jobs/command_line.hpp"
#include "jobs/measured_run.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "sim/batch/batch.hpp"
#include "sim/formats/event_text.hpp"
#include "sim/grid/attach.hpp"
#include "sim/grid/case_words.hpp"
#include "sim/grid/event_choice.hpp"
#include "sim/grid/limits.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "sim/reference/reference.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::jobs::simulate_command {
namespace {
using namespace sim;

struct Options {
  std::string raw, dyr, convention = "psse", integrator = "reference";
  grid::EventTexts event;
  std::vector<std::string> loads, user_models, attached;
  std::vector<std::string> out, plants, channels, measured;
  std::uint64_t measure_seed = 1;
  std::string load_model = "impedance";
  std::vector<int> buses;
  double t_end = 15.0, rate = 120.0;
  std::optional<double> tolerance, frequency_hz;
  std::vector<std::string> ignore_models, map_models;
  bool after_switching = false, net_generators = false, widen_limits = false, drop_refused = false;
  int complete_records = 0, devices = 0, repeated = 0;  // each an index of the chosen value of its option
  int raw_version = 0;
  std::string start = "solved", q_limits = "enforce", switched_shunts = "fixed";
  std::filesystem::path changes;
};

/// Returns the option, with its value, that defines a part of an event: "--fault 4:2:2.1".
std::string event_option(grid::EventPart part, const std::string& text) {
  constexpr const char* kOptions[] = {"--fault",     "--trip",      "--trip-generator", "--load-step",
                                      "--vref-step", "--pref-step", "--fault-type",     "--z0"};
  return kOptions[static_cast<int>(part)] + (text.empty() ? "" : " " + text);
}

std::vector<int> parse_plants(const Options& options, const grid::Grid& grid, Problems& problems) {
  std::vector<int> list;
  for (const auto& name : options.plants) {
    const auto at = std::find_if(grid.plants.begin(), grid.plants.end(),
                                 [&](const plant::Plant& p) { return p.name == name; });
    if (at != grid.plants.end()) {
      list.push_back(static_cast<int>(at - grid.plants.begin()));
      continue;
    }
    std::string names;
    for (const auto& p : grid.plants) names += (names.empty() ? "" : ", ") + p.name;
    problems.add("no plant " + name, "--plants", "the plants are " + names, "choose one or more of these");
  }
  if (list.empty())
    for (std::size_t i = 0; i < grid.plants.size(); ++i) list.push_back(static_cast<int>(i));
  return list;
}

std::vector<Channel> parse_channels(const Options& options, Problems& problems) {
  std::vector<Channel> list;
  std::string names;
  for (const auto& record : kChannels) names += (names.empty() ? "" : ", ") + std::string(record.name);
  for (const auto& name : options.channels) {
    if (const auto* record = find_channel(name))
      list.push_back(record->channel);
    else
      problems.add("no channel " + name, "--channels", "the channels are " + names,
                   "choose one or more of these");
  }
  if (list.empty())
    for (const auto& record : kChannels) list.push_back(record.channel);
  return list;
}

void check_options(const Options& options, Problems& problems) {
  const auto positive = [&](double value, const char* name, const char* unit) {
    if (!(value > 0) || !std::isfinite(value))
      problems.add(fmt::format("{} = {} {}", name, value, unit), name, "it must be positive",
                   "give a positive number");
  };
  positive(options.t_end, "--t-end", "s");
  positive(options.rate, "--rate", "1/s");
  if (options.tolerance) positive(*options.tolerance, "--tolerance", "(relative)");
  if (options.tolerance > 0.01)
    problems.add(fmt::format("a tolerance of {:g}", *options.tolerance), "--tolerance",
                 "such errors may change the outcome of the run", "give at most 0.01");
  if (options.t_end * options.rate > 1e8)
    problems.add(fmt::format("{:.3g} samples", options.t_end * options.rate), "--rate",
                 "more than 1e8 samples are not held in memory", "lower --rate or --t-end");
  for (const std::filesystem::path file : options.out)
    if (file.extension() != ".csv" && file.extension() != ".h5")
      problems.add("extension '" + file.extension().string() + "'", "--out " + file.string(),
                   "runs are written as .csv or .h5", "end the name in .csv or .h5");
  if (options.integrator == "batch" && !options.buses.empty())
    problems.add("--buses with --integrator batch", "--buses",
                 "this integrator uses the network reduced to the generator buses",
                 "use --integrator reference");
  if (options.integrator == "batch" && options.after_switching)
    problems.add("--after-switching with --integrator batch", "--after-switching",
                 "this integrator records the value before a switching", "use --integrator reference");
}

double tolerance(const Options& o) { return o.tolerance.value_or(o.integrator == "batch" ? 1e-6 : 1e-8); }

reference::ReferenceRun play(const Options& o, int finer, const grid::Grid& grid, const network::Event& event,
                             std::vector<int> plants, std::vector<Channel> channels, std::vector<int> buses) {
  if (o.integrator == "reference") {
    reference::ReferenceOptions options;
    options.t_end = o.t_end;
    options.rate = o.rate * finer;
    options.rtol = tolerance(o);
    options.atol = tolerance(o) / 100;
    options.plants = std::move(plants);
    options.channels = std::move(channels);
    options.buses = std::move(buses);
    options.after_switching = o.after_switching;
    return reference::run_reference(grid, event, options);
  }
  batch::BatchOptions options;
  options.t_end = o.t_end;
  options.rate = o.rate * finer;
  options.tolerance = tolerance(o);
  options.plants = std::move(plants);
  options.channels = std::move(channels);
  batch::Batch batch(grid, options);
  reference::ReferenceRun run;
  bool given = false;
  batch.run(
      [&](batch::Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const batch::Job&, const Trajectory& t) { static_cast<Trajectory&>(run) = t; });
  return run;
}

/// Appends a comma and a number to a CSV line. A missing sample (NaN) is an empty cell.
void put_cell(std::string& text, double value) {
  text += ',';
  if (!std::isnan(value)) fmt::format_to(std::back_inserter(text), "{:.12g}", value);
}

void write_csv(const std::filesystem::path& file, const grid::Grid& grid, const MeasuredRun& run) {
  std::string text = "t_s";
  for (int plant : run.plants)
    for (Channel c : run.channels) {
      const auto& record = kChannels[static_cast<std::size_t>(c)];
      text += fmt::format(",{}.{}_{}", grid.plants[plant].name, record.name, record.unit);
    }
  for (std::size_t i = 0; i < run.frequency.size(); ++i)
    text += fmt::format(",{}.f_hz", grid.plants[run.plants[i]].name);
  for (int bus : run.buses)
    text += fmt::format(",bus{0}.V_pu,bus{0}.theta_rad", grid.network.buses[bus].number);
  text += '\n';
  for (int k = 0; k < run.samples; ++k) {
    fmt::format_to(std::back_inserter(text), "{:.12g}", k / run.rate);
    for (int i = 0; i < run.rows(); ++i) put_cell(text, run.row(i)[k]);
    for (const auto& f : run.frequency) put_cell(text, f[static_cast<std::size_t>(k)]);
    for (std::size_t b = 0; b < run.buses.size(); ++b)
      fmt::format_to(std::back_inserter(text), ",{:.12g},{:.12g}", run.bus_v[b * run.samples + k],
                     run.bus_theta[b * run.samples + k]);
    text += '\n';
  }
  write_text(file, text);
}

std::string joined(const std::vector<std::string>& list) {
  std::string all;
  for (const auto& s : list) all += (all.empty() ? "" : " ") + s;
  return all;
}

void describe_run(mpi::store::h5::File& h, const Options& o, const grid::Grid& grid,
                  const reference::ReferenceRun& run) {
  h.attribute("format", std::string("swingbank-run-1"));
  h.attribute("network", o.raw);
  h.attribute("dynamics", o.dyr);
  h.attribute("ignored_models", joined(o.ignore_models));
  h.attribute("mapped_models", joined(o.map_models));
  std::vector<std::string> changes;
  for (const network::Remark& remark : grid.network.remarks)
    changes.push_back(grid::remark_line(remark, remark.places.size()));
  h.attribute("changes_to_the_case", changes);
  h.attribute("convention", o.convention);
  h.attribute("integrator", o.integrator);
  h.attribute("tolerance", tolerance(o));
  h.attribute("faults", joined(o.event.faults));
  h.attribute("fault_type", o.event.fault_type);
  h.attribute("zero_sequence_r_x_pu", o.event.z0);
  h.attribute("trips", joined(o.event.trips));
  h.attribute("generator_trips", joined(o.event.generator_trips));
  h.attribute("load_steps", joined(o.event.load_steps));
  h.attribute("vref_steps", joined(o.event.vref_steps));
  h.attribute("pref_steps", joined(o.event.pref_steps));
  h.attribute("loads", grid::describe_loads(grid));
  h.attribute("user_models", joined(o.user_models));
  h.attribute("attached", joined(o.attached));
  h.attribute("measured", joined(o.measured));
  h.attribute("measure_seed", std::to_string(o.measure_seed));
  h.attribute("outcome", std::string(outcome_name(run.outcome)));
  h.attribute("stopped_at_s", run.stopped_at);
  h.attribute("largest_spread_rad", run.largest_spread);
  std::vector<std::string> plants, names, units;
  std::vector<double> bases;
  for (int p : run.plants) {
    plants.push_back(grid.plants[p].name);
    bases.push_back(grid.plants[p].mva);
  }
  for (Channel c : run.channels) {
    names.emplace_back(kChannels[static_cast<std::size_t>(c)].name);
    units.emplace_back(kChannels[static_cast<std::size_t>(c)].unit);
  }
  h.attribute("plant_names", plants);
  h.attribute("plant_base_mva", bases);
  h.attribute("channel_names", names);
  h.attribute("channel_units", units);
  h.create_labels("/plant", plants);
  h.write_labels("/plant", plants);
  h.describe("/plant", "1", "name of the plant");
  h.create_labels("/channel", names);
  h.write_labels("/channel", names);
  h.describe("/channel", "1", "name of the channel");
}

void write_hdf5(const std::filesystem::path& file, const Options& o, const grid::Grid& grid,
                const MeasuredRun& run) {
  const std::lock_guard guard(mpi::store::h5::lock());
  const auto samples = static_cast<hsize_t>(run.samples);
  reserve(file,
          (run.values.size() + run.bus_v.size() * 2 + (run.frequency.size() + 1) * samples) * sizeof(double) +
              65536);
  mpi::store::h5::File h = mpi::store::h5::File::create(temporary_name(file));
  std::vector<mpi::store::h5::File::Axes> axes;
  const auto put = [&](const std::string& name, const mpi::store::h5::Shape& shape,
                       const std::vector<double>& values, const char* units, const char* meaning,
                       const std::vector<std::string>& scales) {
    h.create<double>(name, shape);
    h.write(name, 0, shape[0], values.data());
    h.describe(name, units, meaning);
    if (!scales.empty()) axes.push_back({name, scales});
  };
  std::vector<double> time(run.samples);
  for (int k = 0; k < run.samples; ++k) time[k] = k / run.rate;
  put("/time", {samples}, time, "s", "time since the start of the run", {});
  put("/records", {run.plants.size(), run.channels.size(), samples}, run.packed(), "see channel_units",
      "records at the plants' terminals, per unit on each plant's own base", {"/plant", "/channel", "/time"});
  if (!run.frequency.empty()) {
    std::vector<double> all;
    for (const auto& f : run.frequency) all.insert(all.end(), f.begin(), f.end());
    put("/measured_frequency", {run.frequency.size(), samples}, all, "Hz", "measured frequency",
        {"/plant", "/time"});
  }
  if (!run.buses.empty()) {
    std::vector<std::int32_t> numbers;
    for (int b : run.buses) numbers.push_back(grid.network.buses[b].number);
    h.create<std::int32_t>("/bus_number", {run.buses.size()});
    h.write("/bus_number", 0, run.buses.size(), numbers.data());
    h.describe("/bus_number", "1", "number of the bus");
    put("/bus_voltage", {run.buses.size(), samples}, run.bus_v, "pu", "magnitude of the bus voltage",
        {"/bus_number", "/time"});
    put("/bus_angle", {run.buses.size(), samples}, run.bus_theta, "rad", "angle of the bus voltage",
        {"/bus_number", "/time"});
  }
  describe_run(h, o, grid, run);
  h.attach_scales(axes);
  h.close();
  publish(file);
}

grid::CaseOptions case_options(const Options& o, const formats::DyrOptions& models) {
  grid::CaseOptions all;
  all.dyr = models;
  all.raw = {o.frequency_hz, o.raw_version};
  all.raw.devices = static_cast<network::DeviceReplacement>(o.devices);
  all.complete_records = static_cast<grid::Lacking>(o.complete_records);
  all.drop_refused = all.raw.drop_refused = o.drop_refused;
  all.raw.repeated = static_cast<formats::Repeated>(o.repeated);
  all.net_generators = o.net_generators;
  all.start_from_file = o.start == "file";
  all.flow.reactive_limits = o.q_limits == "enforce";
  all.flow.step_shunts = o.switched_shunts == "step";
  return all;
}

/// Writes all changes that were made to the case: a line for each change, and below it a line for each place.
void write_changes(const std::filesystem::path& file, const network::Network& network) {
  std::string text;
  for (const network::Remark& remark : network.remarks) {
    text += remark.what + fmt::format(" ({})\n", remark.places.size());
    for (const std::string& place : remark.places) text += "  " + place + "\n";
  }
  write_text(file, text);
}

std::vector<Output> outputs_of(const Options& o) {
  std::vector<Output> outputs;
  for (const auto& file : o.out) outputs.push_back({file, "--out"});
  if (!o.changes.empty()) outputs.push_back({o.changes, "--changes"});
  return outputs;
}

int simulate(const Options& o) {
  Problems problems;
  check_options(o, problems);
  formats::DyrOptions models{o.ignore_models, {}};
  for (const auto& text : o.map_models) formats::add_model_map(models, text, "--map-model " + text, problems);
  problems.raise();
  library::EffectLibrary library;
  for (const auto& file : o.user_models) user_models::load_user_model(file, library);
  grid::Grid grid =
      grid::load_grid(o.raw, o.dyr, o.convention == "andes" ? Conventions::andes() : Conventions::psse(),
                      case_options(o, models));
  grid.library = library;
  for (const auto& text : o.attached) grid::attach(grid, text, "--attach " + text, problems);
  if (o.load_model == "raw") grid::loads_as_composed(grid, problems);
  for (const auto& text : o.loads) grid::choose_load(grid, text, "--load " + text, problems);
  grid::settle_limits(grid, o.widen_limits);  // before the events, which may depend on the operating point
  const network::Event event = grid::read_event(o.event, grid, o.t_end, event_option, problems);
  const auto plants = parse_plants(o, grid, problems);
  const auto channels = parse_channels(o, problems);
  const Instruments instruments(o.measured, library, o.measure_seed, problems);
  std::vector<int> buses;
  for (int b : o.buses)
    buses.push_back(formats::read_bus(std::to_string(b), grid.network, "--buses", problems));
  problems.raise();
  require_inputs_kept(outputs_of(o));
  grid::note_shed_loads(grid, event);
  if (!o.changes.empty()) write_changes(o.changes, grid.network);

  const auto begin = std::chrono::steady_clock::now();
  const auto played = [&](int finer, const std::vector<Channel>& wanted) {
    return play(o, finer, grid, event, plants, wanted, buses);
  };
  const MeasuredRun run = instruments.run(grid, plants, channels, played);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (run.outcome != Outcome::stable && run.outcome != Outcome::lost_synchronism)
    throw InputError(
        {fmt::format("the run failed at {:g} s", run.stopped_at), o.raw + " and " + o.dyr,
         fmt::format("{}: {}", outcome_name(run.outcome),
                     run.outcome == Outcome::not_finite
                         ? "a value became infinite or undefined"
                         : "the integrator could not meet its tolerance at any step size"),
         "nothing was written; check the impedances and time constants that act at this time, or "
         "give another --tolerance"});
  for (const std::filesystem::path file : o.out) {
    if (file.extension() == ".csv")
      write_csv(file, grid, run);
    else
      write_hdf5(file, o, grid, run);
    fmt::print("wrote {}\n", file.string());
  }
  fmt::print("loads: {}\n", grid::describe_loads(grid));
  fmt::print("{} at {:g} s{}, maximum change of rotor-angle differences {:.3f} deg, {}{:.3f} s wall time\n",
             outcome_name(run.outcome), run.stopped_at, run.lost_by.empty() ? "" : " (" + run.lost_by + ")",
             run.largest_spread * constants::degrees_in_radian,
             run.steps > 0 ? fmt::format("{} steps, ", run.steps) : "", wall);
  return 0;
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  Options o;
  line.group("Input");
  line.add("--raw,--epc", o.raw,
           "network, format by file extension: PSS/E .raw or .rawx, PSLF .epc, MATPOWER .m")
      .required();
  line.add("--dyr,--dyd", o.dyr, "dynamic models, format by file extension: PSS/E .dyr, PSLF .dyd")
      .required();
  line.add("--frequency-hz", o.frequency_hz, "nominal frequency [Hz] of a network file without one");
  line.add("--raw-version", o.raw_version, "version of a .raw file without a version number, 23 to 35");
  line.add("--user-model", o.user_models,
           "file (.toml) of a user-defined model that --attach may use; may be repeated");
  line.add("--convention", o.convention,
           "psse: governors determine mechanical power; andes: torque; both neglect the speed term "
           "(omega = 1 pu) in the stator voltage equations (configs/README.md)")
      .one_of({"psse", "andes"})
      .shows_default();
  line.group("Power flow");
  line.add_flag("--net-generators", o.net_generators,
                "generators in service without a machine model become negative loads, as PSS/E's GNET does");
  line.add("--start", o.start,
           "solved: start from the solution of the power flow; file: start from the voltages of the file")
      .one_of({"solved", "file"})
      .shows_default();
  line.add("--q-limits", o.q_limits, "reactive limits of generators in the power flow")
      .one_of({"enforce", "ignore"})
      .shows_default();
  line.add(
          "--switched-shunts", o.switched_shunts,
          "fixed: switched shunts stay at BINIT; step: discrete ones regulate their voltage in the power flow")
      .one_of({"fixed", "step"})
      .shows_default();
  line.add_choice("--devices", o.devices, grid::kDeviceWords,
                  "power of dc lines, FACTS and GNE devices and induction machines: from the file's "
                  "voltages, if these are a solution (checked) or always (file), or zero (none)");
  line.add("--loads", o.load_model,
           "impedance: every load at constant impedance; raw: ZIP components of the .raw (constant power, "
           "current and admittance); loads with a model in the .dyr keep it")
      .one_of({"impedance", "raw"})
      .shows_default();
  line.add("--load", o.loads, "BUS[/ID]:EFFECT[:PARAM=VALUE,...], a model for one load; may be repeated");
  line.add_flag("--widen-limits", o.widen_limits,
                "extend control limits that exclude the operating point to this point, and report them");
  line.group("Models");
  line.add_choice(
      "--complete-records", o.complete_records, grid::kLackingWords,
      "records of the .dyr that are shorter than their model are completed with these values, longer ones "
      "are truncated; each change is listed in a warning");
  line.add_flag("--drop-refused", o.drop_refused,
                "ignore records of the .dyr with inadmissible parameter values, and network equipment with a "
                "repeated id or at a missing bus; each is listed in a warning");
  line.add_choice(
      "--repeated", o.repeated, grid::kRepeatedWords,
      "network equipment with a repeated id: refuse it, keep it under a new id (keep), or keep it under a "
      "new id unless this worsens the power balance at the file's voltages (voltages)");
  line.add("--ignore-model", o.ignore_models,
           "names of .dyr models to ignore, comma-separated; may be repeated")
      .comma_separated();
  line.add("--map-model", o.map_models,
           "FROM=TO,...: read a .dyr model as another with as many parameters; may be repeated")
      .comma_separated();
  line.add("--attach", o.attached,
           "PLANT:EFFECT[:PARAM=VALUE,...]: an effect added to a plant (or to all); may be repeated");
  line.group("Events");
  line.add("--fault", o.event.faults,
           "BUS:T_ON:T_OFF[:R:X], bolted without R and X [s, pu on the network's base]; may be repeated");
  line.add("--fault-type", o.event.fault_type,
           "3ph; slg: line to ground; ll: line to line; llg: double line to ground. With slg, ll and llg, R "
           "and X are the fault impedance; the negative- and zero-sequence equivalents are added")
      .one_of({"3ph", "slg", "ll", "llg"})
      .shows_default();
  line.add("--z0", o.event.z0,
           "R:X, zero-sequence impedance of the grid at the fault [pu on the network's base]; needed "
           "by slg and llg");
  line.add("--trip", o.event.trips,
           "FROM:TO:CKT:T_OPEN[:T_CLOSE] [s]; of a three-winding transformer this opens the winding at FROM, "
           "FROM:TO:THIRD:CKT:T_OPEN[:T_CLOSE] all windings; may be repeated");
  line.add("--trip-generator", o.event.generator_trips,
           "BUS[/ID]:T[:PART], trips the generator permanently at T [s]; PART: fraction of its units "
           "(default 1: all); may be repeated");
  line.add("--load-step", o.event.load_steps,
           "BUS:P:Q:T_ON[:T_OFF] [MW, Mvar, s], consumption added as constant admittance; may be "
           "repeated");
  line.add("--vref-step", o.event.vref_steps, "BUS[/ID]:T:STEP [s, pu]; may be repeated");
  line.add("--pref-step", o.event.pref_steps, "BUS[/ID]:T:STEP [s, pu]; may be repeated");
  line.group("Measurements");
  line.add("--measure", o.measured,
           "EFFECT[:PARAM=VALUE,...]: an instrument between every recorded plant and the record; may be "
           "repeated, and is then applied in the given order");
  line.add("--measure-seed", o.measure_seed, "seed of the instruments' noise and gaps").shows_default();
  line.add("--plants", o.plants, "plants to record, comma-separated (default: all)").comma_separated();
  line.add("--channels", o.channels, "channels to record, comma-separated (default: all)").comma_separated();
  line.add("--buses", o.buses, "numbers of buses whose voltages are also recorded, comma-separated")
      .comma_separated();
  line.add_flag("--after-switching", o.after_switching,
                "a sample at a switching time has the value just after it");
  line.group("Output");
  line.add("--out", o.out, "file to write, .csv or .h5; may be repeated").required();
  line.add("--t-end", o.t_end, "end of the run [s]").shows_default();
  line.add("--rate", o.rate, "samples per second [1/s]").shows_default();
  line.add("--changes", o.changes,
           "text file that lists all changes to the case and, under each, the places that it concerns");
  line.group("Expert");
  line.add("--integrator", o.integrator,
           "reference: IDA on the unreduced equations; batch: the vectorised (SIMD) solver used by generate")
      .one_of({"reference", "batch"})
      .shows_default();
  line.add("--tolerance", o.tolerance, "relative error per step (reference 1e-8, batch 1e-6)");
  line.example(
      "swingbank simulate --raw grid.raw --dyr grid.dyr --fault 16:1.0:1.1 --t-end 10 --out run.csv");
  if (!line.parse(argc, argv)) return line.end();
  return simulate(o);
}
}  // namespace swingbank::jobs::simulate_command
