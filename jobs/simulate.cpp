// swingbank simulate: plays one event and writes every recorded quantity as CSV, HDF5 or both, with units.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "jobs/measured_run.hpp"
#include "mpi/store/durable.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "sim/core/law.hpp"
#include "sim/network/event_text.hpp"
#include "sim/network/fault_sequence.hpp"
#include "sim/solve/batch.hpp"
#include "sim/solve/block_text.hpp"
#include "sim/solve/load_choice.hpp"
#include "sim/solve/plant_equations.hpp"
#include "sim/solve/reference.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::sim;

struct Options {
  std::string raw, dyr, convention = "psse", integrator = "reference";
  std::vector<std::string> faults, trips, generator_trips, load_steps, vref_steps, pref_steps, loads, laws,
      attached;
  std::vector<std::string> out, plants, channels, measured;
  std::uint64_t measure_seed = 1;
  std::string load_model = "impedance", fault_type = "3ph", z0;
  std::vector<int> buses;
  double t_end = 15.0, rate = 120.0;
  std::optional<double> tolerance, frequency_hz;
  std::vector<std::string> ignore_models, map_models;
  bool after_switching = false;
};

std::vector<std::string> fields(const std::string& text) {
  std::vector<std::string> list(1);
  for (char c : text) {
    if (c == ':')
      list.emplace_back();
    else
      list.back() += c;
  }
  return list;
}

/// A number that takes up the whole text; anything else is a problem.
double number(const std::string& text, const std::string& where, Problems& problems) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {  // reported below, like any other text
  }
  problems.add("'" + text + "' is not a number", where, "a finite number is needed here",
               "write it like 2.05");
  return 0.0;
}

int bus_of(const Network& network, const std::string& text, const std::string& where, Problems& problems) {
  const double value = number(text, where, problems);
  const int index = network.bus_index(static_cast<int>(value));
  if (index < 0 || value != std::floor(value)) {
    problems.add("no bus " + text, where, network.origin + " has no bus of that number",
                 "give a bus number of that file");
    return -1;
  }
  return index;
}

BusFault parse_fault(const std::string& text, const Network& network, double t_end, Problems& problems) {
  const std::string where = "--fault " + text;
  const auto part = fields(text);
  if (part.size() != 3 && part.size() != 5) {
    problems.add(
        fmt::format("{} fields", part.size()), where, "a fault is BUS:T_ON:T_OFF or BUS:T_ON:T_OFF:R:X",
        "give bus number, start [s], end [s] and, if it is not bolted, R and X [pu on the network's base]");
    return {};
  }
  BusFault fault{bus_of(network, part[0], where, problems), number(part[1], where, problems),
                 number(part[2], where, problems)};
  if (part.size() == 5) fault.z = {number(part[3], where, problems), number(part[4], where, problems)};
  if (fault.t_off > t_end)
    problems.add(fmt::format("fault to {} s in a run of {} s", fault.t_off, t_end), where,
                 "the run ends before the fault does", "shorten the fault or raise --t-end");
  return fault;
}

LineTrip parse_trip(const std::string& text, const Network& network, double t_end, Problems& problems) {
  const std::string where = "--trip " + text;
  const auto part = fields(text);
  if (part.size() != 4 && part.size() != 5) {
    problems.add(
        fmt::format("{} fields", part.size()), where,
        "a trip is FROM:TO:CKT:T_OPEN or FROM:TO:CKT:T_OPEN:T_CLOSE",
        "give two bus numbers, the circuit's id, the instant it opens [s] and, if it does, closes [s]");
    return {};
  }
  LineTrip trip{-1, number(part[3], where, problems), {}};
  const int from = bus_of(network, part[0], where, problems), to = bus_of(network, part[1], where, problems);
  if (from >= 0 && to >= 0) {
    trip.branch = network.branch_index(network.buses[from].number, network.buses[to].number, part[2]);
    if (trip.branch < 0)
      problems.add(fmt::format("no branch {}-{} circuit {}", part[0], part[1], part[2]), where,
                   network.origin + " has no branch of that name",
                   "give a branch of that file with its circuit id");
  }
  if (part.size() == 5) trip.t_close = number(part[4], where, problems);
  if (std::max(trip.t_open, trip.t_close.value_or(0.0)) > t_end)
    problems.add(fmt::format("switching after the run's end at {} s", t_end), where, "it would not be played",
                 "choose earlier instants or raise --t-end");
  return trip;
}

