// Example: an effect that Swingbank lacks, added to a plant. Plays a record into the plant without and with
// the effect, and prints the errors of P.
#include <cstdio>
#include <exception>

#include "cubic_damping.hpp"
#include "validate/compare/compare.hpp"

int main(int argc, char** argv) try {
  using namespace swingbank;
  using namespace swingbank::validate;
  if (argc != 3) return std::fputs("usage: own_effect MODEL.toml RECORD.csv\n", stderr), 2;
  plant::PlantModel model = plant::load_plant_model(argv[1]);
  const record::Record record = record::read_record(argv[2], model.record_base, model.reading);
  const double before = compare::compare_event(model, record).channels.front().whole.rms;
  const sim::Effect& effect = model.library.add(sim::make_effect<example::CubicDamping>());
  sim::plant::insert_block(model.plant, {&effect, effect.default_parameters()});
  const double after = compare::compare_event(model, record).channels.front().whole.rms;
  std::printf("RMS error of P: %.5f pu, with %s %.5f pu\n", before, effect.name.data(), after);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
