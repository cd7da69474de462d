#include "mpi/draw/dataset_header.hpp"

#include <algorithm>

namespace swingbank::mpi::draw {

namespace {

/// Sets the header's system frequency and the fixed properties of the varied machines.
void describe_machines(const Study& study, store::DatasetHeader& h) {
  const auto& records = study.config.effect().parameters;
  const auto boxed = [&](std::size_t i) {
    return std::ranges::any_of(study.config.box, [&](const Box& b) {
      return b.effect == nullptr && b.index == static_cast<int>(i);
    });
  };
  std::vector<std::size_t> held;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (!boxed(i)) held.push_back(i);
  for (const auto i : held) h.held_names.emplace_back(records[i].name);
  h.frequency = study.grid.network.frequency;
  const bool draws_bases = study.config.operating_point && study.config.operating_point->draws_bases();
  for (const int index : study.plants) {
    const auto& plant = study.grid.plants[static_cast<std::size_t>(index)];
    h.generators.push_back(study.grid.network.buses[static_cast<std::size_t>(plant.bus)].number);
    if (!draws_bases) h.machine_base.push_back(plant.mva);
    auto& values = h.held.emplace_back();
    for (const auto i : held) values.push_back(plant.machine.p[i]);
  }
}

}  // namespace

store::DatasetHeader dataset_header(const Study& study, const store::ShardAttributes& a) {
  const DatasetConfig& c = study.config;
  store::DatasetHeader h;
  h.name = c.file.stem().string();
  h.config_hash = a.config_hash;
  h.kernel = a.kernel;
  h.software = a.software;
  h.machine_model = a.machine_model;
  h.config = c.canonical();
  h.seed = c.seed;
  h.draws = c.draws;
  h.draws_per_shard = c.draws_per_shard;
  h.rate = c.record.rate;
  h.samples = c.record.samples();
  h.int16 = c.record.int16;
  h.channel_names = a.channel_names;
  h.channel_units = a.channel_units;
  h.parameter_names = a.parameter_names;
  h.parameter_units = a.parameter_units;
  h.parameter_low = a.parameter_low;
  h.parameter_high = a.parameter_high;
  h.parameter_effects = a.parameter_effects;
  describe_machines(study, h);
  return h;
}

}  // namespace swingbank::mpi::draw
