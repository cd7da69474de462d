// swingbank predict: estimates a plant's parameters from measured records with a trained network.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "base/inputs_kept.hpp"
#include "base/json.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "jobs/record_for_network.hpp"
#include "train/runtime/blas_kernels.hpp"
#include "train/runtime/runtime.hpp"
#include "validate/check/record_set.hpp"

namespace swingbank::jobs::predict_command {
namespace {
using namespace validate;
using nlohmann::ordered_json;

struct Options {
  std::string network, model, out;
  std::vector<std::string> records;
  std::optional<double> event;
  jobs::Reading reading;
  double noise = 0.0;
  bool json = false;
};

struct Estimated {
  record::Record record;
  NetworkInput input;
  train::run::Estimate estimate;
};

void require_same_machine(const train::run::NetworkInfo& network, const plant::PlantModel& model) {
  const auto machine = std::string(model.plant.machine.effect->name);
  if (machine != network.machine_model)
    throw InputError({"a plant with " + machine, model.origin,
                      "the network was trained on " + network.machine_model,
                      "give a network of the plant's machine model"});
}

/// Reads and checks all records. Throws InputError with the problems of all files together.
std::vector<Estimated> read_all(const std::vector<std::string>& files, const plant::PlantModel& model,
                                const check::Preparing& preparing) {
  std::vector<Estimated> all;
  for (record::Record& record : jobs::read_events(files, model, preparing).records) {
    record::require_angle(record);
    all.push_back({std::move(record), {}, {}});
  }
  return all;
}

/// Returns mean and standard deviation over the records; for one record the standard deviation is 0.
std::pair<double, double> over_records(const std::vector<Estimated>& all, std::size_t parameter) {
  double mean = 0.0, square = 0.0;
  for (const auto& e : all) mean += e.estimate.values[parameter] / static_cast<double>(all.size());
  for (const auto& e : all) square += std::pow(e.estimate.values[parameter] - mean, 2.0);
  return {mean, all.size() > 1 ? std::sqrt(square / static_cast<double>(all.size() - 1)) : 0.0};
}

/// Returns the 5 %, 50 % and 95 % quantiles of each parameter's posterior; null for a fixed parameter. Empty
/// if the network has no posterior.
ordered_json intervals_json(const train::run::Estimate& e) {
  ordered_json all = ordered_json::array();
  if (std::ranges::none_of(e.intervals, [](const auto& i) { return i.has_value(); })) return all;
  for (const auto& i : e.intervals)
    all.push_back(i ? ordered_json::array({i->low, i->median, i->high}) : ordered_json());
  return all;
}

/// Returns whether a record is outside the training distribution; the network's estimate is then meaningless.
/// The factor kStrange allows for left-out generators that swing more than those of the training rows.
bool unlike_training(const train::run::NetworkInfo& n, const Estimated& e) {
  constexpr double kStrange = 1.5;
  return e.estimate.input_rms > kStrange * n.input_rms_seen;
}
/// Returns the warnings for records outside the training distribution. They are printed before the estimates.
std::string strangers(const train::run::NetworkInfo& n, const std::vector<Estimated>& all) {
  std::string text;
  for (const auto& e : all)
    if (unlike_training(n, e))
      text += fmt::format(
          "warning: {} differs from the training data: the RMS of its normalised input is {:.2g}, that of the "
          "training data at most {:.2g}; do not trust this estimate\n",
          e.record.name, e.estimate.input_rms, n.input_rms_seen);
  return text;
}

ordered_json to_json(const train::run::SavedNetwork& network, const plant::PlantModel& model,
                     const std::vector<Estimated>& all) {
  const train::run::NetworkInfo& n = network.info();
  ordered_json j;
  j["format"] = "swingbank-estimate-2";
  j["software"] = "swingbank " SWINGBANK_VERSION;
  j["network"] = {{"file", network.file().string()},
                  {"run", n.run},
                  {"kind", n.network},
                  {"machine_model", n.machine_model},
                  {"dataset", n.dataset},
                  {"dataset_hash", n.dataset_hash},
                  {"left_out", n.left_out ? ordered_json(*n.left_out) : ordered_json()},
                  {"input_rms_seen", n.input_rms_seen}};
  j["model"] = model.origin;
  for (const auto& e : all) {
    j["records"].push_back({{"file", e.record.name},
                            {"sha256", e.record.sha256},
                            {"event_s", e.input.event_s},
                            {"held_before_record_s", e.input.padding_s},
                            {"input_rms", e.estimate.input_rms},
                            {"unlike_training", unlike_training(n, e)},
                            {"estimates", e.estimate.values}});
    if (const ordered_json intervals = intervals_json(e.estimate); !intervals.empty())
      j["records"].back()["intervals_90"] = intervals;
  }
  for (std::size_t i = 0; i < n.parameters.size(); ++i) {
    const auto& p = n.parameters[i];
    const auto [mean, scatter] = over_records(all, i);
    j["parameters"].push_back({{"name", p.name},
                               {"effect", p.effect},
                               {"unit", p.unit},
                               {"estimate", mean},
                               {"spread", p.rms_error},
                               {"bias", p.bias},
                               {"scatter", scatter},
                               {"low", p.low},
                               {"high", p.high},
                               {"learnt", p.high > p.low}});
  }
  return j;
}

std::string table(const train::run::NetworkInfo& n, const std::vector<Estimated>& all) {
  std::string text = fmt::format("{:<16}{:>12}{:>12}{:>12}  {:<6}{}\n", "parameter", "estimate", "RMSE",
                                 "scatter", "unit", "training range");
  for (std::size_t i = 0; i < n.parameters.size(); ++i) {
    const auto& p = n.parameters[i];
    const auto [mean, scatter] = over_records(all, i);
    text += fmt::format("{:<16}{:>12.4g}{:>12.3g}{:>12.3g}  {:<6}{}\n", p.name, mean, p.rms_error, scatter,
                        p.unit,
                        p.high > p.low ? fmt::format("{:g} to {:g}", p.low, p.high) : "fixed in training");
  }
  return text +
         "RMSE: root mean square error on generators (or values) outside the training data; "
         "scatter: standard deviation between these records\n";
}

/// Returns the 90 % credible intervals of the parameters for each record.
std::string believed(const train::run::NetworkInfo& n, const std::vector<Estimated>& all) {
  std::string text;
  for (const auto& e : all)
    for (std::size_t i = 0; i < n.parameters.size(); ++i)
      if (const auto& x = e.estimate.intervals[i])
        text += fmt::format(
            "{}{:<16}{:>12.4g}{:>12.4g}{:>12.4g}  {}\n",
            text.empty() ? fmt::format("\n{:<16}{:>12}{:>12}{:>12}\n", "quantiles", "5 %", "50 %", "95 %")
                         : std::string(),
            n.parameters[i].name, x->low, x->median, x->high, e.record.name);
  return text;
}

int run(const Options& o) {
  const train::run::SavedNetwork network = train::run::SavedNetwork::load(o.network);
  note_input(network.file());
  plant::PlantModel model = plant::load_plant_model(o.model);
  const check::Preparing preparing = o.reading.apply(model, o.records);
  require_same_machine(network.info(), model);
  std::vector<Estimated> all = read_all(o.records, model, preparing);
  if (!o.out.empty()) require_inputs_kept({{o.out, "--out"}});
  if (o.event && all.size() > 1)
    throw InputError({"one event time for several records", "--event", "every record has its own event time",
                      "give one record at a time"});
  const auto& machine = model.plant.machine;
  const double reactance = network.info().needs_reactance
                               ? machine.p[static_cast<std::size_t>(machine.effect->parameter_index("Xdp"))]
                               : 0;
  for (auto& e : all) {
    e.input = network_input(e.record, model, network.info(), o.event);
    e.estimate = network.estimate(e.input.values, o.noise, reactance);
  }
  const std::string unlike = strangers(network.info(), all);
  if (o.json || !o.out.empty()) fmt::print(stderr, "{}", unlike);
  const std::string text = json_text(to_json(network, model, all), 2) + "\n";
  if (!o.out.empty()) write_file(o.out, text);
  fmt::print("{}", o.json ? text : unlike + table(network.info(), all) + believed(network.info(), all));
  return 0;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  Options o;
  line.add("--network", o.network, "file.network that train or cross-validate wrote, or a folder with one")
      .required();
  line.add("--model", o.model, "plant file: machine model and base, bases of the records").required();
  line.add("--records,--record", o.records, "records (CSV, COMTRADE or HDF5), one or several").required();
  o.reading.add_columns(line);
  o.reading.add_from(line);
  o.reading.add_until(line);
  o.reading.add_point(line);
  line.add("--event", o.event, "start of the event [s] (default: detected)");
  line.add("--noise", o.noise,
           "level of the records' noise, as measured before the event (0.001: 0.1 %), for a network that was "
           "trained at many levels")
      .shows_default();
  line.add("--out", o.out, "write the estimate as JSON to this file");
  line.add_flag("--json", o.json, "print the estimate as JSON instead of a table");
  line.example("swingbank predict --network results --model plant.toml --records fault1.csv");
  if (!line.parse(argc, argv)) return line.end();
  train::runtime::use_best_blas_kernels(argv);
  train::runtime::set_up_runtime(0);
  return run(o);
}

}  // namespace swingbank::jobs::predict_command
