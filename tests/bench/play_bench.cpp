// bench_play MODEL DRAWS RECORD...: cost of playing records, for every effect that can be added to the plant.
// Prints first the cost of one evaluation of a fit's objective over all records, without and with its
// gradient. Prints then the cost of the play-in of the first record, at the effect's defaults and at DRAWS
// random values around them. Columns: steps per sample and processor time, without and with sensitivities;
// largest and mean square error against a run with tolerance 1e-9, in standard deviations of the noise.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>

#include "validate/event/event.hpp"
#include "validate/event/play.hpp"
#include "validate/fit/draws.hpp"
#include "validate/fit/states.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Cost {
  double steps = 0, seconds = 0, sensitivity_steps = 0, sensitivity_seconds = 0, largest = 0, square = 0;
  int runs = 0;
};

struct Bench {
  const noise::WhitenedEvents& events;
  bool lenient;
  std::map<std::string, Cost> costs = {};

  void add(const std::string& name, const sim::plant::PlantUnderTest& tested) {
    const event::FitEvent& e = events.front();
    try {
      const playin::Response exact = event::play(tested, e, {}, {}, {.tolerance = 1e-9, .hasty = false});
      const double begin = processor_seconds();
      const playin::Response r = event::play(tested, e, {}, {}, {.lenient = lenient});
      Cost& cost = costs[name];
      cost.seconds += processor_seconds() - begin;
      cost.steps += static_cast<double>(r.steps) / e.record.samples();
      std::vector<playin::SensitivityParameter> along;
      for (const auto& f : fit::free_parameters(tested.plant, 0.2))
        along.push_back({.kind = playin::SensitivityParameter::Kind::parameter,
                         .parameter = f.id,
                         .scale = std::abs(sim::plant::parameter_value(tested.plant, f.id))});
      const double middle = processor_seconds();
      const int runs = static_cast<int>(along.size() + sim::kSensitivities - 1) / sim::kSensitivities;
      const event::Playing how{.lenient = lenient};
      cost.sensitivity_steps += static_cast<double>(event::play(tested, e, {}, along, how).steps) /
                                e.record.samples() / (lenient ? 1 : runs);
      cost.sensitivity_seconds += processor_seconds() - middle;
      ++cost.runs;
      double square = 0, most = 0;
      for (std::size_t c = 0; c < e.channels.size(); ++c)
        for (std::size_t k = 0; k < e.record.t.size(); ++k) {
          const double error = (r.of(e.channels[c])[k] - exact.of(e.channels[c])[k]) /
                               events.noise(0).deviation[static_cast<Eigen::Index>(c)];
          most = std::max(most, std::abs(error));
          square += error * error / e.values();
        }
      cost.largest = std::max(cost.largest, most);
      cost.square = std::max(cost.square, square);
    } catch (const InputError&) {  // infeasible operating point
    }
  }
};

void print_costs(const Bench& bench) {
  fmt::print("{}\n{:22} {:>5} {:>13} {:>8} {:>13} {:>8} {:>10} {:>12}\n",
             bench.lenient ? "leniently" : "one tolerance", "", "runs", "steps/sample", "ms",
             "with sensitivities", "ms", "largest", "mean square");
  Cost all;
  for (const auto& [name, c] : bench.costs) {
    fmt::print("{:22} {:5} {:13.2f} {:8.2f} {:13.2f} {:8.2f} {:10.2g} {:12.2g}\n", name, c.runs,
               c.steps / c.runs, 1e3 * c.seconds / c.runs, c.sensitivity_steps / c.runs,
               1e3 * c.sensitivity_seconds / c.runs, c.largest, c.square);
    all.seconds += c.seconds;
    all.sensitivity_seconds += c.sensitivity_seconds;
    all.runs += c.runs;
  }
  fmt::print("{} runs in {:.3f} s, with sensitivities in {:.3f} s\n", all.runs, all.seconds,
             all.sensitivity_seconds);
}

/// Processor time to compute the whitened residuals of all events [s], minimum of several calls.
double objective_seconds(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
                         bool gradient) {
  constexpr int kCalls = 10;
  double fastest = 1e300;
  std::vector<std::vector<double>> allowances(events.size());
  for (int call = 0; call < kCalls; ++call) {
    const double begin = processor_seconds();
    for (std::size_t e = 0; e < events.size(); ++e) {
      const event::FitEvent& event = events[e];
      std::vector<playin::SensitivityParameter> along;
      if (gradient) {
        for (const auto& f : fit::free_parameters(tested.plant, 0.2))
          along.push_back({.kind = playin::SensitivityParameter::Kind::parameter,
                           .parameter = f.id,
                           .scale = std::abs(sim::plant::parameter_value(tested.plant, f.id))});
        std::ranges::move(fit::state_parameters(event), std::back_inserter(along));
      }
      const playin::Response r =
          event::play(tested, event, {}, along, {.lenient = true, .allowance = &allowances[e]});
      noise::RowMatrix columns(event.values(), static_cast<Eigen::Index>(along.size()) + 1);
      for (std::size_t d = 0; d < along.size(); ++d)
        columns.col(static_cast<Eigen::Index>(d)) = event.collected(r.sensitivities[d].value, false);
      columns.rightCols(1) = event.collected(r.value, true);
      events.noise(e).whiten(columns);
    }
    fastest = std::min(fastest, processor_seconds() - begin);
  }
  return fastest;
}

void print_objective(const plant::PlantModel& model, const noise::WhitenedEvents& events) {
  fmt::print("{:22} {:>12} {:>12} {:>8}\n", "all records", "objective ms", "gradient ms", "ratio");
  for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library)) try {
      const sim::plant::PlantUnderTest tested{hypothesis::started(h, h.starts.front()), h.conventions};
      const double value = objective_seconds(tested, events, false),
                   both = objective_seconds(tested, events, true);
      fmt::print("{:22} {:12.2f} {:12.2f} {:8.2f}\n", h.name, 1e3 * value, 1e3 * both, both / value);
    } catch (const InputError&) {  // infeasible operating point
    }
}

int run(const char* model_file, std::size_t draws, std::span<const char* const> record_files) {
  const plant::PlantModel model = plant::load_plant_model(model_file);
  std::vector<record::Record> records;
  for (const char* file : record_files) records.push_back(record::read_record(file, model.record_base));
  const auto events = noise::whitened_events(model, records, {.measured_states = false});
  print_objective(model, events);
  for (const bool lenient : {false, true}) {
    Bench bench{events, lenient};
    bench.add("(the model alone)", model.under_test());
    for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library)) {
      bench.add(h.name, h.under_test());
      const fit::Draws draw(h.plant, h.free, 1);
      for (std::uint64_t k = 0; k < draws; ++k)
        if (const auto values = draw(k)) bench.add(h.name, {hypothesis::started(h, *values), h.conventions});
    }
    print_costs(bench);
  }
  return 0;
}

}  // namespace
}  // namespace swingbank::validate

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print("usage: bench_play MODEL DRAWS RECORD...\n");
    return 1;
  }
  return swingbank::validate::run(argv[1], static_cast<std::size_t>(std::atoi(argv[2])),
                                  std::span(argv + 3, static_cast<std::size_t>(argc - 3)));
}