Event parse_event(const Options& options, const Network& network, Problems& problems) {
  Event event;
  for (const auto& text : options.faults)
    event.faults.push_back(parse_fault(text, network, options.t_end, problems));
  for (const auto& text : options.trips)
    event.trips.push_back(parse_trip(text, network, options.t_end, problems));
  const double end = options.t_end;
  for (const auto& text : options.generator_trips)
    event.generator_trips.push_back(
        read_generator_trip(text, network, end, "--trip-generator " + text, problems));
  for (const auto& text : options.load_steps)
    event.load_steps.push_back(read_load_step(text, network, end, "--load-step " + text, problems));
  for (const auto& text : options.vref_steps)
    event.setpoint_steps.push_back(
        read_setpoint_step(text, network, end, true, "--vref-step " + text, problems));
  for (const auto& text : options.pref_steps)
    event.setpoint_steps.push_back(
        read_setpoint_step(text, network, end, false, "--pref-step " + text, problems));
  return event;
}

/// Machines behind their step-up transformers, at the impedance the positive sequence has of them.
std::vector<SequenceSource> sequence_sources(const Grid& grid) {
  std::vector<SequenceSource> list;
  for (const Plant& plant : grid.plants) {
    const Operating at = operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                         grid.network.base_mva, grid.conventions);
    const double* joint = at.c.data() + plant.machine.effect->coefficients;
    const Complex own = 1.0 / Complex(joint[joint_r], joint[joint_x]);
    list.push_back({plant.bus, plant.generator, own * plant.mva / grid.network.base_mva});
  }
  return list;
}

void choose_fault_type(const Options& options, const Grid& grid, Event& event, Problems& problems) {
  const auto type = fault_type(options.fault_type);
  std::optional<Complex> z0;
  if (!options.z0.empty()) {
    const auto part = fields(options.z0);
    if (part.size() == 2)
      z0 = Complex(number(part[0], "--z0", problems), number(part[1], "--z0", problems));
    else
      problems.add(options.z0, "--z0", "the form is R:X", "give both, in pu on the network's base");
  }
  if (problems.empty() && type)
    make_unbalanced(event, *type, z0, grid.network, grid.flow, sequence_sources(grid), problems);
}

/// A step of a reference that nothing follows would be lost without a word.
void check_followers(const Grid& grid, const Event& event, Problems& problems) {
  for (const SetpointStep& step : event.setpoint_steps) {
    const auto plant = std::ranges::find(grid.plants, step.generator, &Plant::generator);
    if (plant == grid.plants.end()) continue;
    const auto lacks = [&](Slot slot) {
      return std::ranges::none_of(plant->controls, [&](const Block& b) { return b.effect->slot == slot; });
    };
    if (step.dVref != 0 && lacks(Slot::exciter))
      problems.add("a step of Vref at plant " + plant->name, "--vref-step", "it has no exciter",
                   "choose a plant with one, or add one to the .dyr");
    if (step.dPref != 0 && lacks(Slot::governor))
      problems.add("a step of Pref at plant " + plant->name, "--pref-step", "it has no governor",
                   "choose a plant with one, or add one to the .dyr");
  }
}

