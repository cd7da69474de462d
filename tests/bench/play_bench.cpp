// bench_play MODEL RECORD DRAWS: what playing a record into a plant costs, for every effect that could be
// added to it at its standard values and at draws about them. Columns: steps per sample, processor time, and
// the largest and the mean square error against steps of 1e-9, in standard deviations of the noise.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>

#include "validate/event/event.hpp"
#include "validate/event/play.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Cost {
  double steps = 0, seconds = 0, slope_steps = 0, slope_seconds = 0, largest = 0, square = 0;
  int runs = 0;
};

struct Bench {
  const event::WhitenedEvents& events;
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
      std::vector<playin::Direction> along;
      for (const auto& f : fit::free_parameters(tested.plant, 0.2))
        along.push_back({.kind = playin::Direction::Kind::parameter,
                         .parameter = f.id,
                         .scale = std::abs(sim::plant::parameter_value(tested.plant, f.id))});
      const double middle = processor_seconds();
      const int runs = static_cast<int>(along.size() + sim::kDirections - 1) / sim::kDirections;
      const event::Playing how{.lenient = lenient, .linear_slopes = lenient};
      cost.slope_steps += static_cast<double>(event::play(tested, e, {}, along, how).steps) /
                          e.record.samples() / (lenient ? 1 : runs);
      cost.slope_seconds += processor_seconds() - middle;
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
    } catch (const InputError&) {  // it cannot stand there
    }
  }
};

void tell(const Bench& bench) {
  fmt::print("{}\n{:22} {:>5} {:>13} {:>8} {:>13} {:>8} {:>10} {:>12}\n",
             bench.lenient ? "leniently" : "one tolerance", "", "runs", "steps/sample", "ms", "with slopes",
             "ms", "largest", "mean square");
  Cost all;
  for (const auto& [name, c] : bench.costs) {
    fmt::print("{:22} {:5} {:13.2f} {:8.2f} {:13.2f} {:8.2f} {:10.2g} {:12.2g}\n", name, c.runs,
               c.steps / c.runs, 1e3 * c.seconds / c.runs, c.slope_steps / c.runs,
               1e3 * c.slope_seconds / c.runs, c.largest, c.square);
    all.seconds += c.seconds;
    all.slope_seconds += c.slope_seconds;
    all.runs += c.runs;
  }
  fmt::print("{} runs in {:.3f} s, with slopes in {:.3f} s\n", all.runs, all.seconds, all.slope_seconds);
}

int run(const char* model_file, const char* record_file, std::size_t draws) {
  const plant::PlantModel model = plant::load_plant_model(model_file);
  const auto events = event::prepare_events(model, {record::read_record(record_file, model.record_base)},
                                            {.measured_states = false});
  for (const bool lenient : {false, true}) {
    Bench bench{events, lenient};
    bench.add("(the model alone)", model.under_test());
    for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library))
      for (std::size_t k = 0; k < std::min(h.starts.size(), 1 + draws); ++k)
        bench.add(h.name, {hypothesis::started(h, h.starts[k]), h.conventions});
    tell(bench);
  }
  return 0;
}

}  // namespace
}  // namespace swingbank::validate

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print("usage: bench_play MODEL RECORD DRAWS\n");
    return 1;
  }
  return swingbank::validate::run(argv[1], argv[2], static_cast<std::size_t>(std::atoi(argv[3])));
}
