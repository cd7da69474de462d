// Time and result of infer, reduce and identify on a plant's records: the inferred input, and the optimum of
// each block identified alone. Usage: bench_identify PLANT.toml RECORD... [draws= kept= steps=]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>

#include "validate/event/event.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/reduced/identify.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::validate;

double seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool has(const reduced::Reduction& reduction, event::InputKind input) {
  const reduced::Inputs inputs = reduction.inference().inputs;
  return input == event::InputKind::torque ? inputs.torque : inputs.field;
}

}  // namespace

int main(int argc, char** argv) {
  reduced::IdentifyOptions options;
  std::vector<std::string> files;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&](const char* key, int& value) {
      if (!word.starts_with(key)) return false;
      value = std::stoi(word.substr(std::string(key).size()));
      return true;
    };
    if (!number("draws=", options.draws) && !number("kept=", options.kept) &&
        !number("steps=", options.steps))
      files.push_back(word);
  }
  if (argc < 3) return std::puts("usage: bench_identify PLANT.toml RECORD... [draws= kept= steps=]"), 1;
  const plant::PlantModel model = plant::load_plant_model(argv[1]);
  std::vector<record::Record> records;
  for (const auto& file : files) records.push_back(record::read_record(file, model.record_base));
  const noise::WhitenedEvents events = noise::whitened_events(model, records, {.measured_states = false});
  const double begin = seconds();
  const auto free = fit::free_parameters(model.plant, 0.3);
  std::vector<reduced::Inference> inferences;
  for (const reduced::Inputs inputs :
       {reduced::Inputs{false, false}, {true, false}, {false, true}, {true, true}}) {
    const double start = seconds();
    const int steps = inputs.torque || inputs.field ? 5 : 20;
    inferences.push_back(reduced::infer(model.under_test(), events, free, inputs, 1, steps));
    const reduced::Inference& found = inferences.back();
    fmt::print("{}{}{}: {:.3f} s, {} steps, chi2 per value {:.4f} of {} values, criterion {:.1f}:",
               inputs.torque ? "torque" : "", inputs.torque && inputs.field ? " and " : "",
               inputs.field ? "field" : "", seconds() - start, found.steps, found.reduced_chi2(),
               found.values, found.criterion);
    for (std::size_t i = 0; i < free.size(); ++i)
      fmt::print("  {} {:.3f}", parameter_name(model.plant, free[i].id).parameter,
                 parameter_value(found.plant, free[i].id) / parameter_value(model.plant, free[i].id));
    fmt::print("\n");
  }
  const auto best = std::ranges::min_element(inferences, {}, &reduced::Inference::criterion);
  struct Row {
    std::string name;
    reduced::Trial trial;
    event::InputKind input;
    reduced::Optimum best;
    std::size_t optima = 0;
    double time = 0;
  };
  std::vector<Row> rows;
  for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library)) {
    const auto input = h.side == hypothesis::Side::mechanical   ? event::InputKind::torque
                       : h.side == hypothesis::Side::excitation ? event::InputKind::field
                                                                : event::InputKind::none;
    if (!(input == event::InputKind::torque && best->inputs.torque) &&
        !(input == event::InputKind::field && best->inputs.field))
      continue;
    if (h.free.empty()) continue;
    rows.push_back({h.name, {h.plant, h.free, std::hash<std::string>{}(h.name)}, input, {}});
  }
  const auto round = [&](const reduced::Reduction& reduction) {
    for (const auto input : {event::InputKind::torque, event::InputKind::field}) {
      if (!has(reduction, input)) continue;
      const reduced::ReducedPlant plant(reduction, input);
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
      fmt::print("{}: none {:.1f}, as inferred {:.1f}\n",
                 input == event::InputKind::torque ? "torque" : "field",
                 plant.costs(Eigen::VectorXd::Zero(reduction.knots()), zero)[0],
                 plant.costs(reduction.series(input), zero)[0]);
    }
    for (Row& r : rows) {
      if (!has(reduction, r.input)) continue;
      const double start = seconds();
      std::vector<std::vector<double>> known;
      if (r.optima > 0) known.push_back(r.best.values);
      const auto found = reduced::identify(reduction, r.input, r.trial, options, known);
      r.time = seconds() - start;
      r.optima = found.size();
      if (!found.empty()) r.best = found.front();
    }
    std::ranges::stable_sort(rows, {}, [](const Row& r) { return r.optima > 0 ? r.best.cost : 1e300; });
    for (const Row& r : rows) {
      fmt::print("{:10} chi2 {:10.1f}, {} starts there, {} optima, {:.2f} s:", r.name, r.best.cost,
                 r.best.starts, r.optima, r.time);
      for (std::size_t i = 0; i < r.best.values.size(); ++i)
        fmt::print(" {} {:.4g}", parameter_name(r.trial.plant, r.trial.free[i].id).parameter,
                   r.best.values[i]);
      fmt::print("\n");
    }
  };
  double start = seconds();
  reduced::Reduction reduction(*best, events, model.conventions);
  fmt::print("reduced: {:.3f} s\n", seconds() - start);
  round(reduction);
  fmt::print("after {:.2f} s\n", seconds() - begin);
  // Linearises again about the best hypothesis for the field voltage, without additional inputs.
  for (int again = 0; again < 2; ++again) {
    const auto lead = std::ranges::find(rows, event::InputKind::field, &Row::input);
    sim::plant::Plant leader = lead->trial.plant;
    for (std::size_t i = 0; i < lead->trial.free.size(); ++i)
      parameter_value(leader, lead->trial.free[i].id) = lead->best.values[i];
    std::vector<event::EventState> states = reduction.inference().states;
    for (std::size_t i = 0; i < free.size(); ++i)
      parameter_value(leader, free[i].id) = parameter_value(reduction.inference().base, free[i].id);
    for (auto& state : states) state.torque = state.field = {};
    start = seconds();
    const reduced::Inference beside =
        reduced::linear_about(leader, model.under_test(), events, free, states, {.field = true}, 1);
    fmt::print("about {}: {:.3f} s, {} steps, chi2 per value {:.4f}\n", lead->name, seconds() - start,
               beside.steps, beside.reduced_chi2());
    reduction = reduced::Reduction(beside, events, model.conventions);
    round(reduction);
    fmt::print("after {:.2f} s\n", seconds() - begin);
  }
}
