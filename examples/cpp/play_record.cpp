// Example: playback of a record. V and its angle are the inputs of the model, and P and Q are compared with
// the measured ones.
#include <cstdio>
#include <exception>

#include "validate/compare/compare.hpp"

int main(int argc, char** argv) try {
  using namespace swingbank::validate;
  if (argc != 3) return std::fprintf(stderr, "usage: play_record MODEL.toml RECORD.csv\n"), 2;
  const plant::PlantModel model = plant::load_plant_model(argv[1]);
  const record::Record record = record::read_record(argv[2], model.record_base, model.reading);
  const compare::EventComparison event = compare::compare_event(model, record);
  for (const compare::ChannelComparison& channel : event.channels)
    std::printf("%-6s RMS error %9.4g %s, %7.2f times the noise; largest %9.4g %s at %.3f s\n",
                channel.name.c_str(), channel.whole.rms * channel.scale, channel.unit.c_str(),
                channel.whole.in_noise, channel.whole.worst * channel.scale, channel.unit.c_str(),
                channel.whole.worst_at);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
