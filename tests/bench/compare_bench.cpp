// bench_compare MODEL RECORD ROUNDS: processor time of one comparison of a record with a plant model [s], one
// line for each round. python_bench.py measures the same comparison from Python, in alternation.
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>

#include "validate/compare/compare.hpp"

int main(int argc, char** argv) try {
  using namespace swingbank::validate;
  if (argc != 4) return fmt::print(stderr, "usage: bench_compare MODEL RECORD ROUNDS\n"), 2;
  const plant::PlantModel model = plant::load_plant_model(argv[1]);
  const record::Record record = record::read_record(argv[2], model.record_base, model.reading);
  for (int round = 0; round < std::atoi(argv[3]); ++round) {
    const std::clock_t begin = std::clock();
    std::vector<compare::EventComparison> one = {compare::compare_event(model, record)};
    compare::judge(one);
    fmt::print("{}\n", static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
} catch (const std::exception& error) {
  return fmt::print(stderr, "{}\n", error.what()), 1;
}
