// Example: fit of two machine parameters, H and X'd, to several records at once. Prints them with their 95 %
// intervals.
#include <cstdio>
#include <exception>

#include "validate/fit/fit.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"

int main(int argc, char** argv) try {
  using namespace swingbank::validate;
  if (argc < 3) return std::fprintf(stderr, "usage: fit_parameters MODEL.toml RECORD.csv...\n"), 2;
  const plant::PlantModel model = plant::load_plant_model(argv[1]);
  std::vector<record::Record> records;
  for (int k = 2; k < argc; ++k)
    records.push_back(record::read_record(argv[k], model.record_base, model.reading));
  const noise::WhitenedEvents events = noise::whitened_events(model, records);
  const double prior = 0.3;  // standard deviation of the prior, relative to the submitted value
  std::vector<fit::FreeParameter> free;
  for (const char* name : {"H", "Xdp"})
    free.push_back(
        {{swingbank::sim::plant::kMachineBlock, model.plant.machine.effect->parameter_index(name)}, prior});
  const fit::Fit result = fit::fit(model.under_test(), events, free);
  std::printf("reduced chi-square %.3f (%d values)\n", result.chi2 / result.values, result.values);
  for (const fit::FittedParameter& p : result.parameters)
    std::printf("%s: %.4f -> %.4f [%.4f, %.4f] %s\n", p.full_name().c_str(), p.start, p.value, p.low, p.high,
                p.unit.c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