std::vector<int> parse_plants(const Options& options, const Grid& grid, Problems& problems) {
  std::vector<int> list;
  for (const auto& name : options.plants) {
    const auto at =
        std::find_if(grid.plants.begin(), grid.plants.end(), [&](const Plant& p) { return p.name == name; });
    if (at != grid.plants.end()) {
      list.push_back(static_cast<int>(at - grid.plants.begin()));
      continue;
    }
    std::string names;
    for (const auto& p : grid.plants) names += (names.empty() ? "" : ", ") + p.name;
    problems.add("no plant " + name, "--plants", "the plants are " + names, "choose some of these");
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
      problems.add("no channel " + name, "--channels", "the channels are " + names, "choose some of these");
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
  if (options.t_end * options.rate > 1e8)
    problems.add(fmt::format("{:.3g} samples", options.t_end * options.rate), "--rate",
                 "more than 1e8 samples are not held in memory", "lower --rate or --t-end");
  for (const std::filesystem::path file : options.out)
    if (file.extension() != ".csv" && file.extension() != ".h5")
      problems.add("extension '" + file.extension().string() + "'", "--out " + file.string(),
                   "runs are written as .csv or .h5", "end the name in .csv or .h5");
  if (options.integrator == "lanes" && !options.buses.empty())
    problems.add("--buses with --integrator lanes", "--buses",
                 "the lanes engine works on the network reduced to the generator buses",
                 "use --integrator reference");
  if (options.integrator == "lanes" && options.after_switching)
    problems.add("--after-switching with --integrator lanes", "--after-switching",
                 "the lanes engine records the value before a switching", "use --integrator reference");
}

double tolerance(const Options& o) { return o.tolerance.value_or(o.integrator == "lanes" ? 1e-6 : 1e-8); }

ReferenceRun play(const Options& o, int finer, const Grid& grid, const Event& event, std::vector<int> plants,
                  std::vector<Channel> channels, std::vector<int> buses) {
  if (o.integrator == "reference") {
    ReferenceOptions options;
    options.t_end = o.t_end;
    options.rate = o.rate * finer;
    options.rtol = tolerance(o);
    options.atol = tolerance(o) / 100;
    options.plants = std::move(plants);
    options.channels = std::move(channels);
    options.buses = std::move(buses);
    options.after_switching = o.after_switching;
    return run_reference(grid, event, options);
  }
  BatchOptions options;
  options.t_end = o.t_end;
  options.rate = o.rate * finer;
  options.tolerance = tolerance(o);
  options.plants = std::move(plants);
  options.channels = std::move(channels);
  Batch batch(grid, options);
  ReferenceRun run;
  bool given = false;
  batch.run(
      [&](Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const Job&, const Trajectory& t) { static_cast<Trajectory&>(run) = t; });
  return run;
}

/// A number of a CSV cell after its comma; a sample that is missing leaves the cell empty.
void put_cell(std::string& text, double value) {
  text += ',';
  if (!std::isnan(value)) fmt::format_to(std::back_inserter(text), "{:.12g}", value);
}

void write_csv(const std::filesystem::path& file, const Grid& grid, const MeasuredRun& run) {
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

void describe_run(h5::File& h, const Options& o, const Grid& grid, const ReferenceRun& run) {
  h.attribute("format", std::string("swingbank-run-1"));
  h.attribute("network", o.raw);
  h.attribute("dynamics", o.dyr);
  h.attribute("ignored_models", joined(o.ignore_models));
  h.attribute("mapped_models", joined(o.map_models));
  h.attribute("convention", o.convention);
  h.attribute("integrator", o.integrator);
  h.attribute("tolerance", tolerance(o));
  h.attribute("faults", joined(o.faults));
  h.attribute("fault_type", o.fault_type);
  h.attribute("zero_sequence_r_x_pu", o.z0);
  h.attribute("trips", joined(o.trips));
  h.attribute("generator_trips", joined(o.generator_trips));
  h.attribute("load_steps", joined(o.load_steps));
  h.attribute("vref_steps", joined(o.vref_steps));
  h.attribute("pref_steps", joined(o.pref_steps));
  h.attribute("loads", describe_loads(grid));
  h.attribute("laws", joined(o.laws));
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
}

void write_hdf5(const std::filesystem::path& file, const Options& o, const Grid& grid,
                const MeasuredRun& run) {
  const std::lock_guard guard(h5::lock());
  const auto samples = static_cast<hsize_t>(run.samples);
  reserve(file,
          (run.values.size() + run.bus_v.size() * 2 + (run.frequency.size() + 1) * samples) * sizeof(double) +
              65536);
  h5::File h = h5::File::create(temporary_name(file));
  const auto put = [&](const std::string& name, const h5::Shape& shape, const std::vector<double>& values) {
    h.create<double>(name, shape);
    h.write(name, 0, shape[0], values.data());
  };
  std::vector<double> time(run.samples);
  for (int k = 0; k < run.samples; ++k) time[k] = k / run.rate;
  put("/time", {samples}, time);
  h.attribute("unit", std::string("s"), "/time");
  put("/records", {run.plants.size(), run.channels.size(), samples}, run.packed());
  h.attribute("unit", std::string("see channel_units; per unit on each plant's own base"), "/records");
  if (!run.frequency.empty()) {
    std::vector<double> all;
    for (const auto& f : run.frequency) all.insert(all.end(), f.begin(), f.end());
    put("/measured_frequency", {run.frequency.size(), samples}, all);
    h.attribute("unit", std::string("Hz"), "/measured_frequency");
  }
  if (!run.buses.empty()) {
    std::vector<std::int32_t> numbers;
    for (int b : run.buses) numbers.push_back(grid.network.buses[b].number);
    h.create<std::int32_t>("/bus_number", {run.buses.size()});
    h.write("/bus_number", 0, run.buses.size(), numbers.data());
    put("/bus_voltage", {run.buses.size(), samples}, run.bus_v);
    h.attribute("unit", std::string("pu"), "/bus_voltage");
    put("/bus_angle", {run.buses.size(), samples}, run.bus_theta);
    h.attribute("unit", std::string("rad"), "/bus_angle");
  }
  describe_run(h, o, grid, run);
  h.close();
  publish(file);
}

int simulate(const Options& o) {
  Problems problems;
  check_options(o, problems);
  DyrOptions models{o.ignore_models, {}};
  for (const auto& text : o.map_models) add_model_map(models, text, "--map-model " + text, problems);
  problems.raise();
  for (const auto& file : o.laws) load_law(file);
  Grid grid = load_grid(o.raw, o.dyr, o.convention == "andes" ? Conventions::andes() : Conventions::psse(),
                        models, o.frequency_hz);
  for (const auto& text : o.attached) attach(grid, text, "--attach " + text, problems);
  if (o.load_model == "raw") loads_as_composed(grid, problems);
  for (const auto& text : o.loads) choose_load(grid, text, "--load " + text, problems);
  Event event = parse_event(o, grid.network, problems);
  choose_fault_type(o, grid, event, problems);
  check_followers(grid, event, problems);
  const auto plants = parse_plants(o, grid, problems);
  const auto channels = parse_channels(o, problems);
  const Instruments instruments(o.measured, o.measure_seed, problems);
  std::vector<int> buses;
  for (int b : o.buses) buses.push_back(bus_of(grid.network, std::to_string(b), "--buses", problems));
  problems.raise();

  const auto begin = std::chrono::steady_clock::now();
  const auto played = [&](int finer, const std::vector<Channel>& wanted) {
    return play(o, finer, grid, event, plants, wanted, buses);
  };
  const MeasuredRun run = instruments.run(grid, plants, channels, played);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const std::filesystem::path file : o.out) {
    if (file.extension() == ".csv")
      write_csv(file, grid, run);
    else
      write_hdf5(file, o, grid, run);
    fmt::print("wrote {}\n", file.string());
  }
  fmt::print("loads: {}\n", describe_loads(grid));
  fmt::print("{} at {:g} s, largest rotor angle spread {:.3f} deg, {}{:.3f} s wall time\n",
             outcome_name(run.outcome), run.stopped_at, run.largest_spread * 57.295779513082321,
             run.steps > 0 ? fmt::format("{} steps, ", run.steps) : "", wall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY, "swingbank simulate"};
  Options o;
  app.add_option("--raw", o.raw, "network, PSS/E .raw version 32 to 35 or MATPOWER .m")->required();
  app.add_option("--dyr", o.dyr, "dynamic models, PSS/E .dyr")->required();
  app.add_option("--frequency-hz", o.frequency_hz, "nominal frequency [Hz], which a .m does not hold");
  app.add_option("--ignore-model", o.ignore_models, "name of a .dyr model to leave out; may be repeated");
  app.add_option("--map-model", o.map_models,
                 "FROM=TO: read a .dyr model as another with as many parameters; may be repeated");
  app.add_option("--law", o.laws, "law file (.toml) whose effect --attach may use; may be repeated");
  app.add_option("--attach", o.attached,
                 "PLANT:EFFECT[:PARAM=VALUE,...]: an effect added to a plant (or to all); may be repeated");
  app.add_option("--measure", o.measured,
                 "EFFECT[:PARAM=VALUE,...]: an instrument between every recorded plant and the record, after "
                 "those before it; may be repeated");
  app.add_option("--measure-seed", o.measure_seed, "seed of the instruments' noise and gaps")
      ->capture_default_str();
  app.add_option("--convention", o.convention,
                 "psse: speed in the stator voltage and Pm/(1+w); andes: neither")
      ->check(CLI::IsMember({"psse", "andes"}))
      ->capture_default_str();
  app.add_option(
      "--fault", o.faults,
      "BUS:T_ON:T_OFF[:R:X], bolted without R and X [s, pu on the network's base]; may be repeated");
  app.add_option("--fault-type", o.fault_type,
                 "3ph, or by sequence equivalents slg: line to ground, ll: two-phase, llg: two-phase to "
                 "ground; R and X of --fault are then the fault's own")
      ->check(CLI::IsMember({"3ph", "slg", "ll", "llg"}))
      ->capture_default_str();
  app.add_option("--z0", o.z0,
                 "R:X, zero-sequence impedance of the grid at the fault [pu on the network's base]; needed "
                 "by slg and llg");
  app.add_option("--trip", o.trips, "FROM:TO:CKT:T_OPEN[:T_CLOSE] [s]; may be repeated");
  app.add_option("--trip-generator", o.generator_trips,
                 "BUS[/ID]:T[:PART] [s, of its units], for good, without PART all; may be repeated");
  app.add_option("--load-step", o.load_steps,
                 "BUS:P:Q:T_ON[:T_OFF] [MW, Mvar, s], consumption added as constant admittance; may be "
                 "repeated");
  app.add_option("--vref-step", o.vref_steps, "BUS[/ID]:T:STEP [s, pu]; may be repeated");
  app.add_option("--pref-step", o.pref_steps, "BUS[/ID]:T:STEP [s, pu]; may be repeated");
  app.add_option("--loads", o.load_model,
                 "impedance: every load at constant impedance; raw: as the .raw composes it of constant "
                 "power, current and admittance; those with a model in the .dyr keep it")
      ->check(CLI::IsMember({"impedance", "raw"}))
      ->capture_default_str();
  app.add_option("--load", o.loads,
                 "BUS[/ID]:EFFECT[:PARAM=VALUE,...], a model for one load; may be repeated");
  app.add_option("--t-end", o.t_end, "end of the run [s]")->capture_default_str();
  app.add_option("--rate", o.rate, "samples per second [1/s]")->capture_default_str();
  app.add_option("--integrator", o.integrator,
                 "reference: IDA on the unreduced equations; lanes: the engine of generate")
      ->check(CLI::IsMember({"reference", "lanes"}))
      ->capture_default_str();
  app.add_option("--tolerance", o.tolerance, "relative error per step (reference 1e-8, lanes 1e-6)");
  app.add_option("--out", o.out, "file to write, .csv or .h5; may be repeated")->required();
  app.add_option("--plants", o.plants, "plants to record, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channels", o.channels, "channels to record, comma-separated (default: all)")
      ->delimiter(',');
  app.add_option("--buses", o.buses, "buses whose voltage is recorded too, comma-separated numbers")
      ->delimiter(',');
  app.add_flag("--after-switching", o.after_switching,
               "a sample at a switching instant shows the value just after it");
  try {
    app.parse(argc, argv);
    return simulate(o);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
